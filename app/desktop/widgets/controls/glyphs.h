#pragma once
#include <QIcon>

class QAction;
class QToolButton;
class QWidget;

namespace plenoflame::desktop {

/// Small drawings for buttons whose texts would fill a narrow panel.
enum class Glyph { ruler, picture, shortened, hand, light, lenses, saturated, more };

/// Drawn in the colours that the theme has when it is shown.
QIcon glyph_icon(Glyph glyph);

/// A button for an action, without a frame. @param icon_only its text is its tooltip's alone
QToolButton* button_for(QAction* action, QWidget* parent, bool icon_only = false);

}  // namespace plenoflame::desktop
