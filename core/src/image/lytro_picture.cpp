// Files of Lytro cameras: sections with a name, of which one holds JSON (as LFToolbox reads them).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "image/picture_arrays.h"

namespace plenoflame {
namespace {

constexpr std::string_view kBegin("\x89LF", 3);
constexpr std::size_t kTag = 12, kName = 80, kAligned = 16;  // bytes

/// How the numbers of a picture are packed.
struct Packing {
  int width = 0, height = 0;
  int bits = 0;  ///< 10: four numbers in five bytes; 12: two in three bytes
  std::size_t bytes() const {
    const std::size_t numbers = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return bits == 10 ? numbers / 4 * 5 : numbers / 2 * 3;
  }
};
constexpr Packing kIllum{7728, 5368, 10}, kF01{3280, 3280, 12};

RawPicture unpacked(const std::string& path, std::string_view bytes, const Packing& packing) {
  if (packing.width % 4 != 0)
    refuse_picture(path, fmt::format("its picture is {} pixels wide, and packed rows hold a "
                                     "multiple of 4",
                                     packing.width));
  if (bytes.size() < packing.bytes())
    refuse_picture(path, fmt::format("its picture has {} bytes, and {} x {} packed numbers of {} "
                                     "bits take {}: cut off",
                                     bytes.size(), packing.width, packing.height, packing.bits,
                                     packing.bytes()));
  RawPicture picture;
  picture.kind = "Lytro";
  picture.width = packing.width;
  picture.height = packing.height;
  picture.bits = packing.bits;
  picture.samples.reserve(picture.pixel_count());
  const auto at = [&](std::size_t k) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[k]));
  };
  const auto put = [&](unsigned value) {
    picture.samples.push_back(static_cast<std::uint16_t>(value));
  };
  if (packing.bits == 10)
    for (std::size_t k = 0; k < packing.bytes(); k += 5)
      for (unsigned n = 0; n < 4; ++n) put(at(k + n) << 2 | (at(k + 4) >> 2 * n & 3));
  else
    for (std::size_t k = 0; k < packing.bytes(); k += 3) {
      put(at(k) << 4 | at(k + 1) >> 4);
      put((at(k + 1) & 15) << 8 | at(k + 2));
    }
  return picture;
}

/// The first value of a key, in the order of the keys, at any depth.
const nlohmann::json* value_of(const nlohmann::json& json, const std::string& key) {
  if (json.is_object() && json.contains(key)) return &json.at(key);
  if (json.is_structured())
    for (const auto& part : json)
      if (const nlohmann::json* found = value_of(part, key)) return found;
  return nullptr;
}

/// @throws json::exception: no number @throws FileError: none that a picture has
int whole_number(const std::string& path, const nlohmann::json& json, const char* key) {
  constexpr double kMost = 100000;
  const double value = json.at(key).get<double>();
  if (!(value >= 1 && value <= kMost && value == std::floor(value)))
    refuse_picture(path, fmt::format("its JSON has {} {:.6g}, which no picture has", key, value));
  return static_cast<int>(value);
}

Packing packing_of(const std::string& path, const nlohmann::json& metadata) {
  const nlohmann::json* const image = value_of(metadata, "image");
  const nlohmann::json* const packing = image ? value_of(*image, "pixelPacking") : nullptr;
  if (!packing) refuse_picture(path, "its JSON does not say how the pixels are packed");
  try {
    const Packing found{whole_number(path, *image, "width"), whole_number(path, *image, "height"),
                        whole_number(path, *packing, "bitsPerPixel")};
    const std::string order = packing->at("endianness");
    if ((found.bits == 10 && order == "little") || (found.bits == 12 && order == "big"))
      return found;
    refuse_picture(path,
                   fmt::format("pixels of {} bits, {} endian, are not read: 10 little (Illum) "
                               "or 12 big (F01)",
                               found.bits, order));
  } catch (const nlohmann::json::exception&) {
    refuse_picture(path, "its JSON lacks the picture's size or packing");
  }
}

