#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "plenoflame/camera/camera.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/render/work_counters.h"
#include "render/sampling/backward_kernel.h"
#include "render/tracer/radiance_table_kernel.h"

namespace plenoflame {

/// Radiance of the medium on the lines through its middle and the camera's entrance pupil, linearly
/// interpolated: a control variate. Many rays settle what is visible of a pixel and few the
/// radiance: all rays look the table up, some are integrated too, and their difference corrects the
/// mean, so that the table decides about scatter only (docs/theory/errors.md).
///
/// Filled where rays look it up, block by block, with values that depend on scene and camera only.
class RadianceTable {
 public:
  /// @param anchor world; rays are relative to it   @return nullptr where a table does not pay: the
  ///        medium is cheap, or too large or too near for a table of its details
  static std::unique_ptr<RadianceTable> make(const Camera& camera, const Medium& medium,
                                             Vec3 anchor, const MediumOptions& options);

  /// Keeps a medium that was made for this table.
  void keep(std::unique_ptr<const Medium> medium) { kept_ = std::move(medium); }

  /// Rays of a block (KernelBlock), relative to the anchor.
  struct Request {
    const KernelBlock<float>* rays;
    int count;  ///< multiple of kRayPadding
    /// Per ray, where the table is smooth and where it is only fair: 0: the table suffices;
    /// otherwise the ray is integrated and counts as table + factor * (integral - table).
    const float* smooth_factor;
    const float* fair_factor;
    float* radiance;  ///< channel c at radiance + c * stride; single rays' may be negative
    int stride;
  };

  /// Working memory and counters of one thread.
  class Worker {
   public:
    explicit Worker(RadianceTable& table);
    void integrate(const Request& request, MediumCounters& medium);
    const TableCounters& counters() const { return counters_; }

   private:
    void choose(const Request& request);
    void integrate_chosen(const Request& request, MediumCounters& medium);

    RadianceTable& table_;
    std::vector<float> memory_;
    std::vector<int> whole_;
    std::vector<int> chosen_;
    KernelTablePlaces places_{};
    int* quality_ = nullptr;
    float* packed_[6] = {};
    float* exact_ = nullptr;
    float* transmittance_ = nullptr;
    TableCounters counters_;
  };

 private:
  RadianceTable(const Medium& medium, Vec3 anchor, const MediumOptions& options,
                const KernelRadianceTable& kernel);
  void need(int block, TableCounters& counters, MediumCounters& medium);
  void fill(int block, TableCounters& counters, MediumCounters& medium);

  std::unique_ptr<const Medium> kept_;
  const Medium& medium_;
  Vec3 anchor_;
  MediumOptions options_;
  KernelRadianceTable kernel_;
  /// Memory that is not touched before it is filled.
  std::unique_ptr<float[]> nodes_;
  std::unique_ptr<std::atomic<bool>[]> filled_;
  std::unique_ptr<std::once_flag[]> once_;
};

}  // namespace plenoflame
