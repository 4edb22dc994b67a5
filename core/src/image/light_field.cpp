#include "plenoflame/image/light_field.h"

#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "exr_stream.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field_channel.h"

namespace plenoflame {
namespace {

constexpr std::string_view kPrefix = "plenoflame.";
constexpr std::string_view kNumberPrefix = "plenoflame.number.";
constexpr std::string_view kTextPrefix = "plenoflame.text.";
constexpr std::string_view kErrorSuffix = ".error";
/// Format 1 had numbers as doubles and lists as string vectors, which many tools drop; format 2 has
/// texts, one name a line in lists.
constexpr int kFormat = 2, kOldestFormat = 1;
constexpr int kRows = 32;  ///< that are read or written between looks at whether to stop

std::string joined(std::string_view a, std::string_view b) {
  return std::string(a).append(b);
}

/// Every image of a light field with its EXR channel's name.
template <class Field, class Visit>
void for_each_image(Field& light_field, Visit visit) {
  for (auto& channel : light_field.channels) {
    visit(channel.name, channel.flux);
    visit(joined(channel.name, kErrorSuffix), channel.standard_error);
  }
  for (auto& [name, image] : light_field.layers) visit(name, image);
}

void check(const LightField& light_field) {
  const PixelWindow& window = light_field.window;
  if (window.width <= 0 || window.height <= 0 || window.x < 0 || window.y < 0 ||
      window.x > light_field.sensor_width - window.width ||
      window.y > light_field.sensor_height - window.height)
    throw InputError("a light field's window must lie within its sensor and hold a pixel");
  if (light_field.channels.empty()) throw InputError("a light field needs a channel");
  std::set<std::string> names;
  for_each_image(light_field, [&](const std::string& name, const Image& image) {
    if (name.empty() || name.size() > 255 || name.find('\0') != std::string::npos ||
        name.find('\n') != std::string::npos)
      throw InputError("a channel's name has 1 to 255 characters in one line: '" + name + "'");
    if (!names.insert(name).second)
      throw InputError("two images of a light field have the name '" + name + "'");
    const bool optional = name.ends_with(kErrorSuffix);
    if (optional && image.empty()) return;
    if (image.width != window.width || image.height != window.height ||
        image.pixels.size() !=
            static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height))
      throw InputError("image '" + name + "' of a light field does not have its window's size");
  });
  const auto check_key = [](const std::string& key) {
    if (key.empty() || key.size() > 200)
      throw InputError("a light field's attributes have names of 1 to 200 characters: '" + key +
                       "'");
  };
  for (const auto& entry : light_field.numbers) check_key(entry.first);
  for (const auto& entry : light_field.texts) check_key(entry.first);
}

void add_standard_attributes(Imf::Header& header, const LightField& light_field) {
  const auto with = [&](const char* key, auto use) {
    const auto entry = light_field.numbers.find(key);
    if (entry != light_field.numbers.end()) use(entry->second);
  };
  const auto insert = [&](const char* name, double value) {
    header.insert(name, Imf::FloatAttribute(static_cast<float>(value)));
  };
  with("lens.focal_length", [&](double f) { insert("effectiveFocalLength", 1e3 * f); });
  with("lens.f_number", [&](double number) { insert("aperture", number); });
  with("focus.object_distance", [&](double distance) { insert("focus", distance); });
  with("sensor.pixel_pitch", [&](double pitch) {
    insert("sensorPhotositePitch", 1e6 * pitch);
    double down = pitch;
    with("sensor.pixel_pitch_y", [&](double pitch_y) {
      down = pitch_y;
      header.pixelAspectRatio() = static_cast<float>(pitch / pitch_y);
    });
    header.insert("sensorOverallDimensions",
                  Imf::V2fAttribute({static_cast<float>(1e3 * pitch * light_field.sensor_width),
                                     static_cast<float>(1e3 * down * light_field.sensor_height)}));
  });
}

/// The shortest decimal text that is read as this number again.
std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string lines_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "" : "\n").append(name);
  return text;
}

std::vector<std::string> names_of(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    names.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return names;
}

Imf::Compression compression_of(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::none:
      return Imf::NO_COMPRESSION;
    case ExrCompression::rle:
      return Imf::RLE_COMPRESSION;
    case ExrCompression::zip:
      return Imf::ZIP_COMPRESSION;
    case ExrCompression::piz:
      return Imf::PIZ_COMPRESSION;
  }
  return Imf::NO_COMPRESSION;
}

