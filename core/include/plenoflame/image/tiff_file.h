#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace plenoflame {

/// Writes a grey TIFF of 16 bits per sample, uncompressed, under a temporary name that is renamed
/// at the end.
/// @param description of the picture (tag ImageDescription)
/// @throws FileError; InputError for a number of samples that is not width * height
void write_tiff(const std::string& path, int width, int height,
                const std::vector<std::uint16_t>& samples, const std::string& description);

}  // namespace plenoflame
