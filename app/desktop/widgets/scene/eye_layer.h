#pragma once
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <QTimer>
#include <array>
#include <memory>

#include "model/eye_view.h"
#include "model/jobs/latest_task.h"

class vtkActor;
class vtkImageData;
class vtkPlaneSource;
class vtkRenderer;

namespace plenoflame::desktop {

/// The flames as eyes see them, a picture in the plane through their middle that faces the eye. It
/// is coarse while the eye moves, and as fine as the screen at rest.
class EyeLayer : public QObject {
  Q_OBJECT
 public:
  explicit EyeLayer(vtkRenderer& renderer);
  ~EyeLayer() override;

  void set_flame(std::shared_ptr<const EyeFlame> flame);
  /// @param shift [m] from the flames' place to where they are drawn
  void set_shift(const Vec3& shift);
  /// @param kept [m] part of the flames that is not cut away
  void set_look(double exposure, const Box& kept);
  void set_visible(bool on) { visible_ = on; }
  /// Before each drawing of the view: follows its camera.
  void follow_camera();
  /// While it is on, each picture is fine at once, however long that takes.
  void draw_at_once(bool on) { at_once_ = on; }
  /// True if there is light to be seen.
  bool has_light() const { return flame_ && flame_->bright > 0; }
  /// True if the picture has its final resolution.
  bool is_fine() const { return !visible_ || !has_light() || fine_; }

 signals:
  /// It has got finer.
  void changed();

 private:
  bool is_ahead() const;
  EyeWindow window() const;
  void place(const EyeWindow& window);
  void take(std::shared_ptr<const EyeLight> light);
  /// The light as a picture of the present exposure.
  void develop();

  vtkRenderer& renderer_;
  std::shared_ptr<const EyeFlame> flame_;
  Vec3 shift_;
  Box kept_;
  double exposure_ = 0;
  bool visible_ = false, fine_ = false, at_once_ = false;
  bool outdated_ = true;                   ///< drawn of other flames, or elsewhere
  std::shared_ptr<const EyeLight> light_;  ///< the drawn light; null: none yet
  std::array<double, 14> camera_{};        ///< for which it was drawn
  vtkNew<vtkPlaneSource> plane_;
  vtkNew<vtkImageData> image_;
  vtkNew<vtkActor> actor_;
  QTimer rest_;
  unsigned newest_ = 0;
  LatestTask task_{Urgency::waited_for};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