Imf::Header make_header(const LightField& light_field, ExrCompression compression) {
  const PixelWindow& window = light_field.window;
  const Imath::Box2i display({0, 0}, {light_field.sensor_width - 1, light_field.sensor_height - 1});
  const Imath::Box2i data({window.x, window.y},
                          {window.x + window.width - 1, window.y + window.height - 1});
  Imf::Header header(display, data, 1, {0, 0}, 1, Imf::INCREASING_Y, compression_of(compression));
  header.zipCompressionLevel() = 1;  // higher ones take longer for nothing: noise is what is left
  for_each_image(light_field, [&](const std::string& name, const Image& image) {
    if (!image.empty()) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  });
  std::vector<std::string> channels, layers;
  for (const auto& channel : light_field.channels) channels.push_back(channel.name);
  for (const auto& layer : light_field.layers) layers.push_back(layer.first);
  const auto text = [&](const std::string& key, const std::string& value) {
    header.insert(joined(kPrefix, key), Imf::StringAttribute(value));
  };
  header.insert(joined(kPrefix, "format"), Imf::IntAttribute(kFormat));
  text("channels", lines_of(channels));
  if (!layers.empty()) text("layers", lines_of(layers));  // empty texts get lost elsewhere
  text("samples", text_of(light_field.samples));
  header.insert(joined(kPrefix, "complete"), Imf::IntAttribute(light_field.complete ? 1 : 0));
  text("unit", light_field.unit);
  text("version", light_field.version);
  text("scene", light_field.scene_text);
  text("estimator", light_field.estimator);
  text("seed", std::to_string(light_field.seed));
  for (const auto& [key, value] : light_field.numbers)
    header.insert(joined(kNumberPrefix, key), Imf::StringAttribute(text_of(value)));
  for (const auto& [key, value] : light_field.texts)
    header.insert(joined(kTextPrefix, key), Imf::StringAttribute(value));
  header.insert("comments", Imf::StringAttribute("Raw light-field image of Plenoflame: radiant "
                                                 "flux in W per pixel; NAME.error: its standard "
                                                 "error"));
  add_standard_attributes(header, light_field);
  return header;
}

/// A frame buffer on images that cover `window`; OpenEXR addresses pixels by sensor coordinates.
template <class Field>
Imf::FrameBuffer make_frame_buffer(Field& light_field) {
  const PixelWindow& window = light_field.window;
  const Imath::Box2i data({window.x, window.y},
                          {window.x + window.width - 1, window.y + window.height - 1});
  Imf::FrameBuffer buffer;
  for_each_image(light_field, [&](const std::string& name, auto& image) {
    if (!image.empty())
      buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, image.pixels.data(), data));
  });
  return buffer;
}

/// Attributes of a header, each of which must be there.
class Attributes {
 public:
  Attributes(const std::string& path, const Imf::Header& header) : path_(path), header_(header) {}

  template <class T>
  const T& get(const std::string& key) const {
    const auto* attribute =
        header_.findTypedAttribute<Imf::TypedAttribute<T>>(joined(kPrefix, key));
    if (attribute == nullptr) fail(key);
    return attribute->value();
  }
  void require(const std::string& key) const {
    if (header_.find(joined(kPrefix, key).c_str()) == header_.end()) fail(key);
  }
  /// A number of either format.
  double number(const std::string& key) const {
    if (const auto* old = find<Imf::DoubleAttribute>(key)) return old->value();
    const std::string& text = get<std::string>(key);
    const std::optional<double> value = number_of(text);
    if (!value)
      throw InputError("'" + path_ + "': the attribute '" + joined(kPrefix, key) +
                       "' is not a number: '" + text + "'");
    return *value;
  }
  /// A list of either format; empty when it is missing.
  std::vector<std::string> list(const std::string& key) const {
    if (const auto* old = find<Imf::StringVectorAttribute>(key)) return old->value();
    if (const auto* names = find<Imf::StringAttribute>(key)) return names_of(names->value());
    return {};
  }

 private:
  template <class Attribute>
  const Attribute* find(const std::string& key) const {
    return header_.findTypedAttribute<Attribute>(joined(kPrefix, key));
  }
  [[noreturn]] void fail(const std::string& key) const {
    // If some are present, another program has rewritten the file and dropped the rest.
    bool some = false;
    for (auto entry = header_.begin(); entry != header_.end(); ++entry)
      some = some || std::string_view(entry.name()).starts_with(kPrefix);
    throw InputError("'" + path_ + "' " +
                     (some ? "has lost a part of what a light field of Plenoflame needs"
                           : "is not a light field of Plenoflame") +
                     ": the attribute '" + joined(kPrefix, key) + "' is missing" +
                     (some ? "; the program that wrote it anew keeps only some" : ""));
  }

  const std::string& path_;
  const Imf::Header& header_;
};

