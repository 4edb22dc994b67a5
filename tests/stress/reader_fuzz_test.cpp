// Damaged files of every kind that the core reads end in one line, or in something consistent. The
// sanitizer builds make stray accesses visible; PLENOFLAME_DAMAGED_FILES=100000 tries so many of
// each kind.
#include <cmath>

#include "plenoflame/film/checkpoint.h"
#include "plenoflame/image/array_set.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/image/tiff_file.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/radiometry/spectral_response.h"
#include "plenoflame/scene/lens_file.h"
#include "plenoflame/scene/scene_settings.h"
#include "plenoflame/scene/validate.h"
#include "scene/files/time_table.h"
#include "support/damaged_files.h"
#include "support/source_folder.h"

namespace plenoflame::test::reader_fuzz_test {
namespace {

using Random = std::mt19937_64;

TEST(DamagedReaders, LightFields) {
  const TemporaryFolder folder;
  LightField field;
  field.sensor_width = 12;
  field.sensor_height = 9;
  field.window = {2, 1, 7, 6};
  field.channels = {{"total", Image(7, 6, 1e-9F), Image(7, 6, 1e-11F)}};
  for (int i = 0; i < 42; ++i) field.channels[0].flux.pixels[i] = 1e-9F * static_cast<float>(i % 5);
  field.layers["depth"] = Image(7, 6, 1);
  field.scene_text = "[camera]\n";
  field.numbers["array.pitch"] = 1e-4;
  field.texts["note"] = "text";
  std::vector<std::string> samples;
  const std::string path = folder.file("a.exr");
  for (const ExrCompression packed :
       {ExrCompression::none, ExrCompression::rle, ExrCompression::zip, ExrCompression::piz}) {
    write_light_field(path, field, {}, packed);
    samples.push_back(read_bytes(path));
  }
  const auto header = samples[0].size() - 3 * 42 * sizeof(float);
  Random random(20261125);
  read_damaged(
      "light fields (.exr)", damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_bytes(whole, header, random); },
      [&](const std::string& bytes) {
        write_bytes(path, bytes);
        const LightField back = read_light_field(path);
        const PixelWindow& w = back.window;
        ASSERT_TRUE(w.x >= 0 && w.y >= 0 && w.width > 0 && w.height > 0);
        ASSERT_LE(std::int64_t{w.x} + w.width, back.sensor_width);
        ASSERT_LE(std::int64_t{w.y} + w.height, back.sensor_height);
        const auto fills_window = [&](const Image& image) {
          return image.width == w.width && image.height == w.height &&
                 image.pixels.size() ==
                     static_cast<std::size_t>(w.width) * static_cast<std::size_t>(w.height);
        };
        ASSERT_FALSE(back.channels.empty());
        for (const LightFieldChannel& channel : back.channels) {
          ASSERT_TRUE(fills_window(channel.flux));
          ASSERT_TRUE(channel.standard_error.pixels.empty() ||
                      fills_window(channel.standard_error));
        }
        for (const auto& [name, layer] : back.layers) ASSERT_TRUE(fills_window(layer));
      });
}

TEST(DamagedReaders, Pictures) {
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
      for (std::size_t i = 0; i < image.sample_count(); ++i)
        image.samples.push_back(static_cast<std::uint16_t>(i * 37 % 256));
      image.texts["Comment"] = "text";
      write_png(path, image);
      samples.push_back(read_bytes(path));
    }
  Random random(20261126);
  read_damaged(
      "pictures (.png)", damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_bytes(whole, 120, random); },
      [&](const std::string& bytes) {
        write_bytes(path, bytes);
        const PngImage back = read_png(path);
        ASSERT_EQ(back.samples.size(), back.sample_count());
        ASSERT_GT(back.width, 0);
      });
}

