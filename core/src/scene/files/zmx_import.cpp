#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/optics/glass.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/lens_file.h"
#include "scene/schema/nearest.h"

namespace plenoflame {
namespace {

/// UTF-16 as Zemax writes it, reduced to the characters that matter; otherwise the text itself.
std::string narrow(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (text.size() >= 3 && byte(0) == 0xEF && byte(1) == 0xBB && byte(2) == 0xBF)
    return std::string(text.substr(3));
  const bool little = text.size() >= 2 && byte(0) == 0xFF && byte(1) == 0xFE;
  const bool big = text.size() >= 2 && byte(0) == 0xFE && byte(1) == 0xFF;
  if (!little && !big) return std::string(text);
  std::string result;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    const unsigned char low = byte(i + (little ? 0 : 1)), high = byte(i + (little ? 1 : 0));
    result += high == 0 && low < 0x80 ? static_cast<char>(low) : '?';
  }
  return result;
}

struct Line {
  int number = 0;
  std::vector<std::string> words;
};

/// The values of a surface block, in the file's unit.
struct Block {
  int line = 0;
  std::string type = "STANDARD", comment;
  double curvature = 0, thickness = 0, semi_diameter = 0, conic = 0;
  std::array<double, 8> parameters{};  // PARM 1 to 8
  std::string glass;
  double index = 0, abbe = 0;
  int glass_line = 0;
  bool stop = false;
};

/// A type of surface: fills in the shape. @return what cannot be read of it; empty: nothing
struct Type {
  const char* name;
  std::string (*shape)(const Block&, double unit, SurfaceSpec&);
};

std::string conic_shape(const Block& block, double unit, SurfaceSpec& surface) {
  surface.radius = block.curvature == 0 ? kInfinity : unit / block.curvature;
  surface.conic = block.conic;
  return {};
}

std::string standard_shape(const Block& block, double unit, SurfaceSpec& surface) {
  for (const double value : block.parameters)
    if (value != 0) return "PARM on a standard surface is not supported";
  return conic_shape(block, unit, surface);
}

std::string even_shape(const Block& block, double unit, SurfaceSpec& surface) {
  if (block.parameters[0] != 0)
    return "the aspheric term of h^2 is not supported; put it into CURV";
  for (std::size_t i = 1; i < block.parameters.size(); ++i) {
    if (block.parameters[i] == 0) continue;
    surface.aspheric.resize(i, 0);
    surface.aspheric[i - 1] = block.parameters[i] / std::pow(unit, 2 * static_cast<double>(i) + 1);
  }
  return conic_shape(block, unit, surface);
}

/// CURV and CONI are of y, PARM 1 and 2 radius and conic of x, 0 a plane; a plane has no conic.
std::string biconic_shape(const Block& block, double unit, SurfaceSpec& surface) {
  for (std::size_t i = 2; i < block.parameters.size(); ++i)
    if (block.parameters[i] != 0)
      return "PARM " + std::to_string(i + 1) + " on a biconic surface is not supported";
  const bool curved_x = block.parameters[0] != 0, curved_y = block.curvature != 0;
  surface.radius_x = curved_x ? unit * block.parameters[0] : kInfinity;
  surface.radius_y = curved_y ? unit / block.curvature : kInfinity;
  surface.conic_x = curved_x ? block.parameters[1] : 0;
  surface.conic_y = curved_y ? block.conic : 0;
  return {};
}

constexpr Type kTypes[]{
    {"STANDARD", standard_shape}, {"EVENASPH", even_shape}, {"BICONICX", biconic_shape}};

const Type* type_of(const std::string& name) {
  const auto type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                 [&](const Type& known) { return name == known.name; });
  return type == std::end(kTypes) ? nullptr : type;
}

/// "STANDARD, EVENASPH and X".
std::string known_types() {
  std::string text;
  for (const Type& type : kTypes) {
    const bool last = &type == std::end(kTypes) - 1;
    text.append(text.empty() ? "" : last ? " and " : ", ").append(type.name);
  }
  return text;
}

