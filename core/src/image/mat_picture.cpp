// MAT-File Level 5 (MathWorks, MAT-File Format, chapter 1): elements with a tag of type and size.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <string_view>

#include "image/picture_arrays.h"

namespace plenoflame {
namespace {

enum MatType : std::uint32_t {
  kInt8 = 1,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kSingle,
  kDouble = 9,
  kInt64 = 12,
  kUint64,
  kMatrix,
  kCompressed
};
constexpr std::size_t kHeader = 128, kMatTag = 8;  // bytes
constexpr std::size_t kMatHead = 4096;  // bytes of a variable that hold flags, sides and name
constexpr std::uint32_t kFirstNumeric = 6, kUint8Class = 9, kLastNumeric = 15;  // classes
constexpr std::uint32_t kComplex = 0x800;                                       // flag

struct Element {
  std::uint32_t type = 0;
  std::string_view data;
};

class MatFile {
 public:
  MatFile(const std::string& path, const std::string& bytes)
      : path_(path), swapped_(bytes.substr(126, 2) == "MI") {
    if (std::endian::native == std::endian::big) swapped_ = !swapped_;
    std::string_view rest(bytes);
    rest.remove_prefix(kHeader);
    while (rest.size() >= kMatTag) {
      const Element element = next(rest);
      if (element.type == kCompressed || element.type == kMatrix) list(element);
    }
  }

  const std::vector<PictureArray>& arrays() const { return arrays_; }
  /// Unpacks one of arrays(), which has `count` numbers.
  void open(const PictureArray& array, std::size_t count) {
    const Element& element = elements_[static_cast<std::size_t>(&array - arrays_.data())];
    std::string_view matrix = element.data;
    if (element.type == kCompressed) {
      const std::size_t size = at<std::uint32_t>(unpacked(element.data, kMatTag), 4);
      unpacked_ = unpacked(element.data, kMatTag + size + 1);  // inflate checks the sum at the end
      std::string_view inner(unpacked_);
      matrix = next(inner).data;
    }
    for (int part = 0; part < 3; ++part) next(matrix);  // flags, sides, name
    data_ = next(matrix);
    if (count > data_.data.size() / size_of(data_.type)) damaged();
  }
  /// Numbers of the array that is open, from one on.
  std::vector<double> values(std::size_t first, std::size_t count) const {
    std::vector<double> found(count);
    for (std::size_t k = 0; k < count; ++k) found[k] = number(data_, first + k);
    return found;
  }

 private:
  [[noreturn]] void damaged() const {
    refuse_picture(path_, "this .mat file is damaged or cut off");
  }

  template <class Number>
  Number at(std::string_view bytes, std::size_t offset) const {
    if (offset + sizeof(Number) > bytes.size()) damaged();
    std::array<char, sizeof(Number)> own{};
    std::copy_n(bytes.data() + offset, own.size(), own.data());
    if (swapped_) std::reverse(own.begin(), own.end());
    return std::bit_cast<Number>(own);
  }

  /// Takes an element off the front.
  Element next(std::string_view& rest) const {
    const auto type = at<std::uint32_t>(rest, 0);
    if (const std::uint32_t small = type >> 16; small != 0) {
      if (small > 4 || rest.size() < 8) damaged();
      const Element element{type & 0xffff, rest.substr(4, small)};
      rest.remove_prefix(8);
      return element;
    }
    const std::size_t size = at<std::uint32_t>(rest, 4);
    if (size > rest.size() - 8) damaged();
    const Element element{type, rest.substr(8, size)};
    const std::size_t padded = type == kCompressed ? size : (size + 7) / 8 * 8;
    rest.remove_prefix(std::min(rest.size(), 8 + padded));
    return element;
  }

