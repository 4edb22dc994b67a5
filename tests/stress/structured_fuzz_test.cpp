// Files in which single fields hold what readers have to look out for, and whose checksums are
// right again: damage at random places does not get beyond those. Each is read and consistent, or
// refused in one line. PLENOFLAME_DAMAGED_FILES=100000 tries so many of each kind.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <regex>

#include "plenoflame/camera/camera_import.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/image/tiff_file.h"
#include "support/damaged_files.h"

namespace plenoflame::test::structured_fuzz_test {
namespace {

using Random = std::mt19937_64;

/// Numbers at the ends of what types hold, and some in between.
std::uint64_t awkward_number(Random& random) {
  constexpr std::array<std::uint64_t, 20> kNumbers{0,          1,
                                                   2,          3,
                                                   0x7f,       0x80,
                                                   0xff,       0x100,
                                                   0x7fff,     0x8000,
                                                   0xffff,     0x10000,
                                                   0x7fffffff, 0x80000000,
                                                   0xffffffff, 1ULL << 32,
                                                   1ULL << 53, 0x7fffffffffffffff,
                                                   1ULL << 63, 0xffffffffffffffff};
  const std::size_t choice = below(kNumbers.size() + 4, random);
  if (choice < kNumbers.size()) return kNumbers[choice];
  return random() >> below(64, random);
}

double awkward_double(Random& random) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr std::array<double, 9> kNumbers{
      0, -1, kInf, -kInf, std::numeric_limits<double>::quiet_NaN(), 1e300, 1e-320, 1e10, -0.0};
  return kNumbers[below(kNumbers.size(), random)];
}

void put(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t size,
         bool big = false) {
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<char>(value >> 8 * (big ? size - 1 - i : i) & 255U);
}

std::uint64_t get(const std::string& bytes, std::size_t at, std::size_t size, bool big = false) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    value |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])}
             << 8 * (big ? size - 1 - i : i);
  return value;
}

/// One field of a record: an integer of 1 to 8 bytes, or a double.
void put_awkward(std::string& bytes, std::size_t at, Random& random, bool big = false) {
  if (below(5, random) == 0)
    put(bytes, at, std::bit_cast<std::uint64_t>(awkward_double(random)), 8, big);
  else if (below(5, random) == 0)
    put(bytes, at, std::bit_cast<std::uint32_t>(static_cast<float>(awkward_double(random))), 4,
        big);
  else
    put(bytes, at, awkward_number(random), std::size_t{1} << below(4, random), big);
}

/// CRC-32 (ISO 3309), bit by bit.
std::uint32_t crc_of(std::string_view bytes) {
  std::uint32_t sum = 0xffffffffU;
  for (const char byte : bytes) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1U ? 0xedb88320U : 0U);
  }
  return ~sum;
}

/// FNV-1a of 64 bits.
std::uint64_t fnv_of(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char byte : bytes) sum = (sum ^ static_cast<unsigned char>(byte)) * 0x100000001b3U;
  return sum;
}

// --- states of runs ---

/// The state of one film: where its fields begin, as the shape that stands there says.
std::string damaged_state(std::string bytes, std::size_t shape_at, Random& random) {
  const std::size_t sum_at = shape_at + 24, tiles_at = sum_at + 8;
  const std::size_t kind = below(4, random);
  if (kind == 0) put(bytes, shape_at + 4 * below(6, random), awkward_number(random), 4);
  if (kind == 1) put(bytes, tiles_at + 8 * below(3, random), awkward_number(random), 8);
  if (kind == 2) put_awkward(bytes, tiles_at + below(bytes.size() - tiles_at, random), random);
  if (kind == 3)
    put(bytes, tiles_at + 8 * below(2, random),
        std::bit_cast<std::uint64_t>(awkward_double(random)), 8);
  // All but the number of goals is summed up, which stands behind the tiles' samples.
  const std::uint64_t width = get(bytes, shape_at + 8, 4), height = get(bytes, shape_at + 12, 4);
  const std::uint64_t tiles = (width + 63) / 64 * ((height + 63) / 64);
  if (tiles > bytes.size() / 8) return bytes;
  const std::size_t goals_at = tiles_at + 8 * tiles;
  if (goals_at + 8 > bytes.size()) return bytes;
  put(bytes, sum_at,
      fnv_of(bytes.substr(shape_at, 24) + bytes.substr(tiles_at, 8 * tiles) +
             bytes.substr(goals_at + 8)),
      8);
  return bytes;
}

