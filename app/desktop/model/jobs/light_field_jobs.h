#pragma once
#include <QObject>
#include <QString>
#include <memory>
#include <optional>
#include <vector>

#include "model/jobs/latest_task.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/geometry.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/lightfield/refocus.h"
#include "plenoflame/lightfield/views.h"
#include "plenoflame/scene/window_spec.h"

namespace plenoflame::desktop {

/// A picture that was made from a light field.
struct DerivedImage {
  std::shared_ptr<const Image> image;
  bool preview = false;  ///< a quick one; the exact one follows
  double depth = 0;      ///< [m] refocused: of the plane
};

/// Refocused by shifting the views against each other and adding them: as coarse as they are, but
/// at once. The views meet at `depth` [m].
Image shift_and_add(const Views& views, const ViewGeometry& geometry, double depth);

/// Makes sub-aperture views, refocused pictures and other results from the raw image, in the
/// background. Only the latest request of each kind counts.
class LightFieldJobs : public QObject {
  Q_OBJECT
 public:
  static constexpr int kGrid = 9;  ///< views along a side

  explicit LightFieldJobs(QObject* parent = nullptr);
  ~LightFieldJobs() override;

  /// Finds where the micro-images of a camera are; what was made from another one is dropped.
  /// @param windows that it looks through, with their indices set
  void set_camera(const CameraSpec& camera, const std::vector<WindowSpec>& windows);
  /// Takes a raw image; pictures that were made from another one are dropped. Cheap when only the
  /// image differs: the white light of a camera's micro-images, which takes long, is found once.
  /// @param other_scene whether what was made of the image before shows another scene
  void set_image(std::shared_ptr<const LightField> field, const CameraSpec& camera,
                 const std::vector<WindowSpec>& windows, bool other_scene = false);
  /// Views of microlenses of one type alone, 0 based; -1: of all.
  void set_view_type(int type);
  int view_type() const { return view_type_; }
  void clear();

  /// The image that pictures are made of; null: none.
  const std::shared_ptr<const LightField>& field() const { return field_; }
  /// Null until views have been made from the latest image.
  const std::shared_ptr<const Views>& views() const { return views_; }
  /// With their white light; null until views are requested and computed.
  const std::shared_ptr<const MicroImages>& micro_images() const { return micro_images_; }
  /// Their places, which are known much sooner; without white light.
  const std::shared_ptr<const MicroImages>& outlines() const { return outlines_; }
  const std::optional<ViewGeometry>& geometry() const { return geometry_; }

  /// A quick picture first, then the exact one.
  void refocus(double depth, double aperture);
  void total_focus(double nearest, double farthest, int planes);

  const DerivedImage& refocused() const { return refocused_; }
  const std::shared_ptr<const FocusStack>& stack() const { return stack_; }
  bool busy() const {
    return micro_task_->busy() || views_task_->busy() || refocus_->busy() || stack_task_->busy();
  }

 signals:
  void views_changed();
  void outlines_changed();
  void refocused_changed();
  void stack_changed();
  void failed(const QString& message);

 private:
  bool is_of(const CameraSpec& camera, const std::vector<WindowSpec>& windows) const {
    return camera_ && *camera_ == camera && windows_ == windows;
  }
  void find_white();
  void make_views();
  template <class Function>
  void run(LatestTask& task, Function function);

  std::shared_ptr<const LightField> field_;
  std::optional<CameraSpec> camera_;
  std::vector<WindowSpec> windows_;
  int view_type_ = -1;
  std::shared_ptr<const MicroImages> outlines_, micro_images_;
  bool white_begun_ = false;  ///< for this camera
  std::shared_ptr<const Views> views_;
  std::optional<ViewGeometry> geometry_;
  DerivedImage refocused_;
  std::shared_ptr<const FocusStack> stack_;
  unsigned image_number_ = 0;
  std::optional<std::pair<double, double>> wanted_refocus_;
  std::unique_ptr<LatestTask> micro_task_, views_task_, refocus_, stack_task_;
};

}  // namespace plenoflame::desktop
