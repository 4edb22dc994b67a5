#pragma once

namespace plenoflame::desktop {

/// Colours of all widgets.
void apply_theme(bool dark);

}  // namespace plenoflame::desktop
