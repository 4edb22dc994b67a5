#pragma once

namespace plenoflame::desktop {

/// The largest part of the screen that a window takes; the rest is the frame's.
inline constexpr double kShareOfScreen = 0.95;

/// Colours of all widgets.
void apply_theme(bool dark);

}  // namespace plenoflame::desktop
