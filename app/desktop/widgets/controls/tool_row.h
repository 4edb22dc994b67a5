#pragma once
#include <QWidget>
#include <vector>

class QFrame;
class QToolButton;
class QVBoxLayout;

namespace plenoflame::desktop {

class FlowLayout;

/// Tools above a view, in one row. Spare ones stand in it where there is room for them; the others
/// are behind its last button, one below the other.
class ToolRow : public QWidget {
  Q_OBJECT
 public:
  /// @param name of the last button  @param about its tooltip
  ToolRow(const char* name, const QString& about, QWidget* parent);

  void add(QWidget* tool);
  /// The first ones have the first claim on the room.
  void add_spare(QWidget* tool);
  /// Without spare tools: there is no button for them either.
  void show_spare(bool on);

 protected:
  void resizeEvent(QResizeEvent* event) override;
  bool event(QEvent* event) override;

 private:
  void arrange();
  void open();

  FlowLayout* flow_;
  QToolButton* more_;
  QFrame* popup_;
  QVBoxLayout* lines_;
  std::vector<QWidget*> spare_;
  std::size_t inside_ = 0;  ///< of the spare ones, that are in the row
  bool shown_ = true, placed_ = false;
};

}  // namespace plenoflame::desktop
