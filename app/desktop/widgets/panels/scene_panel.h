#pragma once
#include <QWidget>
#include <set>

#include "model/parameter_model.h"

class QComboBox;
class QLabel;
class QSlider;
class QTreeView;

namespace plenoflame::desktop {

/// The tree of parameters, the message of what is wrong, and a slider that moves the selected
/// number.
class ScenePanel : public QWidget {
  Q_OBJECT
 public:
  explicit ScenePanel(Document& document, QWidget* parent = nullptr);

  ParameterModel& model() { return *model_; }
  QTreeView& tree() { return *tree_; }
  /// Opens the tree at a value and selects it.
  void reveal(const QString& path);
  /// Text that is being typed counts as typed.
  void finish_editing();

 signals:
  void failed(const QString& message);

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  void show_cameras();
  void show_menu(const QPoint& place);
  void show_message();
  void reveal_unreadable();
  void start_slider();
  void move_slider(int value);
  void remember_expanded();
  void restore_expanded();

  Document& document_;
  ParameterModel* model_;
  QComboBox* camera_;  ///< hidden where there is but one
  QTreeView* tree_;
  QLabel* message_;
  QSlider* slider_;
  QLabel* slider_label_;
  QString slider_path_;
  double slider_start_ = 0;
  double slider_reach_ = 0;  ///< of a component, to each side; 0: it is moved by a factor
  int stroke_ = 0;           ///< of the slider: what it does in one is one step to undo
  std::set<QString> expanded_;
};

}  // namespace plenoflame::desktop