class Importer {
 public:
  Importer(std::string_view text, const std::string& name) : name_(name) {
    std::string line;
    int number = 0;
    const std::string plain = narrow(text);
    for (std::size_t i = 0; i <= plain.size(); ++i) {
      if (i < plain.size() && plain[i] != '\n') {
        if (plain[i] != '\r') line += plain[i];
        continue;
      }
      ++number;
      Line split{number, {}};
      std::string word;
      for (const char c : line + " ") {
        if (c != ' ' && c != '\t') {
          word += c;
        } else if (!word.empty()) {
          split.words.push_back(word);
          word.clear();
        }
      }
      if (!split.words.empty()) lines_.push_back(std::move(split));
      line.clear();
    }
  }

  LensFile read() {
    for (const Line& line : lines_) {
      const std::string& key = line.words.front();
      if (key == "SURF") {
        blocks_.emplace_back();
        blocks_.back().line = line.number;
      } else if (blocks_.empty() || is_tail(key)) {
        header(line);
      } else {
        surface(line, blocks_.back());
      }
    }
    if (blocks_.size() < 3)
      throw InputError(SourcePosition{name_},
                       "the file has no lens: there are no SURF blocks between object and image");
    for (std::size_t i = 1; i + 1 < blocks_.size(); ++i) add(blocks_[i], i + 2 == blocks_.size());
    return file_;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& message) const {
    throw InputError(SourcePosition{name_, line}, message);
  }

  double number(const Line& line, std::size_t at) const {
    double value = 0;
    if (at >= line.words.size()) fail(line.number, line.words.front() + " lacks a number");
    std::string_view word = line.words[at];
    if (word == "INFINITY") return kInfinity;
    if (word.starts_with('+')) word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      fail(line.number, quote_for_message(line.words[at]) + " is not a number");
    return value;
  }

  /// Keys of the header that may follow the surfaces.
  static bool is_tail(const std::string& key) {
    constexpr const char* kTail[] = {"TOL", "MNUM", "MOFF", "MCOF", "MODE"};
    return std::find(std::begin(kTail), std::end(kTail), key) != std::end(kTail);
  }

  void header(const Line& line) {
    const auto& words = line.words;
    if (words[0] == "MODE" && words.size() > 1 && words[1] != "SEQ")
      fail(line.number, "MODE " + words[1] + ": only sequential lenses can be read");
    if (words[0] == "MNUM" && words.size() > 1 && number(line, 1) > 1)
      fail(line.number, "MNUM: several configurations are not supported; save only one of them");
    if (words[0] == "NAME")
      for (std::size_t i = 1; i < words.size(); ++i)
        file_.title.append(file_.title.empty() ? "" : " ").append(words[i]);
    if (words[0] != "UNIT" || words.size() < 2) return;
    if (words[1] == "MM")
      unit_ = 1e-3;
    else if (words[1] == "CM")
      unit_ = 1e-2;
    else if (words[1] == "IN")
      unit_ = 25.4e-3;
    else if (words[1] == "METER" || words[1] == "M")
      unit_ = 1;
    else
      fail(line.number, "UNIT " + words[1] + " is not known");
  }

  void surface(const Line& line, Block& block) {
    const auto& words = line.words;
    const std::string& key = words[0];
    if (key == "TYPE") {
      block.type = words.size() > 1 ? words[1] : "";
      if (!type_of(block.type))
        fail(line.number, "surface type " + quote_for_message(block.type) + " is not supported; " +
                              known_types() + " are");
    } else if (key == "CURV") {
      block.curvature = number(line, 1);
    } else if (key == "DISZ") {
      block.thickness = number(line, 1);
    } else if (key == "DIAM") {
      block.semi_diameter = number(line, 1);
    } else if (key == "CLAP") {  // round clear aperture: least and greatest radius
      if (number(line, 1) != 0) fail(line.number, "CLAP: a hole in the aperture is not supported");
      block.semi_diameter = number(line, 2);
    } else if (key == "CONI") {
      block.conic = number(line, 1);
    } else if (key == "PARM") {
      const double which = number(line, 1), value = number(line, 2);
      if (value == 0) return;
      if (which < 1 || which > 8) fail(line.number, "PARM " + words[1] + " is not supported");
      block.parameters[static_cast<std::size_t>(which) - 1] = value;
    } else if (key == "GLAS") {
      block.glass = words.size() > 1 ? words[1] : "";
      block.glass_line = line.number;
      if (words.size() > 5) block.index = number(line, 4), block.abbe = number(line, 5);
      if (block.glass == "MIRROR") fail(line.number, "GLAS MIRROR: mirrors are not supported");
    } else if (key == "STOP") {
      block.stop = true;
    } else if (key == "COMM") {
      block.comment = words.size() > 1 ? words[1] : "";
    } else if (key == "XDAT") {
      if (number(line, 2) != 0) fail(line.number, "XDAT: extra surface data is not supported");
    } else if (key == "SQAP" || key == "ELAP" || key == "OBSC" || key == "SQOB" || key == "SPID" ||
               key == "UDAP" || key == "OBDC" || key == "GARR" || key == "CLTI" || key == "BRTI") {
      fail(line.number, key + " is not supported: apertures must be round and centred");
    } else if (key == "SCBD" || key == "TILT" || key == "DECX" || key == "DECY") {
      fail(line.number, key + ": tilted and decentred surfaces are not supported");
    } else if (!is_harmless(key)) {
      file_.notes.push_back(name_ + ":" + std::to_string(line.number) + ": " +
                            quote_for_message(key) + " is not known and is ignored");
    }
  }

