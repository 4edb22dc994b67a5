#pragma once
#include <string>
#include <string_view>
#include <vector>
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// A lens from a file.
struct LensFile {
  MainLensSpec lens;
  std::string title;
  double image_distance = 0;       ///< [m] last surface to the image that the file states; 0: none
  std::vector<std::string> notes;  ///< parts that were left out or replaced, one line each
};

/// Reads a prescription by the end of its name: TOML with a table [camera.lens] (.toml), sequential
/// Zemax (.zmx), or four columns (.dat, .txt). Indices of named glasses are those at the d line.
/// @throws FileError, InputError with line
LensFile read_lens_file(const std::string& path);

/// Zemax, sequential mode: standard and even aspheric surfaces, radii, thicknesses, glasses of the
/// catalogue or with index and Abbe number, semi-diameters, the stop. The text may be UTF-16.
/// @throws InputError naming the line of an unsupported feature: other surface types, coordinate
///         breaks, mirrors, apertures that are not round. Also several configurations and the
///         non-sequential mode
LensFile import_zmx(std::string_view text, const std::string& name);

/// Four columns per surface, from the scene to the sensor: radius, thickness, index behind it,
/// clear diameter, in mm. Radius 0 is the aperture stop; # begins a comment. The last thickness is
/// the distance to the image. As in pbrt, "Physically Based Rendering".
/// @throws InputError with line
LensFile import_four_columns(std::string_view text, const std::string& name);

/// A prescription as TOML: the table [camera.lens] alone.
std::string write_lens(const MainLensSpec& lens);

}  // namespace plenoflame