/// Sensor and window.
void read_windows(const std::string& path, const Imf::Header& header, LightField& light_field) {
  const Imath::Box2i& display = header.displayWindow();
  const Imath::Box2i& data = header.dataWindow();
  // In 64 bits: a damaged window may span the whole range of int.
  const auto extent = [](int low, int high) { return std::int64_t{high} - low + 1; };
  const std::int64_t width = extent(data.min.x, data.max.x);
  const std::int64_t height = extent(data.min.y, data.max.y);
  if (display.min != Imath::V2i(0, 0) || data.min.x < 0 || data.min.y < 0 || width <= 0 ||
      height <= 0 || data.max.x > display.max.x || data.max.y > display.max.y ||
      display.max.x == std::numeric_limits<int>::max() ||
      display.max.y == std::numeric_limits<int>::max())
    throw InputError("'" + path + "': the data window does not lie within the sensor");
  light_field.sensor_width = display.max.x + 1;
  light_field.sensor_height = display.max.y + 1;
  light_field.window = {data.min.x, data.min.y, static_cast<int>(width), static_cast<int>(height)};
}

LightField from_foreign_header(const std::string& path, const Imf::Header& header) {
  LightField light_field;
  read_windows(path, header, light_field);
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel)
    light_field.channels.push_back({channel.name(), {}, {}});
  if (light_field.channels.empty()) throw InputError("'" + path + "' has no channels");
  return light_field;
}

LightField from_header(const std::string& path, const Imf::Header& header) {
  const Attributes attributes(path, header);
  const int format = attributes.get<int>("format");
  if (format < kOldestFormat || format > kFormat)
    throw InputError("'" + path + "' has format " + std::to_string(format) +
                     " of light fields; this version of Plenoflame reads formats " +
                     std::to_string(kOldestFormat) + " to " + std::to_string(kFormat));
  LightField light_field;
  read_windows(path, header, light_field);
  light_field.scene_text = attributes.get<std::string>("scene");
  light_field.estimator = attributes.get<std::string>("estimator");
  light_field.version = attributes.get<std::string>("version");
  if (const auto* unit = header.findTypedAttribute<Imf::StringAttribute>(joined(kPrefix, "unit")))
    light_field.unit = unit->value();
  light_field.samples = attributes.number("samples");
  light_field.complete = attributes.get<int>("complete") != 0;
  const std::string& seed = attributes.get<std::string>("seed");
  const auto parsed = std::from_chars(seed.data(), seed.data() + seed.size(), light_field.seed);
  if (parsed.ec != std::errc() || parsed.ptr != seed.data() + seed.size())
    throw InputError("'" + path + "': the attribute '" + joined(kPrefix, "seed") +
                     "' is not a number: '" + seed + "'");
  attributes.require("channels");
  for (const std::string& name : attributes.list("channels"))
    light_field.channels.push_back({name, {}, {}});
  for (const std::string& name : attributes.list("layers")) light_field.layers[name];
  for (auto entry = header.begin(); entry != header.end(); ++entry) {
    const std::string name = entry.name();
    if (name.starts_with(kNumberPrefix)) {
      if (const auto* old = dynamic_cast<const Imf::DoubleAttribute*>(&entry.attribute()))
        light_field.numbers[name.substr(kNumberPrefix.size())] = old->value();
      const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute());
      if (const auto value = text ? number_of(text->value()) : std::nullopt)
        light_field.numbers[name.substr(kNumberPrefix.size())] = *value;
    } else if (name.starts_with(kTextPrefix)) {
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&entry.attribute()))
        light_field.texts[name.substr(kTextPrefix.size())] = text->value();
    }
  }
  if (light_field.channels.empty()) throw InputError("'" + path + "' has no channels");
  for (const LightFieldChannel& channel : light_field.channels)
    if (const Imf::Channel* stored = header.channels().findChannel(channel.name);
        stored && stored->type == Imf::HALF && light_field.unit == "W")
      throw InputError("'" + path +
                       "' holds its flux in 16 bits, in which less than 6e-8 W is 0: " +
                       "the program that wrote it anew has to keep 32 (oiiotool: -d float)");
  return light_field;
}

/// The parts of a file that are read.
struct Wanted {
  bool everything = true;
  std::string channel;  ///< otherwise this one's flux; empty: that of the first
  Layers layers = Layers::all;
};

/// Allocates every requested image that the file holds.
void allocate_images(const std::string& path, const Imf::Header& header, std::uint64_t file_size,
                     const Wanted& wanted, LightField& light_field) {
  const PixelWindow& window = light_field.window;
  std::uint64_t images = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
      throw InputError("'" + path + "': channel '" + channel.name() + "' is subsampled");
    ++images;
  }
  // The header's promises must be possible: uncompressed, a half takes 2 bytes; no
  // compression of OpenEXR packs more than about 1000 to 1.
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
  const std::uint64_t ratio = header.compression() == Imf::NO_COMPRESSION ? 1 : 1100;
  if (pixels > ratio * file_size / 2 / std::max<std::uint64_t>(images, 1))
    throw FileError("cannot read '" + path + "': the file is truncated");
  for_each_image(light_field, [&](const std::string& name, Image& image) {
    if (header.channels().findChannel(name) != nullptr) {
      if (wanted.everything || !name.ends_with(kErrorSuffix))
        image = Image(window.width, window.height);
    } else if (!name.ends_with(kErrorSuffix)) {
      throw InputError("'" + path + "' has no channel '" + name + "' although its list has");
    }
  });
}

