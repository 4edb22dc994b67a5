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

/// A control variate: radiance of the medium on lines through its middle and the camera's entrance
/// pupil, linearly interpolated. The visible part of a pixel needs many rays, and the radiance
/// needs few. All rays therefore use the table, and some are integrated too. Their difference
/// corrects the mean, so that the table affects only the scatter (docs/theory/errors.md).
///
/// The table is filled block by block when rays need it. Its values depend only on scene and
/// camera.
class RadianceTable {
 public:
  /// @param anchor world point to which rays are relative
  /// @return nullptr if a table does not save time: the medium is cheap, or too large or too near
  /// for a table with its details
  static std::unique_ptr<RadianceTable> make(const Camera& camera, const Medium& medium,
                                             Vec3 anchor, const MediumOptions& options);

  /// Keeps a medium that was made for this table.
  void keep(std::unique_ptr<const Medium> medium) { kept_ = std::move(medium); }

  /// Samples per pixel from which on filling the table pays.
  double least_samples() const { return least_samples_; }

  /// Rays of a block (KernelBlock), relative to the anchor.
  struct Request {
    const KernelBlock<float>* rays;
    int count;  ///< multiple of kRayPadding
    /// Factor per ray, for smooth and for fair places of the table. With 0 the table suffices.
    /// Otherwise the ray is integrated and counts as table + factor * (integral - table).
    const float* smooth_factor;
    const float* fair_factor;
    float* radiance;  ///< channel c at radiance + c * stride; may be negative for single rays
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
  double least_samples_ = 0;
  /// Memory that stays untouched until it is filled.
  std::unique_ptr<float[]> nodes_;
  std::unique_ptr<std::atomic<bool>[]> filled_;
  std::unique_ptr<std::once_flag[]> once_;
};

}  // namespace plenoflame
