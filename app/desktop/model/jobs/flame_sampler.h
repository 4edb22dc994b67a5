#pragma once
#include <QObject>
#include <QString>
#include <array>
#include <memory>
#include <vector>

#include "model/document.h"
#include "model/image_display.h"
#include "model/jobs/latest_task.h"
#include "model/jobs/scene_compiler.h"
#include "plenoflame/volumes/vdb_info.h"

namespace plenoflame::desktop {

/// The flames of a scene on a lattice over their bounds, and what their files hold.
struct FlameSamples {
  Box box;                          ///< [m] world; empty: no flame
  std::array<int, 3> count{};       ///< samples along x, y, z
  std::vector<float> temperature;   ///< [K] x fastest
  std::vector<float> absorption;    ///< [1/m]
  double coldest = 0, hottest = 0;  ///< [K] where there is absorption
  double densest = 0;               ///< [1/m]
  std::array<double, 2> span{};     ///< [K] of nearly all emission: emission_span()
  /// Emission-weighted mean temperature, T^4 by absorption [K].
  double mean_temperature = 0;
  std::vector<VdbInfo> files;  ///< of the flames that are files, in order

  /// A plane across an axis (0 x, 1 y, 2 z) at a share of the way through. Rows run downwards from
  /// the highest z (or y), columns towards higher x (or y).
  Image slice(int axis, double share, bool of_temperature) const;
  std::array<double, 3> place(double x, double y, double z) const;  ///< [m] of shares of the box
};
FlameSamples sample_flames(const CompiledScene& scene, int longest, const Execution& execution);

/// Keeps the samples up to date, in the background.
class FlameSampler : public QObject {
  Q_OBJECT
 public:
  static constexpr int kLongest = 96;  ///< samples along the longest side
  FlameSampler(SceneCompiler& compiler, QObject* parent = nullptr);
  /// Null until the first are ready.
  const std::shared_ptr<const FlameSamples>& samples() const { return samples_; }

 signals:
  void samples_changed();

 private:
  void request();
  SceneCompiler& compiler_;
  std::shared_ptr<const FlameSamples> samples_;
  unsigned newest_ = 0;
  LatestTask task_{Urgency::work};  ///< last: it ends first
};

}  // namespace plenoflame::desktop
