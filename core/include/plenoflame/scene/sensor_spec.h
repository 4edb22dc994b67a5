#pragma once
#include <cstdint>

#include "plenoflame/math/vector.h"

/// The sensor as plain values (scene.h).
namespace plenoflame {

/// Colour filters over the pixels: the first letters are those of the top left pixels. R, G and B
/// are the scene's first three channels.
enum class MosaicPattern { none, rggb, bggr, grbg, gbrg };

struct SensorSpec {
  int columns = 0;
  int rows = 0;
  double pixel_pitch = 0;    ///< [m] along a row; of square pixels along a column, too
  double pixel_pitch_y = 0;  ///< [m] along a column; 0: as pixel_pitch
  /// [pixels] standard deviation, along rows and along columns, of the Gaussian by which light is
  /// spread before pixels record it (soft edges of micro-images)
  double blur = 0;
  static constexpr double kBlurCut = 4;  ///< deviations at which the Gaussian ends
  // Figures of the readout (lightfield/sensor.h); nothing here changes what is rendered.
  MosaicPattern mosaic = MosaicPattern::none;
  double exposure_time = 0;       ///< [s]; 0: until the brightest pixels are nearly full
  double quantum_efficiency = 1;  ///< electrons per photon
  double fill_factor = 1;         ///< share of a pixel that is sensitive
  double full_well = 20000;       ///< electrons that a pixel holds; more are lost
  double read_noise = 0;          ///< RMS electrons
  double dark_current = 0;        ///< electrons per second
  double gain = 0;         ///< electrons per digital number; 0: the full well fills the range
  int bits = 14;           ///< of the converter
  double black_level = 0;  ///< digital number of no light; 0: room for the read noise
  bool shot_noise = true;
  double hot_pixels = 0;         ///< share of pixels with hot_current instead of the dark current
  double hot_current = 0;        ///< electrons per second
  double dead_pixels = 0;        ///< share of pixels that see nothing
  std::uint64_t noise_seed = 1;  ///< of noise and defects
  // The times at which light is gathered, for scenes that change with time (timeline.h).
  double frame_rate = 0;      ///< [1/s] of its pictures; 0: that of the first series of flames
  double exposure_begin = 0;  ///< [s] after the time of its frame
  int exposure_steps = 8;     ///< moments of an exposure, for flames that move by a table

  bool square_pixels() const { return !(pixel_pitch_y > 0) || pixel_pitch_y == pixel_pitch; }
  /// [m] width and height of a pixel; pixels leave no gaps
  Vec2 pixel() const { return {pixel_pitch, square_pixels() ? pixel_pitch : pixel_pitch_y}; }
  /// [m] from the middle of a pixel to its corners
  double pixel_reach() const {
    return square_pixels() ? std::sqrt(0.5) * pixel_pitch : 0.5 * std::hypot(pixel().x, pixel().y);
  }
  /// [m] by which pixels record light that arrives beside them; 0 without blur
  Vec2 blur_reach() const { return (kBlurCut * blur) * pixel(); }
  /// [m] from the middle of a pixel to the farthest place at which light that it records arrives
  double footprint_reach() const {
    return blur > 0 ? std::hypot(0.5 * pixel().x + blur_reach().x, 0.5 * pixel().y + blur_reach().y)
                    : pixel_reach();
  }
  /// [m] width and height of the whole sensor
  Vec2 size() const { return {columns * pixel().x, rows * pixel().y}; }
  /// [m] from the middle of the sensor to its corners
  double corner() const {
    return square_pixels() ? 0.5 * pixel_pitch * std::hypot(columns, rows)
                           : 0.5 * std::hypot(size().x, size().y);
  }
  friend bool operator==(const SensorSpec&, const SensorSpec&) = default;
};

}  // namespace plenoflame
