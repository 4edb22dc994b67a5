#pragma once
#include <QWidget>
#include <array>
#include <memory>
#include <vector>

#include "model/jobs/reconstruct_job.h"

class QComboBox;
class QLabel;
class QSlider;

namespace plenoflame::desktop {

class AxesFrame;
class ColourBar;

/// Planes through a reconstruction: the found value, its deviation, the truth and the difference
/// between them, with colour bars and axes in millimetres.
class SlicesPage : public QWidget {
  Q_OBJECT
 public:
  explicit SlicesPage(QWidget* parent = nullptr);
  /// @param finished what is not there will not come
  void set_fields(std::shared_ptr<const ReconstructFields> fields, bool finished);

 private:
  /// A picture with its title and its colours.
  struct Slice {
    QLabel* title = nullptr;
    AxesFrame* frame = nullptr;
    ColourBar* bar = nullptr;
  };

  QLayout* make_choices();
  Slice make_slice(const char* name, const QString& empty);
  void show_slices();
  void show_slice(Slice& slice, const std::vector<float>& values, double white, bool is_signed);

  std::shared_ptr<const ReconstructFields> fields_;
  bool finished_ = false;
  QComboBox *field_ = nullptr, *axis_ = nullptr;
  QSlider* position_ = nullptr;
  Slice found_, deviation_, truth_, difference_;
};

}  // namespace plenoflame::desktop