  /// Keys that change nothing in the path of light: display, solves, pickups, tolerances, coatings.
  static bool is_harmless(const std::string& key) {
    constexpr const char* kKeys[] = {
        "HIDE", "MIRR", "SLAB", "POPS", "FLAP", "COAT", "MAZH", "MEMA", "PPAR", "PZUP", "TPAR",
        "CONF", "OEMA", "FIMP", "PICB", "SCOL", "BLNK", "LANG", "MOFF", "PKUP", "STST", "SDMA",
        "HYPR", "OBJT", "DRAW", "NSCD", "PRAM", "VPAR", "VDSZ", "VCON", "VCRV", "TTHI"};
    return std::find_if(std::begin(kKeys), std::end(kKeys),
                        [&](const char* k) { return key == k; }) != std::end(kKeys);
  }

  void add(const Block& block, bool last) {
    SurfaceSpec surface;
    if (!std::isfinite(block.thickness)) fail(block.line, "an infinite thickness within the lens");
    surface.thickness = last ? 0 : unit_ * block.thickness;
    if (last) file_.image_distance = unit_ * block.thickness;
    if (surface.thickness < 0) fail(block.line, "a negative thickness is not supported");
    surface.diameter = 2 * unit_ * block.semi_diameter;
    if (!(surface.diameter > 0))
      fail(block.line, "this surface has no clear aperture (DIAM or CLAP)");
    surface.stop = block.stop;
    const std::string fault = type_of(block.type)->shape(block, unit_, surface);
    if (surface.diameter > 2 * greatest_height(surface))
      fail(block.line, "this surface is curved too much for its clear aperture");
    if (!fault.empty()) fail(block.line, fault);
    set_glass(block, surface);
    file_.lens.surfaces.push_back(std::move(surface));
  }

  void set_glass(const Block& block, SurfaceSpec& surface) {
    if (block.glass.empty()) return;
    try {
      surface.index = Glass(block.glass).index(kLineD);
      surface.glass = block.glass;
      return;
    } catch (const InputError& error) {
      if (!(block.index > 1)) fail(block.glass_line, error.what());
    }
    char text[64];
    char* end = std::copy_n("abbe ", 5, text);
    end = std::to_chars(end, text + sizeof text, block.index).ptr;
    *end++ = ' ';
    end = std::to_chars(end, text + sizeof text, block.abbe > 0 ? block.abbe : 1e9).ptr;
    surface.glass = std::string(text, end);
    surface.index = Glass(surface.glass).index(kLineD);
    file_.notes.push_back(name_ + ":" + std::to_string(block.glass_line) + ": glass " +
                          quote_for_message(block.glass) +
                          " is not in the catalogue; its index and Abbe number are used");
  }

  std::string name_;
  std::vector<Line> lines_;
  std::vector<Block> blocks_;
  double unit_ = 1e-3;
  LensFile file_;
};

}  // namespace

LensFile import_zmx(std::string_view text, const std::string& name) {
  return Importer(text, name).read();
}

}  // namespace plenoflame
