#include "widgets/controls/notice.h"

namespace plenoflame::desktop {

Notice::Notice(QWidget* parent) : QLabel(parent) {
  setWordWrap(true);
  setTextFormat(Qt::PlainText);
  setTextInteractionFlags(Qt::TextSelectableByMouse);
  setMargin(4);
  setAutoFillBackground(true);
  hide();
}

void Notice::say(const QString& text, Kind kind) {
  if (text == this->text() && isHidden() == text.isEmpty()) return;
  const bool error = kind == Kind::error;
  QPalette colours = palette();
  colours.setColor(QPalette::Window, error ? QColor(179, 38, 30) : QColor(230, 159, 0));
  colours.setColor(QPalette::WindowText, error ? Qt::white : Qt::black);
  setPalette(colours);
  setText(text);
  setVisible(!text.isEmpty());
}

}  // namespace plenoflame::desktop