LightField read(const std::string& path, bool with_pixels, bool foreign = false,
                const Wanted& wanted = {}, const std::stop_token& stop = {}) {
  ExrInput input(path);
  input.check_header();
  try {
    Imf::Header header;
    {
      char start[8];
      int version = 0;
      input.read(start, 8);
      version = static_cast<unsigned char>(start[4]) | static_cast<unsigned char>(start[5]) << 8;
      header.readFrom(input, version);
      input.seekg(0);
    }
    header.sanityCheck();
    LightField light_field =
        foreign ? from_foreign_header(path, header) : from_header(path, header);
    if (!with_pixels) return light_field;
    if (!wanted.everything) {
      const LightFieldChannel channel = find_channel(light_field, wanted.channel);
      light_field.channels = {channel};
      if (wanted.layers == Layers::none) light_field.layers.clear();
    }
    allocate_images(path, header, input.size(), wanted, light_field);
    Imf::InputFile file(input);
    file.setFrameBuffer(make_frame_buffer(light_field));
    const int end = light_field.window.y + light_field.window.height;
    for (int row = light_field.window.y; row < end; row += kRows) {
      if (stop.stop_requested()) throw Cancelled();
      file.readPixels(row, std::min(row + kRows, end) - 1);
    }
    return light_field;
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    throw FileError("cannot read '" + path + "': damaged EXR (" + printable(failure.what()) + ")");
  }
}

/// Layers may hold NaN where there is nothing to tell; pictures are light, and all of it is finite.
void check_numbers(const std::string& path, const LightField& light_field) {
  for (const LightFieldChannel& channel : light_field.channels)
    for (const Image* image : {&channel.flux, &channel.standard_error}) {
      const auto wrong = std::find_if(image->pixels.begin(), image->pixels.end(),
                                      [](float value) { return !std::isfinite(value); });
      if (wrong == image->pixels.end()) continue;
      const auto at = static_cast<int>(wrong - image->pixels.begin());
      throw InputError(fmt::format(
          "'{}' is not written: the {} of channel '{}' is no finite number at pixel {},{}; a value "
          "of the scene, of the pictures or of the options is far out of range",
          path, image == &channel.flux ? "light" : "standard error", channel.name,
          light_field.window.x + at % light_field.window.width,
          light_field.window.y + at / light_field.window.width));
    }
}

}  // namespace

const LightFieldChannel& find_channel(const LightField& light_field, const std::string& name,
                                      const std::string& what) {
  std::string names;
  for (const LightFieldChannel& channel : light_field.channels) {
    if (name.empty() || channel.name == name) return channel;
    names.append(names.empty() ? "" : ", ").append(channel.name);
  }
  throw InputError(what + " has no channel '" + name +
                   "'; it has: " + (names.empty() ? "none" : names));
}

void write_light_field(const std::string& path, const LightField& light_field,
                       const std::stop_token& stop, ExrCompression compression) {
  check(light_field);
  check_numbers(path, light_field);
  AtomicFile file(path);
  ExrOutput output(file, path);
  try {
    Imf::OutputFile exr(output, make_header(light_field, compression));
    exr.setFrameBuffer(make_frame_buffer(light_field));
    for (int row = 0; row < light_field.window.height; row += kRows) {
      if (stop.stop_requested()) throw Cancelled();
      exr.writePixels(std::min(kRows, light_field.window.height - row));
    }
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& failure) {
    if (output.error() != 0) file.fail(output.error());
    throw FileError("cannot write '" + path + "': " + failure.what());
  }
  if (output.error() != 0) file.fail(output.error());
  file.commit();
}

LightField read_light_field(const std::string& path, const std::stop_token& stop) {
  return read(path, true, false, {}, stop);
}

LightField read_foreign_image(const std::string& path) {
  return read(path, true, true);
}

LightField read_light_field_channel(const std::string& path, const std::string& channel,
                                    Layers layers) {
  return read(path, true, false, {false, channel, layers});
}

LightField read_foreign_channel(const std::string& path, const std::string& channel) {
  return read(path, true, true, {false, channel, Layers::none});
}

LightField read_light_field_header(const std::string& path) {
  return read(path, false);
}

}  // namespace plenoflame
