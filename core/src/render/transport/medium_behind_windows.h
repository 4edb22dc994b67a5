#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/media/medium.h"
#include "plenoflame/scene/compile.h"
#include "render/transport/window_wall_kernel.h"
#include "render/visibility/camera_front.h"

namespace plenoflame {

/// A scene's medium as the camera sees it through windows. It integrates the camera's own lines and
/// bends them on their way. For all other code these are lines through air.
///
/// This is possible if each ray meets the medium on one stretch of its path, behind the same walls.
/// These are plates and wedges in front of the medium, and a tube around it. Rays on other paths
/// (at rims, beside a plate, along a wall) are traced one by one.
class MediumBehindWindows : public Medium {
 public:
  /// @return nullptr if windows stand otherwise, or if the scene has more than a medium; keeps
  /// pointers to the scene's data
  static std::unique_ptr<const MediumBehindWindows> make(const CompiledScene& scene);

  int channel_count() const override { return medium_.channel_count(); }
  Box bounds() const override { return medium_.bounds(); }
  std::vector<Box> occupied() const override { return medium_.occupied(); }
  bool is_costly() const override { return medium_.is_costly(); }
  bool is_grey() const override { return medium_.is_grey(); }
  double feature_size() const override { return medium_.feature_size(); }
  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  MediumSample sample(Vec3 world) const override { return medium_.sample(world); }
  double source(int channel, double temperature) const override {
    return medium_.source(channel, temperature);
  }
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    medium_.append_breakpoints(ray, t);
  }
  std::string description() const override { return medium_.description(); }

 private:
  MediumBehindWindows(const CompiledScene& scene, const Box& lit, std::vector<WindowSpec> walls);
  template <class Real>
  void run(const RayBatch<Real>& rays, const MediumOptions& options, RadianceBatch<Real> out,
           MediumCounters& counters) const;
  template <class Real>
  void bend_one_by_one(const RayBatch<Real>& from, const KernelWays<Real>& ways) const;

  const Medium& medium_;
  const WindowSet& windows_;
  CameraFront front_;
  Vec3 axis_;                      ///< axis of the camera towards the scene, in the world
  Box lit_;                        ///< contains the whole medium
  std::vector<WindowSpec> walls_;  ///< in front of the medium, from the camera on
};

}  // namespace plenoflame
