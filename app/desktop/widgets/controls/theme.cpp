#include "widgets/controls/theme.h"

#include <QApplication>
#include <QPalette>
#include <QStyle>
#include <QStyleFactory>

namespace plenoflame::desktop {

void apply_theme(bool dark) {
  // Setting a style again rebuilds every widget, which takes as long as opening it.
  if (QApplication::style()->objectName().compare("fusion", Qt::CaseInsensitive) != 0)
    QApplication::setStyle(QStyleFactory::create("Fusion"));
  QPalette palette;
  const auto all = [&](QPalette::ColorRole role, const QColor& colour) {
    palette.setColor(role, colour);
  };
  if (dark) {
    all(QPalette::Window, QColor(37, 40, 45));
    all(QPalette::WindowText, QColor(226, 228, 231));
    all(QPalette::Base, QColor(28, 30, 34));
    all(QPalette::AlternateBase, QColor(34, 37, 42));
    all(QPalette::Text, QColor(226, 228, 231));
    all(QPalette::Button, QColor(48, 52, 58));
    all(QPalette::ButtonText, QColor(226, 228, 231));
    all(QPalette::ToolTipBase, QColor(55, 60, 67));
    all(QPalette::ToolTipText, QColor(236, 238, 240));
    all(QPalette::Dark, QColor(18, 19, 22));
    all(QPalette::Mid, QColor(90, 96, 104));
    all(QPalette::BrightText, Qt::white);
    all(QPalette::Link, QColor(110, 180, 240));
    all(QPalette::PlaceholderText, QColor(140, 144, 150));
  } else {
    all(QPalette::Window, QColor(240, 241, 243));
    all(QPalette::WindowText, QColor(28, 30, 33));
    all(QPalette::Base, Qt::white);
    all(QPalette::AlternateBase, QColor(246, 247, 249));
    all(QPalette::Text, QColor(28, 30, 33));
    all(QPalette::Button, QColor(232, 234, 237));
    all(QPalette::ButtonText, QColor(28, 30, 33));
    all(QPalette::ToolTipBase, QColor(255, 253, 240));
    all(QPalette::ToolTipText, QColor(28, 30, 33));
    all(QPalette::Dark, QColor(70, 74, 80));
    all(QPalette::Mid, QColor(150, 154, 160));
    all(QPalette::BrightText, Qt::white);
    all(QPalette::Link, QColor(0, 90, 170));
    all(QPalette::PlaceholderText, QColor(120, 124, 130));
  }
  all(QPalette::Highlight, dark ? QColor(45, 110, 165) : QColor(0, 105, 180));
  all(QPalette::HighlightedText, Qt::white);
  for (const QPalette::ColorRole role :
       {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    palette.setColor(QPalette::Disabled, role,
                     dark ? QColor(125, 129, 135) : QColor(140, 144, 150));
  // Shadows of disabled texts, which would make them look bold before the dark.
  palette.setColor(QPalette::Disabled, QPalette::Light, palette.color(QPalette::Window));
  // The filled part of a slider that moves nothing is as grey as its texts.
  palette.setColor(QPalette::Disabled, QPalette::Highlight,
                   dark ? QColor(70, 74, 80) : QColor(190, 194, 200));
  QApplication::setPalette(palette);
}

}  // namespace plenoflame::desktop