/// A tiled TIFF of 12 bits in the other order of bytes, and a planar one in colour, by hand.
std::string tiff_by_hand(bool tiles) {
  std::string bytes("MM\0*\0\0\0\10", 8);
  const auto number = [&](std::uint32_t value, int size) {
    for (int i = size - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 255);
  };
  struct Entry {
    std::uint32_t tag, kind, count, value;
  };
  const std::vector<Entry> entries =
      tiles ? std::vector<Entry>{{256, 4, 1, 20},      {257, 4, 1, 9},       {258, 3, 1, 12 << 16},
                                 {259, 3, 1, 1 << 16}, {262, 3, 1, 1 << 16}, {277, 3, 1, 1 << 16},
                                 {322, 4, 1, 16},      {323, 4, 1, 16},      {324, 4, 2, 134},
                                 {325, 4, 2, 142}}
            : std::vector<Entry>{{256, 4, 1, 20},      {257, 4, 1, 9},       {258, 3, 3, 134},
                                 {259, 3, 1, 1 << 16}, {262, 3, 1, 2 << 16}, {273, 4, 3, 140},
                                 {277, 3, 1, 3 << 16}, {278, 4, 1, 9},       {279, 4, 3, 152},
                                 {284, 3, 1, 2 << 16}};
  number(static_cast<std::uint32_t>(entries.size()), 2);
  for (const Entry& entry : entries) {
    number(entry.tag, 2);
    number(entry.kind, 2);
    number(entry.count, 4);
    number(entry.value, 4);
  }
  number(0, 4);
  if (tiles) {
    for (const std::uint32_t value : {150U, 534U, 384U, 384U}) number(value, 4);
    bytes.append(768, '\x5a');
  } else {
    for (int i = 0; i < 3; ++i) number(8, 2);
    for (const std::uint32_t value : {164U, 344U, 524U, 180U, 180U, 180U}) number(value, 4);
    bytes.append(540, '\x31');
  }
  return bytes;
}

/// A JPEG of 9 x 7 pixels in two blocks, grey, by hand: codes of 4 bits, one of 1 bit.
std::string jpeg_by_hand() {
  std::string bytes("\xff\xd8\xff\xdb\0\x43\0", 7);
  bytes.append(64, '\1');
  bytes.append("\xff\xc0\0\x0b\x08\0\x07\0\x09\x01\x01\x11\0", 13);
  bytes.append("\xff\xc4\0\x1f\0\0\0\0\x0c", 9);
  bytes.append(12, '\0');
  for (int size = 0; size < 12; ++size) bytes += static_cast<char>(size);
  bytes.append("\xff\xc4\0\x14\x10\x01", 6);
  bytes.append(16, '\0');
  bytes.append("\xff\xda\0\x08\x01\x01\0\0\x3f\0", 10);
  // 0011 101 0, a step of 5 and the end of a block; 0000 0 111, none.
  bytes.append("\x3a\x07\xff\xd9", 4);
  return bytes;
}

/// Numbers, the lowest byte first.
std::string little(std::initializer_list<std::uint32_t> values, int size = 4) {
  std::string bytes;
  for (const std::uint32_t value : values)
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
  return bytes;
}

/// An element of MAT 5 that holds an array: its class, sides, name of one letter and numbers.
std::string mat_array(std::uint32_t kind, std::uint32_t rows, std::uint32_t columns, char name,
                      const std::string& numbers) {
  const std::string data =
      little({6, 8, kind, 0, 5, 8, rows, columns, 0x10001}) + name + std::string(3, '\0') + numbers;
  return little({14, static_cast<std::uint32_t>(data.size())}) + data;
}

/// MAT 5 with a number, and 7 x 9 numbers of 16 bits that are packed (deflate, one stored block).
std::string mat_by_hand() {
  const std::string array = mat_array(11, 7, 9, 'a', little({4, 126}) + std::string(128, '\1'));
  const auto size = static_cast<std::uint32_t>(array.size());
  std::uint32_t a = 1, b = 0;  // Adler's sum
  for (const char byte : array) {
    a = (a + static_cast<unsigned char>(byte)) % 65521;
    b = (b + a) % 65521;
  }
  std::string packed = "\x78\x01\x01" + little({size, ~size}, 2) + array;
  for (const std::uint32_t part : {b >> 8, b, a >> 8, a}) packed += static_cast<char>(part & 255);
  std::string bytes = "MATLAB 5.0 MAT-file";
  bytes.resize(124, ' ');
  return bytes + little({0x0100, 0x4d49}, 2) +
         mat_array(6, 1, 1, 'b', little({9, 8}) + std::string(8, '\0')) +
         little({15, static_cast<std::uint32_t>(packed.size())}) + packed;
}

