#pragma once
#include <QByteArray>
#include <QObject>
#include <array>

class QAction;
class QMainWindow;
class QMenu;

namespace plenoflame::desktop {

class SceneView;

/// Commands for a whole view: shown alone, copied; and the layout as it was at first.
class ViewCommands : public QObject {
  Q_OBJECT
 public:
  /// @param views 3-D, section, image; the first two share a parent  @param view,edit menus that
  /// get
  ///        the commands
  ViewCommands(QMainWindow& window, SceneView& scene, const std::array<QWidget*, 3>& views,
               QMenu& view, QMenu& edit);

 protected:
  bool eventFilter(QObject* object, QEvent* event) override;

 private:
  /// The view under the pointer, or the one that has the focus.
  QWidget* view_in_use() const;
  void set_full(bool on);
  void copy();

  QMainWindow& window_;
  SceneView& scene_;
  std::array<QWidget*, 3> views_;
  QAction* full_;
  QByteArray first_, before_full_;
};

}  // namespace plenoflame::desktop
