// PLY (Turk, The PLY Polygon File Format, 1994): elements with properties that the header lists, as
// text or binary.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "solids/mesh_files.h"

namespace plenoflame {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr TypeName kTypes[] = {
    {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
    {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
    {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
    {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};

std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string name;
  bool list = false;
  Type count = Type::u8, type = Type::f32;  ///< of a list's length, of values
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { text, little, big };

struct Header {
  Format format = Format::text;
  std::vector<Element> elements;
};

Type type_of(std::string_view word) {
  for (const TypeName& known : kTypes)
    if (known.name == word) return known.type;
  throw MeshFault{fmt::format("its header names the type \"{}\", which PLY does not have", word)};
}

void read_property(MeshWords& words, Header& header) {
  if (header.elements.empty()) throw MeshFault{"its header has a property before any element"};
  Property property;
  std::string_view type = words.next();
  property.list = type == "list";
  if (property.list) {
    property.count = type_of(words.next());
    if (property.count == Type::f32 || property.count == Type::f64)
      throw MeshFault{"its header counts a list by a type that is not whole"};
    type = words.next();
  }
  property.type = type_of(type);
  property.name = words.next();
  header.elements.back().properties.push_back(std::move(property));
}

Header read_header(std::string_view& text) {
  Header header;
  if (MeshWords(mesh_line(text)).next() != "ply") throw MeshFault{"it does not begin with \"ply\""};
  for (;;) {
    if (text.empty()) throw MeshFault{"its header does not end"};
    MeshWords words(mesh_line(text));
    const std::string_view first = words.next();
    if (first == "end_header") return header;
    if (first == "format") {
      const std::string_view format = words.next();
      if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
        throw MeshFault{fmt::format("its format \"{}\" is none of PLY", format)};
      header.format = format == "ascii"                  ? Format::text
                      : format == "binary_little_endian" ? Format::little
                                                         : Format::big;
    } else if (first == "element") {
      Element element;
      element.name = words.next();
      const std::string_view count = words.next();
      const char* const end = count.data() + count.size();
      const auto [at, error] = std::from_chars(count.data(), end, element.count);
      if (error != std::errc() || at != end)
        throw MeshFault{"its header gives no number of elements"};
      header.elements.push_back(std::move(element));
    } else if (first == "property") {
      read_property(words, header);
    }
  }
}

/// Values one after the other, a row (an element) at a time.
class Values {
 public:
  virtual ~Values() = default;
  virtual void begin_row() = 0;
  virtual double next(Type type) = 0;
  /// The most rows of these properties that can still follow.
  virtual std::uint64_t most_rows(const std::vector<Property>& properties) const = 0;
};

class TextValues : public Values {
 public:
  TextValues(std::string_view text, std::uint64_t rows) : rest_(text), rows_(rows) {
    for (std::string_view left = text; !left.empty();)
      lines_ += MeshWords(mesh_line(left)).next().empty() ? 0 : 1;
    if (lines_ < rows) throw MeshFault{fmt::format("it has {} of {} lines of data", lines_, rows)};
  }
  void begin_row() override {
    std::string_view line;
    do line = mesh_line(rest_);
    while (MeshWords(line).next().empty() && !rest_.empty());
    words_ = MeshWords(line);
    ++row_;
  }
  double next(Type) override {
    const std::string_view word = words_.next();
    const std::optional<double> value = mesh_number(word);
    if (!value)
      throw MeshFault{word.empty()
                          ? fmt::format("line {} of its data has too few numbers", row_)
                          : fmt::format("line {} of its data: \"{}\" is not a number", row_, word)};
    return *value;
  }
  std::uint64_t most_rows(const std::vector<Property>&) const override { return lines_; }

 private:
  std::string_view rest_;
  MeshWords words_{""};
  std::uint64_t rows_, lines_ = 0, row_ = 0;
};

class BinaryValues : public Values {
 public:
  BinaryValues(std::string_view bytes, bool big)
      : rest_(bytes), swap_(big == (std::endian::native == std::endian::little)) {}
  void begin_row() override {}
  double next(Type type) override {
    switch (type) {
      case Type::i8:
        return take<std::int8_t>();
      case Type::u8:
        return take<std::uint8_t>();
      case Type::i16:
        return take<std::int16_t>();
      case Type::u16:
        return take<std::uint16_t>();
      case Type::i32:
        return take<std::int32_t>();
      case Type::u32:
        return take<std::uint32_t>();
      case Type::f32:
        return static_cast<double>(take<float>());
      case Type::f64:
        return take<double>();
    }
    return 0;
  }
  std::uint64_t most_rows(const std::vector<Property>& properties) const override {
    std::size_t least = 0;  // bytes of a row
    for (const Property& property : properties)
      least += size_of(property.list ? property.count : property.type);
    // Rows of nothing take no memory either.
    return least > 0 ? rest_.size() / least : 0;
  }

 private:
  template <class T>
  T take() {
    if (rest_.size() < sizeof(T)) throw MeshFault{"it ends before all of its elements have come"};
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof(T));
    if (swap_) std::reverse(bytes, bytes + sizeof(T));
    rest_.remove_prefix(sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  std::string_view rest_;
  bool swap_;
};

/// The number that a property has: 0 to 2 place, 3 to 5 normal, 6 and 7 texture; -1: none.
int role_of(std::string_view name) {
  constexpr std::string_view kNames[8][3] = {{"x"},
                                             {"y"},
                                             {"z"},
                                             {"nx"},
                                             {"ny"},
                                             {"nz"},
                                             {"u", "s", "texture_u"},
                                             {"v", "t", "texture_v"}};
  for (int role = 0; role < 8; ++role)
    for (const std::string_view known : kNames[role])
      if (!known.empty() && known == name) return role;
  return -1;
}

class PlyReader {
 public:
  explicit PlyReader(Values& values) : values_(values) {}

  MeshFile read(const Header& header) {
    for (const Element& element : header.elements) {
      if (element.count > values_.most_rows(element.properties) && !element.properties.empty())
        throw MeshFault{
            fmt::format("it is too short for {} elements \"{}\"", element.count, element.name)};
      if (element.properties.empty()) continue;
      if (element.name == "vertex")
        read_vertices(element);
      else
        read_faces(element, element.name == "face");
    }
    check();
    return std::move(file_);
  }

 private:
  double next_count(const Property& property) {
    const double count = values_.next(property.count);
    if (!(count >= 0 && count <= 4294967295.0 && count == std::floor(count)))
      throw MeshFault{"a list of it has no whole number of entries"};
    return count;
  }

  void read_vertices(const Element& element) {
    std::vector<int> roles;
    bool has[8] = {};
    for (const Property& property : element.properties) {
      roles.push_back(property.list ? -1 : role_of(property.name));
      if (roles.back() >= 0) has[roles.back()] = true;
    }
    if (!(has[0] && has[1] && has[2])) throw MeshFault{"its vertices have no x, y and z"};
    with_normals_ = has[3] && has[4] && has[5];
    with_texture_ = has[6] && has[7];
    for (std::uint64_t row = 0; row < element.count; ++row) {
      values_.begin_row();
      double v[8] = {};
      for (std::size_t p = 0; p < roles.size(); ++p) {
        const Property& property = element.properties[p];
        if (property.list) {
          for (double left = next_count(property); left > 0; --left) values_.next(property.type);
          continue;
        }
        const double value = values_.next(property.type);
        if (roles[p] >= 0) v[roles[p]] = value;
      }
      file_.vertices.push_back({v[0], v[1], v[2]});
      if (with_normals_) file_.normals.push_back({v[3], v[4], v[5]});
      if (with_texture_) file_.texture.push_back({v[6], v[7]});
    }
  }

  void read_faces(const Element& element, bool wanted) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      values_.begin_row();
      for (const Property& property : element.properties) {
        const bool corners = wanted && property.list &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        const double count = property.list ? next_count(property) : 1;
        for (double k = 0; k < count; ++k) {
          const double value = values_.next(property.type);
          if (corners) add_corner(value);
        }
        if (corners) file_.corner_counts.push_back(static_cast<std::uint32_t>(count));
      }
    }
  }

  void add_corner(double value) {
    if (!(value >= 0 && value < 9e15 && value == std::floor(value)))
      throw MeshFault{fmt::format("face {} names a vertex that does not exist",
                                  file_.corner_counts.size() + 1)};
    file_.corners.push_back({static_cast<std::int64_t>(value), -1, -1});
  }

  /// Faces may stand before the vertices.
  void check() {
    std::size_t at = 0;
    for (std::size_t face = 0; face < file_.corner_counts.size(); ++face)
      for (std::uint32_t k = 0; k < file_.corner_counts[face]; ++k, ++at) {
        MeshFile::Corner& corner = file_.corners[at];
        if (corner.vertex >= static_cast<std::int64_t>(file_.vertices.size()))
          throw MeshFault{fmt::format("face {} names a vertex that does not exist", face + 1)};
        if (with_normals_) corner.normal = corner.vertex;
        if (with_texture_) corner.texture = corner.vertex;
      }
  }

  Values& values_;
  MeshFile file_;
  bool with_normals_ = false, with_texture_ = false;
};

}  // namespace

MeshFile read_ply(std::string_view bytes) {
  const Header header = read_header(bytes);
  if (header.format != Format::text) {
    BinaryValues values(bytes, header.format == Format::big);
    return PlyReader(values).read(header);
  }
  std::uint64_t rows = 0;
  for (const Element& element : header.elements)
    if (!element.properties.empty() && __builtin_add_overflow(rows, element.count, &rows))
      throw MeshFault{"its header gives more elements than there can be"};
  TextValues values(bytes, rows);
  return PlyReader(values).read(header);
}

}  // namespace plenoflame