/// A Lytro camera's file of 12 x 7 numbers of 12 bits.
std::string lytro_by_hand() {
  std::string bytes("\x89LFP\r\n\x1a\n\0\0\0\0\0\0\0\0", 16);
  const auto section = [&](char kind, const std::string& name, const std::string& data) {
    bytes += std::string("\x89LF") + kind + std::string("\r\n\x1a\n\0\0\0\0\0\0", 10);
    bytes += static_cast<char>(data.size() >> 8);
    bytes += static_cast<char>(data.size() & 255);
    bytes += name + std::string(80 - name.size(), '\0') + data;
    bytes.resize((bytes.size() + 15) / 16 * 16);
  };
  section('M', "t", R"({"frames": [{"frame": {"metadataRef": "m", "imageRef": "i"}}]})");
  section('C', "m",
          R"({"image": {"width": 12, "height": 7, "pixelPacking": {"bitsPerPixel": 12,)"
          R"( "endianness": "big"}}})");
  section('C', "i", std::string(126, '\1'));
  return bytes;
}

TEST(DamagedReaders, RawPictures) {
  const TemporaryFolder folder;
  const std::string arrays = folder.file("a.h5");
  ArraySetWriter writer(arrays);
  writer.numbers("frames", std::vector<double>(126, 7), "1", {2, 7, 9});
  writer.close();
  const std::string path = folder.file("a.tif");
  write_tiff(path, 9, 7, std::vector<std::uint16_t>(63, 1234), "a frame");
  const std::vector<std::string> samples{
      read_bytes(path),       tiff_by_hand(true),
      tiff_by_hand(false),    "P5\n# a camera\n9 7\n4095\n" + std::string(126, '\1'),
      std::string(126, '\1'), jpeg_by_hand(),
      mat_by_hand(),          lytro_by_hand(),
      read_bytes(arrays)};
  RawLayout layout;
  layout.width = 9;
  layout.height = 7;
  const auto read = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    int pictures = 0;
    read_raw_pictures(path, layout, [&](RawPicture&& picture) {
      ++pictures;
      ASSERT_EQ(picture.samples.size(),
                picture.pixel_count() * static_cast<std::size_t>(picture.channels));
      ASSERT_GT(picture.width, 0);
      ASSERT_LE(picture.bits, 16);
    });
    ASSERT_GT(pictures, 0);
  };
  for (const std::string& sample : samples) ASSERT_NO_THROW(read(sample));
  Random random(20261133);
  read_damaged(
      "raw pictures (.tif, .pgm, .jpg, headerless, .mat, .lfp, .h5)", damaged_files_wanted(3000),
      samples, [&](const std::string& whole) { return damage_bytes(whole, 400, random); }, read);
}

TEST(DamagedReaders, States) {
  const TemporaryFolder folder;
  Film film({3, 2, 70, 5}, 2, 2);
  film.sum(0, 1, 4, 3) = 1.5;
  film.add_samples(0, 8);
  const std::string path = folder.file("state");
  write_checkpoint(path, film, "key");
  Random random(20261127);
  read_damaged(
      "states of runs", damaged_files_wanted(2000), {read_bytes(path)},
      [&](const std::string& whole) {
        // A checksum refuses all else: some files are cut short behind what is right.
        return below(20, random) == 0 ? whole : damage_bytes(whole, 120, random);
      },
      [&](const std::string& bytes) {
        write_bytes(path, bytes);
        ASSERT_TRUE(read_checkpoint(path, read_checkpoint_key(path)) == film);
      });
}

