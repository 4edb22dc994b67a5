#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/scene/sensor_spec.h"

/// From radiant flux to electrons and digital numbers (docs/radiometry.md).
namespace plenoflame {

/// A frame as a sensor gives it away.
struct SensorFrame {
  PixelWindow window;
  double exposure_time = 0;            ///< [s]
  double gain = 0;                     ///< electrons per digital number
  double black_level = 0;              ///< digital number of no light
  Image electrons;                     ///< as read: clipped at the full well, with read noise
  std::vector<std::uint16_t> numbers;  ///< digital numbers
  std::size_t saturated = 0;           ///< pixels at the full well or the largest number
};

/// Settings by which a frame is taken.
struct FrameSettings {
  double exposure_time = 0;  ///< [s]; 0: automatic_exposure()
  bool light = true;         ///< false: a dark frame
  /// Frames of other numbers have other noise, and so have frames with and without light.
  std::uint64_t number = 0;
};

/// A channel as the sensor sees it.
struct SensorChannel {
  const Image* flux = nullptr;  ///< [W]
  double wavelength = 0;        ///< [m] of its photons
};

/// Electrons per joule of radiant flux on a pixel: QE times fill factor times lambda / (hc).
double electrons_per_joule(const SensorSpec& sensor, double wavelength);

/// Share of the full well that automatic exposure fills.
inline constexpr double kAutomaticFill = 0.95;

/// Exposure [s] after which all but 0.1 % of the lit pixels are filled to kAutomaticFill at most. A
/// pixel is full at the full well, or at what the converter's bits hold if that is less. The result
/// is 0 if no pixel is lit.
/// @param channels as of expose()
double automatic_exposure(const std::vector<SensorChannel>& channels, const SensorSpec& sensor);

/// One frame. The steps are: mean electrons = flux * time * electrons_per_joule + dark current *
/// time; Poisson's law; the full well; read noise. Then: digital number = round(electrons / gain +
/// black level), limited to the converter's range. Gain and black level are those of
/// resolved_levels() (camera/sensor_levels.h). The noise of a pixel depends only on the seed, the
/// frame's number and the pixel's place on the sensor.
/// @param channels one, or three for a mosaic   @param sensor_width columns of the whole sensor
/// @throws InputError: images of different sizes, a value that is not finite, a full well of 0
SensorFrame expose(const std::vector<SensorChannel>& channels, PixelWindow window, int sensor_width,
                   const SensorSpec& sensor, const FrameSettings& settings,
                   const Execution& execution = {});

/// Exposure time [s] and electrons of dark current of a channel, for a light field that holds
/// electrons; 0: not known. They are stored as "sensor.exposure_time" and "sensor.dark_electrons".
/// The suffix ".CHANNEL" follows if channels have their own exposures.
double channel_exposure(const LightField& electrons, const std::string& channel);
double channel_dark_electrons(const LightField& electrons, const std::string& channel);

/// The colour that a pixel of the whole sensor sees: red (0), green (1) or blue (2); 0 without a
/// mosaic.
int mosaic_colour(MosaicPattern pattern, int column, int row);

/// A colour at every pixel of a sensor with a mosaic.
struct DemosaicedColour {
  Image values;
  Image counts;  ///< of how many recorded pixels each value is the mean
};

/// Red, green and blue at every pixel: what it has not recorded is the mean of those of its eight
/// neighbours that have. For display; edges get coloured fringes.
/// @param window place of the image on the sensor @throws InputError without a mosaic
std::vector<DemosaicedColour> demosaic(const Image& raw, MosaicPattern pattern, PixelWindow window);

}  // namespace plenoflame
