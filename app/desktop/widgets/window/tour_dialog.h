#pragma once
#include <QDialog>
#include <functional>
#include <vector>

class QLabel;
class QPushButton;

namespace plenoflame::desktop {

/// A guided tour: a text for each step, and what the window shows meanwhile.
class TourDialog : public QDialog {
  Q_OBJECT
 public:
  struct Step {
    QString title, text;
    std::function<void()> show;
  };
  explicit TourDialog(std::vector<Step> steps, QWidget* parent = nullptr);
  int step() const { return step_; }
  int steps() const { return static_cast<int>(steps_.size()); }
  void go_to(int step);

 private:
  std::vector<Step> steps_;
  int step_ = 0;
  QLabel* text_;
  QPushButton *back_, *next_;
};

}  // namespace plenoflame::desktop