TEST(DamagedReaders, Matrices) {
  const TemporaryFolder folder;
  const CsrMatrix<float> matrix(4, {0, 2, 2, 4}, {0, 3, 1, 2}, {1.5F, -2, 0.25F, 4});
  for (const std::string ending : {"npz", "h5", "mtx"}) {
    const std::string path = folder.file("a." + ending);
    write_csr(path, matrix);
    const std::string whole = read_bytes(path);
    Random random(20261128);
    const std::string what = "matrices (." + ending + ")";
    read_damaged(
        what.c_str(), damaged_files_wanted(1000), {whole},
        [&](const std::string& bytes) { return damage_bytes(bytes, bytes.size(), random); },
        [&](const std::string& bytes) {
          write_bytes(path, bytes);
          const CsrMatrix<float> back = read_csr(path);
          std::vector<double> x(back.columns(), 1.0), y(back.rows());
          if (back.columns() < 1000 && back.rows() < 1000) make_csr_operator(back)->apply(x, y);
        },
        {0.01, 0.5});
  }
}

// Scenes with every kind of table, in text; what can be read is checked, too.
TEST(DamagedReaders, Scenes) {
  std::vector<std::string> samples;
  for (const char* name : {"quartz-tube", "three-filters", "three-cameras", "square-lenses",
                           "smoke", "candle-colours", "calibration-plate", "lenslets-30"})
    samples.push_back(read_bytes(std::string(PLENOFLAME_SOURCE_DIR "/examples/") + name + ".toml"));
  for (const std::string& sample : samples) ASSERT_FALSE(sample.empty());
  const std::vector<std::string> words = awkward_words();
  Random random(20261129);
  read_damaged(
      "scenes (.toml)", damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_text(whole, words, random); },
      [&](const std::string& text) {
        const SceneDocument document = parse_embedded_scene(text, "a.toml");
        static_cast<void>(validate(document.scene));
        static_cast<void>(write_scene(document.scene));
      });
}

TEST(DamagedReaders, Layers) {
  const std::string layers =
      "[[layers]]\nname = \"core\"\ncentre = [\"0 m\", \"0 m\", \"8 mm\"]\n"
      "semi_axes = [\"4 mm\", \"4 mm\", \"12 mm\"]\ntemperature = \"1800 K\"\n"
      "absorption = \"20 1/m\"\n\n[[layers]]\nsemi_axes = [\"6 mm\", \"6 mm\", \"16 mm\"]\n"
      "temperature = \"1500 degC\"\nvolume_fraction = 1e-6\n";
  ASSERT_NO_THROW(static_cast<void>(parse_layers(layers, "a.toml")));
  const std::vector<std::string> words = awkward_words();
  Random random(20261130);
  read_damaged(
      "layers of flames (.toml)", damaged_files_wanted(2000), {layers},
      [&](const std::string& whole) { return damage_text(whole, words, random); },
      [&](const std::string& text) {
        for (const EllipsoidSpec& layer : parse_layers(text, "a.toml"))
          ASSERT_TRUE(std::isfinite(layer.temperature) && layer.semi_axes.x > 0);
      });
}