TEST(StructuredDamage, States) {
  const TemporaryFolder folder;
  const std::string path = folder.file("state");
  Film film({3, 2, 70, 5}, 2, 2);
  film.sum(0, 1, 4, 3) = 1.5;
  film.add_samples(0, 8);
  film.tile_goals() = {16, 32};
  write_checkpoint(path, film, "key");
  const std::string whole = read_bytes(path);
  std::string shape(24, '\0');
  for (std::size_t i = 0; i < 6; ++i)
    put(shape, 4 * i, std::array<std::uint64_t, 6>{3, 2, 70, 5, 2, 2}[i], 4);
  const std::size_t shape_at = whole.find(shape);
  ASSERT_NE(shape_at, std::string::npos);
  const auto read = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    const Film back = read_checkpoint(path, read_checkpoint_key(path));
    ASSERT_EQ(back.all_tile_samples().size(), static_cast<std::size_t>(back.tile_count()));
    for (int t = 0; t < back.tile_count(); ++t)
      ASSERT_TRUE(back.tile_sums(t).empty() || back.tile_sums(t).size() == back.tile_values(t));
  };
  ASSERT_NO_THROW(read(whole));
  Random random(20261202);
  read_damaged("states of runs, sums repaired", damaged_files_wanted(2000), {whole},
               [&](const std::string& bytes) { return damaged_state(bytes, shape_at, random); },
               read, {0.1, 0.1});
}

// --- pictures ---

/// A chunk of a PNG gets an awkward field, and its sum.
std::string damaged_png(std::string bytes, Random& random) {
  std::vector<std::size_t> chunks;
  for (std::size_t at = 8; at + 12 <= bytes.size(); at += 12 + get(bytes, at, 4, true))
    chunks.push_back(at);
  // The first one, of sizes and kinds, gets half of the damage.
  const std::size_t at = chunks[below(2, random) == 0 ? 0 : below(chunks.size(), random)];
  const std::size_t size = get(bytes, at, 4, true);
  if (below(12, random) == 0)
    put(bytes, at, awkward_number(random), 4, true);
  else if (below(12, random) == 0)
    put(bytes, at + 4, random(), 4, true);  // another kind of chunk
  else if (size > 0)
    put_awkward(bytes, at + 8 + below(size, random), random, true);
  put(bytes, at + 8 + size, crc_of(std::string_view(bytes).substr(at + 4, size + 4)), 4, true);
  if (below(10, random) == 0) bytes.insert(at, bytes.substr(at, 12 + size));  // twice
  return bytes;
}

TEST(StructuredDamage, Pictures) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  std::vector<std::string> samples;
  for (const int channels : {1, 3})
    for (const int bits : {8, 16}) {
      PngImage image;
      image.width = 9;
      image.height = 6;
      image.bits = bits;
      image.channels = channels;
      image.significant_bits = bits - 2;
      for (std::size_t i = 0; i < image.sample_count(); ++i)
        image.samples.push_back(static_cast<std::uint16_t>(i * 37 % 64));
      image.texts["Comment"] = "text";
      write_png(path, image);
      samples.push_back(read_bytes(path));
    }
  Random random(20261203);
  read_damaged(
      "pictures (.png), sums repaired", damaged_files_wanted(2000), samples,
      [&](const std::string& bytes) { return damaged_png(bytes, random); },
      [&](const std::string& bytes) {
        write_bytes(path, bytes);
        const PngImage back = read_png(path);
        ASSERT_EQ(back.samples.size(), back.sample_count());
        ASSERT_GT(back.width, 0);
      },
      {0.02, 0.2});
}

