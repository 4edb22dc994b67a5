#pragma once
#include <QObject>
#include <QString>
#include <array>
#include <memory>
#include <vector>

#include "model/document.h"
#include "model/jobs/latest_task.h"
#include "plenoflame/camera/lens_design.h"

namespace plenoflame::desktop {

/// Contrast of lines of one spatial frequency, by the spot alone: rays, no diffraction.
struct MtfPoint {
  double frequency = 0;                 ///< [1/m] in the image
  double tangential = 0, sagittal = 0;  ///< 0 to 1
};
/// The geometric modulation transfer function: |mean of exp(-2 pi i f x)| over the points of a
/// spot.
/// @param greatest frequency [1/m]
std::vector<MtfPoint> geometric_mtf(const std::vector<Vec2>& spot, double greatest, int steps);

/// Keeps the main lens's spots and fans up to date, in the background, once somebody wants them.
class LensJob : public QObject {
  Q_OBJECT
 public:
  explicit LensJob(Document& document, QObject* parent = nullptr);
  /// Null: not known yet, or the lens has no surfaces.
  const std::shared_ptr<const LensDesign>& result() const { return result_; }
  const QString& failure() const { return failure_; }
  void want();
  bool busy() const { return task_.busy(); }

 signals:
  void result_changed();

 private:
  void request();
  Document& document_;
  std::shared_ptr<const LensDesign> result_;
  QString failure_;
  bool wanted_ = false;
  unsigned newest_ = 0;
  LatestTask task_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