  /// The first bytes of what was packed, `most` at most.
  std::string unpacked(std::string_view packed, std::size_t most) const {
    z_stream stream{};
    if (inflateInit(&stream) != Z_OK) damaged();
    const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    std::string out;
    std::vector<char> part(std::size_t{1} << 16);
    int status = Z_OK;
    while (status == Z_OK && out.size() < most) {
      const std::size_t room = std::min(part.size(), most - out.size());
      stream.next_out = reinterpret_cast<Bytef*>(part.data());
      stream.avail_out = static_cast<uInt>(room);
      status = inflate(&stream, Z_NO_FLUSH);
      out.append(part.data(), room - stream.avail_out);
    }
    if (status != Z_OK && status != Z_STREAM_END) damaged();
    return out;
  }

  /// Adds an array of numbers to the list. Only its head is unpacked.
  void list(const Element& element) {
    std::string_view matrix = element.data.substr(0, kMatHead);
    std::string head;
    if (element.type == kCompressed) {
      head = unpacked(element.data, kMatHead);
      if (head.size() < kMatTag) damaged();
      if (at<std::uint32_t>(head, 0) != kMatrix) return;
      matrix = std::string_view(head).substr(kMatTag);
    }
    const Element flags = next(matrix);
    const auto flag = at<std::uint32_t>(flags.data, 0), kind = flag & 0xff;
    if (kind < kFirstNumeric || kind > kLastNumeric || (flag & kComplex) != 0) return;
    const Element sides = next(matrix), name = next(matrix);
    PictureArray array;
    array.name = name.data;
    array.bits = kind == kUint8Class ? 8 : 16;
    array.by_columns = true;
    for (std::size_t k = 0; k + 4 <= sides.data.size(); k += 4) {
      const auto side = at<std::int32_t>(sides.data, k);
      if (side < 0) damaged();
      array.sides.push_back(static_cast<std::size_t>(side));
    }
    arrays_.push_back(array);
    elements_.push_back(element);
  }

  std::size_t size_of(std::uint32_t type) const {
    switch (type) {
      case kInt8:
      case kUint8:
        return 1;
      case kInt16:
      case kUint16:
        return 2;
      case kInt32:
      case kUint32:
      case kSingle:
        return 4;
      case kDouble:
      case kInt64:
      case kUint64:
        return 8;
      default:
        damaged();
    }
  }

  double number(const Element& data, std::size_t k) const {
    const std::size_t offset = k * size_of(data.type);
    switch (data.type) {
      case kInt8:
        return at<std::int8_t>(data.data, offset);
      case kUint8:
        return at<std::uint8_t>(data.data, offset);
      case kInt16:
        return at<std::int16_t>(data.data, offset);
      case kUint16:
        return at<std::uint16_t>(data.data, offset);
      case kInt32:
        return at<std::int32_t>(data.data, offset);
      case kUint32:
        return at<std::uint32_t>(data.data, offset);
      case kSingle:
        return static_cast<double>(at<float>(data.data, offset));
      case kDouble:
        return at<double>(data.data, offset);
      case kInt64:
        return static_cast<double>(at<std::int64_t>(data.data, offset));
      default:
        return static_cast<double>(at<std::uint64_t>(data.data, offset));
    }
  }

  const std::string& path_;
  bool swapped_;
  std::vector<PictureArray> arrays_;
  std::vector<Element> elements_;  ///< of each array
  std::string unpacked_;           ///< the open array's
  Element data_;                   ///< the open array's numbers
};

}  // namespace

void read_mat_pictures(const std::string& path, const std::string& bytes, const std::string& name,
                       const std::function<void(RawPicture&&)>& take) {
  if (bytes.size() < kHeader) refuse_picture(path, "this .mat file is damaged or cut off");
  MatFile file(path, bytes);
  const PictureArray& array = chosen_array(path, name, file.arrays());
  const PictureSides sides = picture_sides(path, array);
  file.open(array, sides.frames * sides.frame());
  for (std::size_t frame = 0; frame < sides.frames; ++frame)
    take(picture_of_array(path, "MAT 5", array, file.values(frame * sides.frame(), sides.frame())));
}

}  // namespace plenoflame
