#pragma once
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// A picture that was computed from a raw light field, ready to be written.
struct NamedImage {
  std::string name;  ///< without folder and ending
  Image image;
  std::map<std::string, double> numbers;
};

/// Writes every image as PNG with the sRGB curve, 16 bits, and one exposure for all: 99.9 % of the
/// lit pixels are not saturated.
/// @return the value that is white
/// @throws FileError, Cancelled
double write_pngs(const std::string& folder, const std::vector<NamedImage>& images,
                  const LightField& raw, const Execution& execution = {});

/// Writes every image as EXR. @throws FileError, Cancelled
void write_exrs(const std::string& folder, const std::vector<NamedImage>& images,
                const std::string& channel, const std::string& unit, const LightField& raw,
                const Execution& execution = {});

/// Writes a depth map. File depth.exr has the channels "depth" [m] and "confidence". In depth.png
/// the nearest depth is white, the farthest dark, and unknown pixels are black.
void write_depth(const std::string& folder, const Image& depth, const Image& confidence,
                 double nearest, double farthest, const LightField& raw);

}  // namespace plenoflame
