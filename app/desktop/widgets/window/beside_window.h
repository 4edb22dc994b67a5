#pragma once
#include <QDialog>
#include <memory>

#include "model/jobs/reconstruct_job.h"

class QComboBox;

namespace plenoflame::desktop {

/// The flame that was found and that of the scene, side by side in three dimensions, turned
/// together.
class BesideWindow : public QDialog {
  Q_OBJECT
 public:
  explicit BesideWindow(QWidget* parent = nullptr);
  ~BesideWindow() override;
  void set_fields(std::shared_ptr<const ReconstructFields> fields);
  /// Both halves as they are drawn.
  QImage picture();

 private:
  struct View;
  void draw();
  std::unique_ptr<View> view_;
  std::shared_ptr<const ReconstructFields> fields_;
  QComboBox* field_;
};

}  // namespace plenoflame::desktop
