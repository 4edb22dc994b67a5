#pragma once
#include <string>

#include "plenoflame/image/raw_picture.h"

namespace plenoflame {

/// A JPEG that is in memory, grey or RGB of 8 bits, marked as lossy. @throws FileError naming
/// `path`
RawPicture read_jpeg_picture(const std::string& path, const std::string& bytes);

}  // namespace plenoflame
