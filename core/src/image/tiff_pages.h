#pragma once
#include <functional>
#include <string>

#include "plenoflame/image/raw_picture.h"

namespace plenoflame {

/// The pages of a TIFF that is in memory. @throws FileError naming `path`
void read_tiff_pages(const std::string& path, const std::string& bytes,
                     const std::function<void(RawPicture&&)>& take);

}  // namespace plenoflame
