#include "image/picture_arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr std::size_t kMostSide = 100000;  ///< side of a picture
constexpr std::size_t kColours = 3;

bool may_be_picture(const PictureArray& array) {
  return array.sides.size() >= 2 && array.sides.size() <= 4 &&
         std::count_if(array.sides.begin(), array.sides.end(),
                       [](std::size_t side) { return side > 1; }) >= 2;
}

std::string text_of(const PictureArray& array) {
  return fmt::format("{} ({})", array.name, fmt::join(array.sides, " x "));
}

}  // namespace

void refuse_picture(const std::string& path, const std::string& why) {
  throw FileError("cannot read '" + path + "': " + why);
}

PictureSides picture_sides(const std::string& path, const PictureArray& array) {
  if (!may_be_picture(array))
    refuse_picture(path, text_of(array) +
                             " is no picture: rows and columns, and perhaps 3 colours and "
                             "frames, are its sides");
  // Frames first, as C counts; MATLAB's are last.
  std::vector<std::size_t> sides = array.sides;
  const std::size_t n = sides.size();
  PictureSides found;
  const auto colours = sides.begin() + static_cast<std::ptrdiff_t>(array.by_columns ? 2 : n - 1);
  if (n > 2 && (*colours == kColours || *colours == 1)) {
    found.colours = *colours;
    sides.erase(colours);
  }
  if (sides.size() == 4)
    refuse_picture(path, text_of(array) +
                             " has four sides, of which none is 3 colours: views of a "
                             "light field are no raw picture");
  if (sides.size() == 3) {
    found.frames = array.by_columns ? sides.back() : sides.front();
    sides.erase(array.by_columns ? sides.end() - 1 : sides.begin());
  }
  found.rows = sides[0];
  found.columns = sides[1];
  if (found.rows == 0 || found.columns == 0 || found.frames == 0 || found.rows > kMostSide ||
      found.columns > kMostSide || found.frame() > std::size_t{1} << 29)
    refuse_picture(path, text_of(array) + " has sides that no picture has");
  return found;
}

const PictureArray& chosen_array(const std::string& path, const std::string& name,
                                 const std::vector<PictureArray>& arrays) {
  std::string list;
  std::size_t pictures = 0;
  const PictureArray* found = nullptr;
  constexpr std::size_t kMost = 8;
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    const PictureArray& array = arrays[k];
    if (k < kMost) list += (list.empty() ? "" : ", ") + text_of(array);
    if (k == kMost) list += ", ...";
    if (!name.empty()) {
      if (array.name == name || array.name == "/" + name) return array;
    } else if (may_be_picture(array)) {
      ++pictures;
      found = &array;
    }
  }
  if (list.empty()) refuse_picture(path, "it holds no array of numbers");
  if (!name.empty()) refuse_picture(path, "it has no array '" + name + "'; it has " + list);
  if (pictures == 1) return *found;
  refuse_picture(path,
                 (pictures == 0 ? "no array of it is a picture: "
                                : "several arrays may be the picture; add one, FILE:ARRAY: ") +
                     list);
}

RawPicture picture_of_array(const std::string& path, const std::string& kind,
                            const PictureArray& array, const std::vector<double>& values) {
  const PictureSides sides = picture_sides(path, array);
  RawPicture picture;
  picture.kind = kind;
  picture.width = static_cast<int>(sides.columns);
  picture.height = static_cast<int>(sides.rows);
  picture.channels = static_cast<int>(sides.colours);
  picture.bits = array.bits;
  picture.samples.resize(sides.frame());
  const double largest = std::ldexp(1.0, array.bits) - 1;
  for (std::size_t y = 0; y < sides.rows; ++y)
    for (std::size_t x = 0; x < sides.columns; ++x)
      for (std::size_t c = 0; c < sides.colours; ++c) {
        const std::size_t to = (y * sides.columns + x) * sides.colours + c,
                          from = array.by_columns ? (c * sides.columns + x) * sides.rows + y : to;
        const double value = values.at(from);
        if (!(value >= 0 && value <= largest && value == std::floor(value)))
          refuse_picture(path, fmt::format("{} holds {:.6g}, which is no count of a camera: whole "
                                           "numbers from 0 to {:.0f}",
                                           array.name, value, largest));
        picture.samples[to] = static_cast<std::uint16_t>(value);
      }
  return picture;
}

}  // namespace plenoflame
