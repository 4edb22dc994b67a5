#pragma once
#include <optional>
#include <string>

#include "plenoflame/base/report.h"
#include "plenoflame/measure/temperatures.h"
#include "plenoflame/scene/scene.h"

namespace plenoflame::cli {

/// The errors of temperatures beside those of what the pixels look at: in each bin their mean,
/// weighted by the light of the first channel.
/// @param truth [K] of each pixel; 0: none
void compare_with(const Image& truth, const TemperatureMap& map, const Image& light,
                  const std::optional<PixelBins>& bins, Report& report);

/// Temperatures, and what they were found from.
struct FoundTemperatures {
  const LightField& field;
  const Scene& scene;
  const Temperatures& temperatures;
};

/// Reports the differences from the temperatures of the same bins in a reference, and compares them
/// with the noise. The reference is a light field of the same pixels with less noise or none.
/// @throws FileError, InputError where the light fields are not of the same pixels and channels
void compare_with_reference(const std::string& path, const FoundTemperatures& found,
                            Report& report);

}  // namespace plenoflame::cli