TEST(DamagedReaders, Lenses) {
  const std::string columns =
      "# sample\n56.20238 8.75 1.622292 66\n152.28580 0.5 1 66\n37.68262 12.5 1.607379 56\n"
      "1e9 3.8 1.603417 56\n24.2313 16.369445 1.0 42\n0 13.747957 0 34.4\n"
      "-28.37731 3.8 1.603417 46\n-1e9\t11 1.620408 56\r\n-37.92546 61.5 1 56\n";
  const std::string zemax =
      "VERS 140124 258 36214\nMODE SEQ\nNAME A doublet\nUNIT MM X W X CM MR CPMM\n"
      "SURF 0\n  TYPE STANDARD\n  CURV 0.0 0 0 0 0 \"\"\n  DISZ INFINITY\n"
      "SURF 1\n  STOP\n  TYPE STANDARD\n  CURV 1.932292471788530E-02 0 0\n  DISZ 9\n"
      "  GLAS N-BK7 0 0 1.5168 64.17\n  DIAM 13.5 1 0 0 1 \"\"\n"
      "SURF 2\n  TYPE EVENASPH\n  CURV -2.233289411974898E-02 0\n  PARM 2 1.5E-7\n"
      "  CONI -0.4\n  DISZ 3\n  GLAS SF2 0 0 1.64769 33.85\n  DIAM 13.5 1 0\n"
      "SURF 3\n  TYPE STANDARD\n  CURV -4.600281537230078E-03 0\n  DISZ 92.75\n  DIAM 13.5 1 0\n"
      "SURF 4\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n  DIAM 10\n";
  std::vector<std::string> words = awkward_words();
  words.insert(words.end(), {"SURF 1", "SURF 99999999", "GLAS ", "PARM 16 1", "UNIT IN", "STOP\n"});
  const auto consistent = [](const LensFile& file) {
    ASSERT_FALSE(file.lens.surfaces.empty());
    static_cast<void>(write_lens(file.lens));
  };
  Random random(20261131);
  const auto damage = [&](const std::string& whole) { return damage_text(whole, words, random); };
  const int files = damaged_files_wanted(2000);
  read_damaged("lenses (four columns)", files, {columns}, damage,
               [&](const std::string& text) { consistent(import_four_columns(text, "a.dat")); });
  read_damaged("lenses (.zmx)", files, {zemax}, damage,
               [&](const std::string& text) { consistent(import_zmx(text, "a.zmx")); });
}

TEST(DamagedReaders, Curves) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.csv");
  const std::vector<std::string> samples{
      "wavelength_nm,response\n400,0\n500,0.5\n600,1\n700,0.25\n",
      "# a camera\nwavelength_um;response\n0.4;0\n0.5;0.5\n0.6;1\n", "400 0\n500 1\n"};
  const std::vector<std::string> words = awkward_words();
  Random random(20261132);
  read_damaged(
      "curves (.csv)", damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_text(whole, words, random); },
      [&](const std::string& text) {
        write_bytes(path, text);
        const std::vector<SpectralPoint> points = read_spectral_csv(path);
        ASSERT_FALSE(points.empty());
        for (const SpectralPoint& point : points) ASSERT_TRUE(std::isfinite(point.wavelength));
      });
}

TEST(DamagedReaders, TimeTables) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.csv");
  const std::vector<std::string> samples{
      "time [ms], x [mm], z [mm], brightness\n0, 0, -29, 1\n10, 2.5, -29, 0.8 # a gust\n",
      "\xef\xbb\xbftime_s;scale\r\n0;1\r\n0.5;1.25\r\n1;2\r\n", "time (us)\ty (m)\n-5\t0\n5\t1"};
  for (const std::string& sample : samples) {
    write_bytes(path, sample);
    ASSERT_NO_THROW(static_cast<void>(TimeTable(path)));
  }
  const std::vector<std::string> words = awkward_words();
  Random random(20261133);
  read_damaged(
      "tables of time (.csv)", damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_text(whole, words, random); },
      [&](const std::string& text) {
        write_bytes(path, text);
        const TimeTable table(path);
        ASSERT_GT(table.rows(), 0U);
        ASSERT_LE(table.first_time(), table.last_time());
        for (const double share : {0.0, 0.3, 1.0}) {
          const FlameSpec flame =
              table.at((1 - share) * table.first_time() + share * table.last_time(), FlameSpec{});
          ASSERT_TRUE(std::isfinite(flame.position.x) && std::isfinite(flame.position.y) &&
                      std::isfinite(flame.position.z));
          ASSERT_TRUE(flame.scale > 0 && std::isfinite(flame.scale));
          ASSERT_TRUE(flame.brightness >= 0 && std::isfinite(flame.brightness));
        }
      });
}

}  // namespace
}  // namespace plenoflame::test::reader_fuzz_test