/// An entry of a TIFF's directory gets another tag, kind, count or value.
std::string damaged_tiff(std::string bytes, Random& random) {
  const bool big = bytes[0] == 'M';
  const std::size_t directory = get(bytes, 4, 4, big), entries = get(bytes, directory, 2, big);
  for (std::size_t n = 1 + below(2, random); n > 0; --n) {
    const std::size_t entry = directory + 2 + 12 * below(entries, random);
    switch (below(8, random)) {
      case 0:
        put(bytes, entry, random() % 340, 2, big);
        break;
      case 1:
        put(bytes, entry + 2, random() % 14, 2, big);
        break;
      case 2:
        put(bytes, entry + 4, awkward_number(random), 4, big);
        break;
      case 3:
        put(bytes, entry + 8, awkward_number(random), 2, big);
        break;
      case 4:
        put(bytes, entry + 8, below(bytes.size() + 8, random), 4, big);
        break;
      case 5:  // the list or text that it leads to
        put_awkward(bytes, get(bytes, entry + 8, 4, big) % bytes.size(), random, big);
        break;
      case 6:
        put(bytes, directory + 2 + 12 * entries,
            below(2, random) == 0 ? directory : awkward_number(random), 4, big);
        break;
      default:
        put(bytes, entry + 8, awkward_number(random), 4, big);
    }
  }
  return bytes;
}

/// A segment of a JPEG gets another length or field.
std::string damaged_jpeg(std::string bytes, Random& random) {
  std::vector<std::size_t> segments;
  for (std::size_t at = 2; at + 4 <= bytes.size() && bytes[at] == '\xff';
       at += 2 + get(bytes, at + 2, 2, true))
    segments.push_back(at);
  const std::size_t at = segments[below(segments.size(), random)],
                    size = get(bytes, at + 2, 2, true);
  if (below(6, random) == 0)
    put(bytes, at + 2, awkward_number(random), 2, true);
  else if (below(8, random) == 0)
    bytes[at + 1] = static_cast<char>(0xc0 + below(32, random));
  else
    put(bytes, at + 4 + below(size, random), awkward_number(random), 1 + below(2, random), true);
  return bytes;
}

/// A number of a text becomes another one.
std::string with_awkward_number(const std::string& text, Random& random) {
  static const std::regex kNumber("-?[0-9]+(\\.[0-9]+)?([eE][-+]?[0-9]+)?");
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (std::sregex_iterator at(text.begin(), text.end(), kNumber), end; at != end; ++at)
    places.emplace_back(static_cast<std::size_t>(at->position()),
                        static_cast<std::size_t>(at->length()));
  if (places.empty()) return text;
  const auto [place, length] = places[below(places.size(), random)];
  const std::array<std::string, 6> words{
      std::to_string(awkward_number(random)),
      std::to_string(static_cast<std::int64_t>(awkward_number(random))),
      "1e308",
      "-1e-310",
      "nan",
      "0." + std::to_string(random())};
  std::string other = text;
  return other.replace(place, length, words[below(words.size(), random)]);
}

TEST(StructuredDamage, RawPictures) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.tif");
  write_tiff(path, 9, 7, std::vector<std::uint16_t>(63, 1234), "a frame");
  const std::string tiff = read_bytes(path);
  const std::string pgm = "P5\n# a camera\n9 7\n4095\n" + std::string(126, '\1');
  // 9 x 7 pixels in two blocks, grey: codes of 4 bits, one of 1 bit.
  std::string jpeg("\xff\xd8\xff\xdb\0\x43\0", 7);
  jpeg.append(64, '\1').append("\xff\xc0\0\x0b\x08\0\x07\0\x09\x01\x01\x11\0", 13);
  jpeg.append("\xff\xc4\0\x1f\0\0\0\0\x0c", 9).append(12, '\0');
  for (int size = 0; size < 12; ++size) jpeg += static_cast<char>(size);
  jpeg.append("\xff\xc4\0\x14\x10\x01", 6).append(16, '\0');
  jpeg.append("\xff\xda\0\x08\x01\x01\0\0\x3f\0", 10).append("\x3a\x07\xff\xd9", 4);
  RawLayout layout;
  layout.width = 9;
  layout.height = 7;
  const auto read = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    read_raw_pictures(path, layout, [&](RawPicture&& picture) {
      ASSERT_EQ(picture.samples.size(),
                picture.pixel_count() * static_cast<std::size_t>(picture.channels));
      ASSERT_GT(picture.width, 0);
      ASSERT_LE(picture.bits, 16);
    });
  };
  const int files = damaged_files_wanted(1000);
  Random random(20261204);
  for (const std::string& sample : {tiff, pgm, jpeg}) ASSERT_NO_THROW(read(sample));
  read_damaged("raw pictures (.tif), fields", files, {tiff},
               [&](const std::string& bytes) { return damaged_tiff(bytes, random); }, read,
               {0.02, 0.2});
  read_damaged("raw pictures (.jpg), segments", files, {jpeg},
               [&](const std::string& bytes) { return damaged_jpeg(bytes, random); }, read,
               {0.02, 0.2});
  read_damaged("raw pictures (.pgm), numbers", files, {pgm},
               [&](const std::string& bytes) { return with_awkward_number(bytes, random); }, read,
               {0.02, 0.2});
}

