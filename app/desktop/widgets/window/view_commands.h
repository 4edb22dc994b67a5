#pragma once
#include <QObject>
#include <array>
#include <vector>

class QAction;
class QMainWindow;
class QMenu;
class QWidget;

namespace plenoflame::desktop {

class SceneView;

/// Commands for a whole view: shown alone on the screen, and copied.
class ViewCommands : public QObject {
  Q_OBJECT
 public:
  /// @param pictures the view beside the 3-D one  @param others what a single view takes the place
  /// of  @param view,edit menus that get the commands
  ViewCommands(QMainWindow& window, SceneView& scene, QWidget& pictures,
               std::vector<QWidget*> others, const std::array<QMenu*, 2>& view_and_edit);
  /// Gives one view the screen, or all of them the window again.
  void set_full(bool on);

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  /// The view under the pointer, or the one that has the focus.
  QWidget* view_in_use() const;
  void show_alone(bool on);
  void copy();

  QMainWindow& window_;
  SceneView& scene_;
  std::array<QWidget*, 2> views_;
  std::vector<QWidget*> others_, hidden_;
  QAction* full_;
};

}  // namespace plenoflame::desktop
