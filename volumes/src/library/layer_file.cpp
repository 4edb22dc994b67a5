#include <fmt/format.h>
#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "plenoflame/base/error.h"
#include "plenoflame/base/units.h"
#include "plenoflame/volumes/flame_library.h"
#include "vdb_bytes.h"

namespace plenoflame {
namespace {

constexpr std::string_view kKeys = "name, centre, semi_axes, temperature, absorption";

/// Reads one file; every message starts with the place of what is wrong.
class LayerReader {
 public:
  explicit LayerReader(std::string path) : path_(std::move(path)) {}

  std::vector<EllipsoidSpec> read() const {
    const std::vector<char> bytes = detail::read_bytes(path_);
    toml::table root;
    try {
      root = toml::parse(std::string_view(bytes.data(), bytes.size()), path_);
    } catch (const toml::parse_error& error) {
      throw InputError(position(error.source()), std::string(error.description()));
    }
    for (const auto& [key, value] : root)
      if (key.str() != "layers")
        fail(value, fmt::format("unknown key \"{}\"; a layer file holds [[layers]] tables only",
                                key.str()));
    const toml::array* layers = root["layers"].as_array();
    if (layers == nullptr || layers->empty())
      throw InputError(SourcePosition{path_}, "has no [[layers]] tables");
    std::vector<EllipsoidSpec> result;
    for (const toml::node& layer : *layers) result.push_back(read_layer(layer));
    return result;
  }

 private:
  SourcePosition position(const toml::source_region& source) const {
    return {path_, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)};
  }
  [[noreturn]] void fail(const toml::node& node, const std::string& message) const {
    throw InputError(position(node.source()), message);
  }

  double quantity(const toml::node& node, std::string_view key, Dimension dimension) const {
    const auto* text = node.as_string();
    if (text == nullptr)
      fail(node, fmt::format("{} must be a quantity with a unit in quotes, such as \"{}\"", key,
                             dimension == Dimension::length        ? "4 mm"
                             : dimension == Dimension::temperature ? "1650 K"
                                                                   : "30 1/m"));
    try {
      return parse_quantity(text->get(), dimension);
    } catch (const InputError& error) {
      fail(node, fmt::format("{}: {}", key, error.what()));
    }
  }

  Vec3 lengths(const toml::node& node, std::string_view key) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3)
      fail(node,
           fmt::format("{} must be three lengths, such as [\"4 mm\", \"4 mm\", \"12 mm\"]", key));
    return {quantity(*array->get(0), key, Dimension::length),
            quantity(*array->get(1), key, Dimension::length),
            quantity(*array->get(2), key, Dimension::length)};
  }

  EllipsoidSpec read_layer(const toml::node& node) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) fail(node, "layers must be tables: [[layers]]");
    EllipsoidSpec layer;
    for (const auto& [key, value] : *table) {
      if (key == "name" && value.is_string())
        layer.name = value.as_string()->get();
      else if (key == "centre")
        layer.centre = lengths(value, "centre");
      else if (key == "semi_axes")
        layer.semi_axes = lengths(value, "semi_axes");
      else if (key == "temperature")
        layer.temperature = quantity(value, "temperature", Dimension::temperature);
      else if (key == "absorption")
        layer.absorption = quantity(value, "absorption", Dimension::absorption);
      else
        fail(value, key == "name"
                        ? std::string("name must be a text in quotes")
                        : fmt::format("unknown key \"{}\"; a layer has: {}", key.str(), kKeys));
    }
    for (const char* key : {"centre", "semi_axes", "temperature", "absorption"})
      if (!table->contains(key)) fail(node, fmt::format("{} is missing", key));
    return layer;
  }

  std::string path_;
};

}  // namespace

std::vector<EllipsoidSpec> read_layers(const std::string& path) {
  return LayerReader(path).read();
}

}  // namespace plenoflame
