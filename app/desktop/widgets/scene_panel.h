#pragma once
#include <QWidget>
#include <set>

#include "model/parameter_model.h"

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

 signals:
  void failed(const QString& message);

 private:
  void show_menu(const QPoint& place);
  void show_message();
  void start_slider();
  void move_slider(int value);
  void remember_expanded();
  void restore_expanded();

  Document& document_;
  ParameterModel* model_;
  QTreeView* tree_;
  QLabel* message_;
  QSlider* slider_;
  QLabel* slider_label_;
  QString slider_path_;
  double slider_start_ = 0;
  std::set<QString> expanded_;
};

}  // namespace plenoflame::desktop
