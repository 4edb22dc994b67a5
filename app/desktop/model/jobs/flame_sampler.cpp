#include "model/jobs/flame_sampler.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "emission_span.h"
#include "model/flame_glow.h"
#include "plenoflame/base/error.h"
#include "plenoflame/media/medium_samples.h"

namespace plenoflame::desktop {

FlameSamples sample_flames(const CompiledScene& scene, int longest, const Execution& execution) {
  FlameSamples out;
  if (!scene.medium) return out;
  out.box = scene.medium->bounds();
  if (out.box.empty()) return out;
  MediumSamples samples = sample_medium(*scene.medium, SamplePlaces::middles, longest, execution);
  out.count = samples.count;
  out.temperature = std::move(samples.temperature);
  out.absorption = std::move(samples.absorption);
  double weight = 0, sum = 0;
  out.coldest = 1e300;
  for (std::size_t i = 0; i < out.temperature.size(); ++i) {
    const auto kappa = static_cast<double>(out.absorption[i]);
    const auto t = static_cast<double>(out.temperature[i]);
    if (kappa <= 0) continue;
    out.coldest = std::min(out.coldest, t);
    out.hottest = std::max(out.hottest, t);
    out.densest = std::max(out.densest, kappa);
    const double emission = thermal_emission(t, kappa);
    weight += emission;
    sum += emission * t;
  }
  if (out.coldest > out.hottest) out.coldest = 0;
  out.span = emission_span(out.temperature, out.absorption);
  if (weight > 0) out.mean_temperature = sum / weight;
  const std::filesystem::path folder = std::filesystem::path(scene.scene.file).parent_path();
  for (const FlameSpec& flame : scene.scene.flames)
    if (flame.kind == FlameKind::vdb) out.files.push_back(vdb_info((folder / flame.file).string()));
  return out;
}

std::array<double, 3> FlameSamples::place(double x, double y, double z) const {
  return {box.lower.x + x * (box.upper.x - box.lower.x),
          box.lower.y + y * (box.upper.y - box.lower.y),
          box.lower.z + z * (box.upper.z - box.lower.z)};
}

Image FlameSamples::slice(int axis, double share, bool of_temperature) const {
  if (temperature.empty()) return {};
  const int across = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  const auto n = [&](int k) { return count[static_cast<std::size_t>(k)]; };
  const int fixed = std::clamp(static_cast<int>(share * n(axis)), 0, n(axis) - 1);
  Image image(n(across), n(up));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      std::array<int, 3> at{};
      at[static_cast<std::size_t>(axis)] = fixed;
      at[static_cast<std::size_t>(across)] = column;
      at[static_cast<std::size_t>(up)] = image.height - 1 - row;
      const std::size_t index =
          (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(count[1]) +
           static_cast<std::size_t>(at[1])) *
              static_cast<std::size_t>(count[0]) +
          static_cast<std::size_t>(at[0]);
      // Temperature says nothing where nothing absorbs.
      image.at(column, row) = !of_temperature         ? absorption[index]
                              : absorption[index] > 0 ? temperature[index]
                                                      : 0.0F;
    }
  return image;
}

FlameSampler::FlameSampler(SceneCompiler& compiler, QObject* parent)
    : QObject(parent), compiler_(compiler) {
  connect(&compiler_, &SceneCompiler::cleared, this, [this] {
    ++newest_;
    task_.cancel();
    samples_ = nullptr;
    emit samples_changed();
  });
  connect(&compiler_, &SceneCompiler::compiled_changed, this, [this](const SceneChanges& changes) {
    if (changes.flames || !samples_) request();
  });
}

void FlameSampler::request() {
  const unsigned number = ++newest_;
  task_.request([this, number, scene = compiler_.compiled()](std::stop_token stop) {
    Execution execution;
    execution.stop = std::move(stop);
    try {
      auto samples =
          std::make_shared<const FlameSamples>(sample_flames(*scene, kLongest, execution));
      post(this, [this, number, samples] {
        if (number != newest_) return;
        samples_ = samples;
        emit samples_changed();
      });
    } catch (const Error&) {  // stopped; or a file that vanished, which the compiler will tell
    }
  });
}

}  // namespace plenoflame::desktop