// --- cameras of other tools ---

TEST(StructuredDamage, Calibrations) {
  const TemporaryFolder folder;
  const std::vector<std::string> samples{
      R"({"I": 1, "dist_focus": 450, "distortions": {"radial": [[0.03, -0.002, 1e-5]], "tangential": [[0.01, -0.005]]},
          "main_lens": {"f": 50, "aperture": 4}, "sensor": {"width": 500, "height": 400, "scale": 0.004,
          "pose": {"translation": [[-1.1, -0.7, -58.3]]}}, "mla": {"focal_lengths": [0.5], "mesh": {"geometry": 1,
          "width": 60, "height": 60, "pitch": [[0.1, 0.1]], "pose": {"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
          "translation": [[-2.6, -2.2, -58.0]]}}}})",
      "[micro_lenses_array]\nz=400.0\n[micro_lens]\nphysical_size_s=300e-3\nphysical_size_t=310e-"
      "3\nf2=18.6\n"
      "[sensor]\npixel_size_x=6.45e-3\npixel_size_y=6.45e-3\nsize_x=200\nsize_y=100\nz=418.6\n["
      "main_lens]\nf1=200.0\n"
      "aperture=6.6\n",
      R"({"LensletGridModel": {"HSpacing": 33, "VSpacing": 28.57, "HOffset": 20.0, "VOffset": 15.5, "Rot": 0,
          "UMax": 11, "VMax": 10, "FirstPosShiftRow": 2, "Orientation": "horz"}})",
      "<RayCalibData>\n<offset><x>1.5</x><y>-2</y></offset><diameter>23.3</"
      "diameter><rotation>0.01</rotation>\n"
      "<lens_type><id>0</id><depth_range><min>1</min><max>3</max></depth_range></lens_type>\n</"
      "RayCalibData>\n",
      R"({"mic_list": [[10, 10, 0, 0], [10, 30, 0, 1], [10, 50, 0, 2], [30, 10, 1, 0], [30, 30, 1, 1], [30, 50, 1, 2],
          [50, 10, 2, 0], [50, 30, 2, 1], [50, 50, 2, 2]], "pat_type": "rec"})",
      "k,l,u,v\n0,0,10,10\n1,0,30,10\n2,0,50,10\n0,1,10,30\n1,1,30,30\n2,1,50,30\n0,2,10,50\n1,2,"
      "30,50\n2,2,50,50\n"};
  CameraSpec given;
  given.lens.focal_length = 0.05;
  given.lens.diameter = 0.0125;
  given.focus.lens_distance = 0.0567;
  given.array.sensor_distance = 0.4e-3;
  given.array.types = {{"a", kInfinity, kInfinity, 1.5, 0.5e-3}};
  given.sensor.columns = 400;
  given.sensor.rows = 300;
  given.sensor.pixel_pitch = 2.5e-6;
  const std::string path = folder.file("camera");
  std::vector<std::string> words = awkward_words();
  words.insert(words.end(),
               {"null", "{}", "[[", "</", "/>", "&#0;", "\"mla\":", "1e999", "[micro_lens]"});
  const auto read = [&](const std::string& text) {
    write_bytes(path, text);
    const ImportedCamera found = import_camera({path}, given);
    ASSERT_FALSE(found.formats.empty());
    ASSERT_TRUE(std::isfinite(found.camera.array.pitch) &&
                std::isfinite(found.camera.lens.focal_length));
  };
  for (const std::string& sample : samples) ASSERT_NO_THROW(read(sample)) << sample;
  Random random(20261205);
  read_damaged("cameras of other tools", damaged_files_wanted(2000), samples,
               [&](const std::string& text) {
                 return below(2, random) == 0 ? with_awkward_number(text, random)
                                              : damage_text(text, words, random);
               },
               read, {0.05, 0.2});
}

}  // namespace
}  // namespace plenoflame::test::structured_fuzz_test
