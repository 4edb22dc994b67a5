#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/lightfield/sensor.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame {

/// The kinds of noise that frames have.
struct SensorNoise {
  bool shot = true, read = true, dark = true, defects = true;
  std::optional<std::uint64_t> seed;  ///< nothing: the sensor's
};

/// The sensor without the kinds of noise that are switched off. Its levels stay, so that frames
/// with and without noise can be compared.
SensorSpec with_noise(const SensorSpec& sensor, const SensorNoise& noise);

/// Frames of a light field in W, as the sensor of its scene records them.
class SensorFrames {
 public:
  /// @param field must outlive it @param scene of the light field
  /// @throws InputError: the light field holds electrons, or other channels than its scene
  SensorFrames(const LightField& field, const Scene& scene, const SensorNoise& noise,
               const Execution& execution = {});

  /// Gives each channel an exposure of its own, in place of the frame's.
  /// @param times [s] of all channels; 0: automatic @throws UsageError for a mosaic
  void expose_each(std::vector<double> times);

  bool mosaic() const { return sensor_.mosaic != MosaicPattern::none; }
  /// With the noise that it has.
  const SensorSpec& sensor() const { return sensor_; }

  /// A frame of one channel; of a sensor with a mosaic, of the first three. Channels have noise of
  /// their own. @throws InputError as expose()
  SensorFrame frame(std::size_t channel, const FrameSettings& settings) const;

  /// Electrons of all channels and their errors, as a light field. @param last receives the last
  /// frame. Its number of saturated pixels is the largest of all channels
  LightField electrons(const FrameSettings& settings, SensorFrame& last) const;

  /// One exposure for all channels [s], so that they can be compared. 99.9 % of the lit pixels stay
  /// below the full well.
  /// @throws InputError: no channel has a photon energy, or none has light
  double automatic() const;

 private:
  double automatic(std::size_t channel) const;
  Image error_of_rays(std::size_t channel, const FrameSettings& settings,
                      const SensorFrame& exposed) const;

  const LightField& field_;
  SensorSpec sensor_;
  Execution execution_;
  std::vector<double> times_;  ///< of each channel; empty: one for all
  std::vector<SensorChannel> channels_;
};

}  // namespace plenoflame