class Sections {
 public:
  Sections(const std::string& path, std::string_view bytes) : path_(path) {
    std::size_t at = 0;
    while (at + kTag + 4 <= bytes.size() && bytes.substr(at, kBegin.size()) == kBegin) {
      const bool is_file = bytes[at + kBegin.size()] == 'P';
      std::size_t size = 0;
      for (std::size_t k = 0; k < 4; ++k)
        size = size << 8 | static_cast<unsigned char>(bytes[at + kTag + k]);
      at += kTag + 4;
      if (is_file) continue;
      if (bytes.size() - at < kName || bytes.size() - at - kName < size)
        refuse_picture(path_, "the Lytro file is cut off");
      std::string_view name = bytes.substr(at, kName);
      name = name.substr(0, name.find('\0'));
      const std::string_view data = bytes.substr(at + kName, size);
      if (by_name_.empty()) first_ = data;
      by_name_.emplace(name, data);
      at += kName + size;
      at = (at + kAligned - 1) / kAligned * kAligned;
    }
    if (by_name_.empty()) refuse_picture(path_, "the Lytro file has no sections: damaged");
  }
  nlohmann::json first() const { return parsed(first_); }
  std::string_view data(const nlohmann::json& name) const {
    const auto found = by_name_.find(name.is_string() ? name.get<std::string>() : "");
    if (found == by_name_.end())
      refuse_picture(path_, "the Lytro file lacks a section that its JSON names");
    return found->second;
  }
  nlohmann::json parsed(std::string_view text) const {
    text = text.substr(0, text.find('\0'));
    constexpr int kMostDepth = 100;  // value_of() and copies call themselves at each level
    const auto shallow = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
      if (depth > kMostDepth) refuse_picture(path_, "the Lytro file's JSON is nested too deeply");
      return true;
    };
    try {
      return nlohmann::json::parse(text, shallow);
    } catch (const nlohmann::json::exception&) {
      refuse_picture(path_, "the Lytro file's JSON is damaged");
    }
  }

 private:
  const std::string& path_;
  std::map<std::string, std::string_view, std::less<>> by_name_;
  std::string_view first_;
};

}  // namespace

void read_lytro_pictures(const std::string& path, const std::string& bytes, const std::string& name,
                         const std::function<void(RawPicture&&)>& take) {
  const Sections sections(path, bytes);
  const nlohmann::json content = sections.first();
  // Other parts refer to previews (JPEG).
  if (const nlohmann::json* const frame = value_of(content, "frame")) {
    const nlohmann::json *const image = value_of(*frame, "imageRef"), *const metadata = value_of(
                                                                          *frame, "metadataRef");
    if (!image || !metadata) refuse_picture(path, "its JSON does not say where the picture is");
    if (!name.empty()) refuse_picture(path, "it holds one picture, which has no name");
    const Packing packing = packing_of(path, sections.parsed(sections.data(*metadata)));
    take(unpacked(path, sections.data(*image), packing));
    return;
  }
  // The data base: pairs of NAME.RAW and NAME.TXT.
  const nlohmann::json* const files = value_of(content, "files");
  std::map<std::string, nlohmann::json> by_name;
  if (files && files->is_array())
    for (const nlohmann::json& file : *files)
      if (file.is_object() && file.contains("name") && file["name"].is_string() &&
          file.contains("dataRef"))
        by_name.emplace(file["name"].get<std::string>(), file["dataRef"]);
  const auto text_of = [&](const std::string& raw) {
    return raw.ends_with(".RAW") ? by_name.find(raw.substr(0, raw.size() - 3) + "TXT")
                                 : by_name.end();
  };
  std::vector<std::string> names;
  for (const auto& [raw, reference] : by_name)
    if (text_of(raw) != by_name.end()) names.push_back(raw);
  if (names.empty()) refuse_picture(path, "the Lytro file holds no raw picture");
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  if (name.empty() && names.size() > 1)
    refuse_picture(path, "its pictures differ in zoom and focus; add one, FILE:NAME: " + list);
  const std::string& chosen = name.empty() ? names.front() : name;
  if (std::find(names.begin(), names.end(), chosen) == names.end())
    refuse_picture(path, "it has no picture '" + name + "'; it has " + list);
  take(unpacked(path, sections.data(by_name.at(chosen)),
                packing_of(path, sections.parsed(sections.data(text_of(chosen)->second)))));
}

bool is_lytro_raw(std::size_t bytes) {
  return bytes == kIllum.bytes() || bytes == kF01.bytes();
}

RawPicture lytro_raw_picture(const std::string& path, const std::string& bytes) {
  return unpacked(path, bytes, bytes.size() == kIllum.bytes() ? kIllum : kF01);
}

}  // namespace plenoflame
