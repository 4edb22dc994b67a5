#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/render/ray_paths.h"
#include "render/paths/ray_path_npz.h"

namespace plenoflame {
namespace {

/// Collects text or bytes and writes them to a file in large pieces.
class Output {
 public:
  explicit Output(const std::string& path) : file_(path) {}

  Output& text(std::string_view part) {
    buffer_.append(part);
    if (buffer_.size() > kPiece) flush();
    return *this;
  }
  /// The shortest text that is read back as the same number.
  template <class Number>
  Output& number(Number value) {
    std::array<char, 40> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return text({digits.data(), static_cast<std::size_t>(end - digits.data())});
  }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 20;
  void flush() {
    file_.write(buffer_);
    buffer_.clear();
  }
  AtomicFile file_;
  std::string buffer_;
};

// --- VTK PolyData -----------------------------------------------------------------------------

/// Numbers as little-endian bytes in base64 (RFC 4648): three bytes are four letters. Raw bytes are
/// invalid in XML, and some parsers reject them.
class Base64 {
 public:
  explicit Base64(Output& out) : out_(out) {}

  template <class Number>
  void add(Number value) {
    std::array<unsigned char, sizeof(Number)> raw =
        std::bit_cast<std::array<unsigned char, sizeof(Number)>>(value);
    if constexpr (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
    for (const unsigned char byte : raw) {
      bits_ = bits_ << 8 | byte;
      if (++count_ == 3) write(4);
    }
  }
  void finish() {
    const int letters = count_ + 1;
    if (count_ == 0) return;
    bits_ <<= 8 * (3 - count_);
    write(letters);
    out_.text(std::string_view("==").substr(static_cast<std::size_t>(letters - 2)));
  }

 private:
  void write(int letters) {
    constexpr std::string_view kLetters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<char, 4> four;
    for (std::size_t i = 0; i < 4; ++i) four[i] = kLetters[bits_ >> (18 - 6 * i) & 63U];
    out_.text({four.data(), static_cast<std::size_t>(letters)});
    bits_ = 0;
    count_ = 0;
  }
  Output& out_;
  std::uint32_t bits_ = 0;
  int count_ = 0;  ///< bytes in bits_
};

/// One array of the file. `fill` writes its values.
struct DataArray {
  std::string attributes;
  std::size_t bytes;
  std::function<void(Base64&)> fill;
};

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

template <class Number>
constexpr const char* vtk_type() {
  if constexpr (std::is_same_v<Number, double>) return "Float64";
  if constexpr (std::is_same_v<Number, std::int64_t>) return "Int64";
  return "Int32";
}

/// An array of `count` x `components`; value(i, k) gives component k of entry i.
template <class Number, class Value>
DataArray data_array(const std::string& name, std::size_t count, std::size_t components,
                     Value value, const std::vector<std::string>& component_names = {}) {
  std::string attributes = std::string("type=\"") + vtk_type<Number>() + "\" Name=\"" + name +
                           "\" NumberOfComponents=\"" + std::to_string(components) + "\"";
  for (std::size_t k = 0; k < component_names.size(); ++k)
    attributes += " ComponentName" + std::to_string(k) + "=\"" + escaped(component_names[k]) + "\"";
  return {attributes, count * components * sizeof(Number), [=](Base64& out) {
            for (std::size_t i = 0; i < count; ++i)
              for (std::size_t k = 0; k < components; ++k)
                out.add(static_cast<Number>(value(i, k)));
          }};
}

std::vector<DataArray> ray_arrays(const RayPaths& paths) {
  const auto& rays = paths.rays;
  const std::size_t n = rays.size(), channels = paths.channels.size();
  return {
      data_array<std::int32_t>(
          "pixel", n, 2,
          [&](std::size_t i, std::size_t k) { return k == 0 ? rays[i].column : rays[i].row; },
          {"column", "row"}),
      data_array<std::int32_t>(
          "microlens", n, 2,
          [&](std::size_t i, std::size_t k) { return k == 0 ? rays[i].lens.q : rays[i].lens.r; },
          {"q", "r"}),
      data_array<std::int32_t>("type", n, 1,
                               [&](std::size_t i, std::size_t) { return rays[i].type; }),
      data_array<std::int32_t>(
          "status", n, 1,
          [&](std::size_t i, std::size_t) { return static_cast<int>(rays[i].status.status); }),
      data_array<std::int32_t>("ended_at", n, 1,
                               [&](std::size_t i, std::size_t) { return rays[i].status.surface; }),
      data_array<std::int32_t>("solid", n, 1,
                               [&](std::size_t i, std::size_t) { return rays[i].solid; }),
      data_array<double>(
          "wavelength", n, channels,
          [&](std::size_t, std::size_t k) { return paths.wavelengths[k]; }, paths.channels),
      data_array<double>("weight", n, 1,
                         [&](std::size_t i, std::size_t) { return rays[i].weight; }),
      data_array<double>(
          "radiance", n, channels,
          [&](std::size_t i, std::size_t k) { return paths.radiance_of(i, k); }, paths.channels),
      data_array<double>("optical_thickness", n, 1,
                         [&](std::size_t i, std::size_t) { return rays[i].optical_thickness; })};
}

std::vector<DataArray> vertex_arrays(const RayPaths& paths) {
  const auto& v = paths.vertices;
  return {data_array<std::int32_t>("surface", v.size(), 1,
                                   [&](std::size_t i, std::size_t) { return v[i].surface; }),
          data_array<double>("refractive_index", v.size(), 1,
                             [&](std::size_t i, std::size_t) { return v[i].index; }),
          data_array<double>("distance", v.size(), 1,
                             [&](std::size_t i, std::size_t) { return v[i].distance; }),
          data_array<double>("temperature", v.size(), 1,
                             [&](std::size_t i, std::size_t) { return v[i].temperature; }),
          data_array<double>("absorption", v.size(), 1,
                             [&](std::size_t i, std::size_t) { return v[i].absorption; })};
}

void write_vtp(Output& out, const RayPaths& paths) {
  const auto& v = paths.vertices;
  const auto& rays = paths.rays;
  struct Section {
    const char* name;
    std::vector<DataArray> arrays;
  };
  const std::vector<Section> sections{
      {"PointData", vertex_arrays(paths)},
      {"CellData", ray_arrays(paths)},
      {"Points",
       {data_array<double>("Points", v.size(), 3,
                           [&](std::size_t i, std::size_t k) {
                             return k == 0   ? v[i].position.x
                                    : k == 1 ? v[i].position.y
                                             : v[i].position.z;
                           })}},
      // The vertices of a ray are consecutive, ray by ray.
      {"Lines",
       {data_array<std::int64_t>("connectivity", v.size(), 1,
                                 [](std::size_t i, std::size_t) { return i; }),
        data_array<std::int64_t>("offsets", rays.size(), 1, [&](std::size_t i, std::size_t) {
          return rays[i].first + rays[i].count;
        })}}};
  out.text(
         "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" "
         "byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"")
      .number(v.size())
      .text("\" NumberOfVerts=\"0\" NumberOfLines=\"")
      .number(rays.size())
      .text("\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n");
  for (const Section& section : sections) {
    out.text("<").text(section.name).text(">\n");
    for (const DataArray& array : section.arrays) {
      out.text("<DataArray ").text(array.attributes).text(" format=\"binary\">\n");
      Base64 coded(out);
      coded.add(static_cast<std::uint64_t>(array.bytes));
      array.fill(coded);
      coded.finish();
      out.text("\n</DataArray>\n");
    }
    out.text("</").text(section.name).text(">\n");
  }
  out.text("</Piece>\n</PolyData>\n</VTKFile>\n");
}

// --- CSV and JSON ------------------------------------------------------------------------------

std::string csv_name(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

void write_csv(Output& out, const RayPaths& paths) {
  out.text("ray,column,row,q,r,type,status,ended_at,solid,weight,optical_thickness");
  for (const std::string& name : paths.channels) out.text(",").text(csv_name("wavelength." + name));
  for (const std::string& name : paths.channels) out.text(",").text(csv_name("radiance." + name));
  out.text(",surface,refractive_index,distance,temperature,absorption,x,y,z\n");
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    for (std::size_t k = ray.first; k < ray.first + ray.count; ++k) {
      const RayVertex& vertex = paths.vertices[k];
      out.number(i);
      for (const int value : {ray.column, ray.row, ray.lens.q, ray.lens.r, ray.type})
        out.text(",").number(value);
      out.text(",").text(to_string(ray.status.status)).text(",").number(ray.status.surface);
      out.text(",")
          .number(ray.solid)
          .text(",")
          .number(ray.weight)
          .text(",")
          .number(ray.optical_thickness);
      for (const double wavelength : paths.wavelengths) out.text(",").number(wavelength);
      for (std::size_t c = 0; c < paths.channels.size(); ++c)
        out.text(",").number(paths.radiance_of(i, c));
      out.text(",").number(vertex.surface);
      for (const double value :
           {vertex.index, vertex.distance, vertex.temperature, vertex.absorption, vertex.position.x,
            vertex.position.y, vertex.position.z})
        out.text(",").number(value);
      out.text("\n");
    }
  }
}

/// JSON has no infinity.
void json_number(Output& out, double value) {
  if (std::isfinite(value))
    out.number(value);
  else
    out.text("null");
}

void write_json(Output& out, const RayPaths& paths) {
  const auto dump = [](const auto& value) { return nlohmann::json(value).dump(); };
  out.text("{\"channels\": ")
      .text(dump(paths.channels))
      .text(", \"wavelengths\": ")
      .text(dump(paths.wavelengths))
      .text(", \"surfaces\": ")
      .text(dump(paths.surfaces))
      .text(",\n\"rays\": [");
  for (std::size_t i = 0; i < paths.rays.size(); ++i) {
    const RayPath& ray = paths.rays[i];
    out.text(i > 0 ? ",\n" : "\n")
        .text("{\"pixel\": [")
        .number(ray.column)
        .text(", ")
        .number(ray.row);
    out.text("], \"microlens\": [").number(ray.lens.q).text(", ").number(ray.lens.r);
    out.text("], \"type\": ")
        .number(ray.type)
        .text(", \"status\": \"")
        .text(to_string(ray.status.status));
    out.text("\", \"ended_at\": ")
        .number(ray.status.surface)
        .text(", \"solid\": ")
        .number(ray.solid)
        .text(", \"weight\": ")
        .number(ray.weight);
    out.text(", \"optical_thickness\": ");
    json_number(out, ray.optical_thickness);
    out.text(", \"radiance\": [");
    for (std::size_t c = 0; c < paths.channels.size(); ++c)
      json_number(out.text(c > 0 ? ", " : ""), paths.radiance_of(i, c));
    out.text("], \"vertices\": [");
    for (std::size_t k = ray.first; k < ray.first + ray.count; ++k) {
      const RayVertex& vertex = paths.vertices[k];
      out.text(k > ray.first ? ", " : "").text("{\"surface\": ").number(vertex.surface);
      out.text(", \"refractive_index\": ")
          .number(vertex.index)
          .text(", \"distance\": ")
          .number(vertex.distance);
      out.text(", \"temperature\": ")
          .number(vertex.temperature)
          .text(", \"absorption\": ")
          .number(vertex.absorption);
      out.text(", \"position\": [")
          .number(vertex.position.x)
          .text(", ")
          .number(vertex.position.y)
          .text(", ");
      out.number(vertex.position.z).text("]}");
    }
    out.text("]}");
  }
  out.text("\n]}\n");
}

}  // namespace

void write_ray_paths(const std::string& path, const RayPaths& paths) {
  using Writer = void (*)(Output&, const RayPaths&);
  const Writer writer = path.ends_with(".vtp")    ? write_vtp
                        : path.ends_with(".csv")  ? write_csv
                        : path.ends_with(".json") ? write_json
                                                  : nullptr;
  if (path.ends_with(".npz")) {
    write_file(path, ray_path_npz(paths));
    return;
  }
  if (!writer)
    throw UsageError("'" + path + "': ray paths are written as .vtp, .csv, .json or .npz");
  Output out(path);
  writer(out, paths);
  out.commit();
}

}  // namespace plenoflame
