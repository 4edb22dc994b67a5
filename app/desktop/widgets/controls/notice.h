#pragma once
#include <QLabel>

namespace plenoflame::desktop {

/// A line above a view that says why it does not show what it should; hidden where it does.
class Notice : public QLabel {
  Q_OBJECT
 public:
  enum class Kind { error, warning };

  explicit Notice(QWidget* parent = nullptr);
  /// @param text empty: there is nothing to say
  void say(const QString& text, Kind kind = Kind::error);
};

}  // namespace plenoflame::desktop
