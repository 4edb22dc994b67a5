// Compiled cameras: few rays a pixel in place of its bundle.
#include "plenoflame/render/compiled_camera.h"

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "plenoflame/base/error.h"
#include "plenoflame/sampling/sobol.h"
#include "render/compiled/moment_walk.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/damaged_files.h"
#include "support/flame_scenes.h"
#include "support/length.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::compiled_camera_test {
namespace {

struct Point {
  double x, y, weight;
};

/// Points of a bent cloud, by a generator of their own.
std::vector<Point> cloud(std::size_t count) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Point> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = 2 * uniform() - 1;
    points.push_back({x, x * x + 0.5 * uniform(), 0.2 + uniform()});
  }
  return points;
}

std::array<double, 6> quadratics(const Point& p) {
  return {1, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y};
}

std::vector<MomentWalk::Kept> reduced(const std::vector<Point>& points, std::uint64_t seed) {
  MomentWalk walk(6);
  WalkRandom random(seed);
  walk.start();
  for (std::size_t i = 0; i < points.size(); ++i)
    walk.add(i, quadratics(points[i]).data(), points[i].weight, random);
  return walk.kept();
}

TEST(MomentWalk, KeepsMomentsWithAsManyPoints) {
  const std::vector<Point> points = cloud(200);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto kept = reduced(points, seed);
    ASSERT_EQ(kept.size(), 6U);
    for (std::size_t k = 0; k < 6; ++k) {
      double all = 0, few = 0, size = 0;
      for (const Point& p : points)
        all += p.weight * quadratics(p)[k], size += p.weight * std::abs(quadratics(p)[k]);
      for (const auto& [point, weight] : kept) {
        EXPECT_GT(weight, 0);
        few += weight * quadratics(points[point])[k];
      }
      EXPECT_LT(std::abs(few - all), 1e-9 * size) << "moment " << k << ", seed " << seed;
    }
  }
}

TEST(MomentWalk, HasNoBiasForOtherFunctions) {
  // A step, which no polynomial follows. The mean over many walks is the sum over all points.
  const std::vector<Point> points = cloud(60);
  const auto step = [](const Point& p) { return p.x > 0.3 || p.y > 0.9 ? 1.0 : 0.0; };
  double all = 0;
  for (const Point& p : points) all += p.weight * step(p);
  constexpr int kWalks = 20000;
  double sum = 0, squares = 0;
  for (int seed = 0; seed < kWalks; ++seed) {
    double few = 0;
    for (const auto& [point, weight] : reduced(points, mix64(static_cast<std::uint64_t>(seed))))
      few += weight * step(points[point]);
    sum += few, squares += few * few;
  }
  const double mean = sum / kWalks;
  const double error = std::sqrt((squares / kWalks - mean * mean) / kWalks);
  EXPECT_GT(error, 0);
  EXPECT_LT(std::abs(mean - all), 5 * error);
}

TEST(MomentWalk, TakesPointsThatLieOnALine) {
  std::vector<Point> points = cloud(50);
  for (Point& p : points) p.y = 2 * p.x + 1;  // three functions are independent
  const auto kept = reduced(points, 1);
  EXPECT_EQ(kept.size(), 3U);
  double all = 0, few = 0;
  for (const Point& p : points) all += p.weight * p.x * p.y;
  for (const auto& [point, weight] : kept) few += weight * points[point].x * points[point].y;
  EXPECT_TRUE(relative(few, all, 1e-8));
}

Scene small(const MainLensSpec& lens, Lattice lattice, LensModel array) {
  return small_scene(lens, large_array(lattice, array));
}

Scene two_bands(Scene scene) {
  scene.channels = {{"red", ChannelKind::band, 700e-9, 10e-9},
                    {"blue", ChannelKind::band, 450e-9, 10e-9}};
  return scene;
}

Scene glasses() {
  Scene scene = two_bands(small(singlet(), Lattice::square, LensModel::real));
  scene.camera.lens.surfaces[0].glass = "N-SF11";
  scene.camera.array.types[0].glass = "N-BK7";
  return scene;
}

Scene half_covered() {
  Scene scene = two_bands(small(singlet(), Lattice::hexagonal, LensModel::real));
  PupilFilterSpec filter;
  filter.name = "blue half";
  filter.extent = std::acos(-1.0);
  filter.transmission = "400 nm 0.8, 500 nm 0.8, 510 nm 0.1, 800 nm 0.1";
  scene.camera.pupil_filters = {filter};
  return scene;
}

struct Case {
  std::string name;
  Scene scene;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

std::vector<Case> cases() {
  return {
      {"square", small(singlet(), Lattice::square, LensModel::real)},
      {"three types", small(singlet(), Lattice::hexagonal, LensModel::real)},
      {"ideal, two bands", two_bands(small(ideal_singlet(), Lattice::hexagonal, LensModel::ideal))},
      {"bare, real lens", small_scene(singlet(), {})},
      {"two paths", glasses()},
      {"half covered", half_covered()}};
}

CompileSettings rough() {
  CompileSettings settings;
  settings.level = 3;
  settings.samples = 256;
  return settings;
}

/// Another flame within 3 mm around the small one: hotter, moved, turned over.
Scene other_flame(Scene scene) {
  FlameSpec& flame = scene.flames.front();
  flame.position = {1.001, -0.001, -0.011};
  flame.layers[1].temperature = 1850;
  flame.layers[1].centre = {-0.001, 0.001, 0.01};
  flame.layers[2].absorption = 30;
  return scene;
}

/// Pictures and errors of all channels.
std::vector<Image> pictures(const LightField& field) {
  std::vector<Image> images;
  for (const LightFieldChannel& channel : field.channels) {
    images.push_back(channel.flux);
    images.push_back(channel.standard_error);
  }
  return images;
}

double sum_of(const Image& image) {
  double sum = 0;
  for (const float value : image.pixels) sum += static_cast<double>(value);
  return sum;
}

class EveryCamera : public testing::TestWithParam<Case> {};

TEST_P(EveryCamera, SeesAnotherFlameAsTheRendererDoes) {
  CompileSettings settings = rough();
  settings.margin = 3e-3;
  const CompiledCamera camera = compile_camera(compile(GetParam().scene), settings, threads(2));
  const CompiledScene scene = compile(other_flame(GetParam().scene));
  const LightField few = render_compiled(scene, camera, {}, threads(2)).light_field;
  RenderSettings plain;
  plain.samples = 4096;
  plain.seed = 99;
  const LightField many = render(scene, plain, threads(2)).light_field;
  ASSERT_EQ(few.channels.size(), many.channels.size());
  for (std::size_t c = 0; c < few.channels.size(); ++c) {
    const auto &a = few.channels[c], &b = many.channels[c];
    EXPECT_EQ(a.name, b.name);
    double squares = 0, stated = 0, total_variance = 0;
    for (std::size_t i = 0; i < a.flux.pixels.size(); ++i) {
      const double difference =
          static_cast<double>(a.flux.pixels[i]) - static_cast<double>(b.flux.pixels[i]);
      const double ea = static_cast<double>(a.standard_error.pixels[i]),
                   eb = static_cast<double>(b.standard_error.pixels[i]);
      squares += difference * difference;
      stated += ea * ea + eb * eb;
      total_variance += ea * ea + eb * eb;
    }
    // Over some thousand pixels, few of which make most of the error: the ratio scatters by 7 %.
    EXPECT_GT(stated, 0);
    EXPECT_GT(std::sqrt(squares / stated), 0.75) << "channel " << c;
    EXPECT_LT(std::sqrt(squares / stated), 1.3) << "channel " << c;
    EXPECT_LT(std::abs(sum_of(a.flux) - sum_of(b.flux)), 5 * std::sqrt(total_variance))
        << "channel " << c;
    EXPECT_GT(sum_of(b.flux), 20 * std::sqrt(total_variance)) << "the test sees nothing";
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, EveryCamera, testing::ValuesIn(cases()));

/// One of many flames within 2 mm around the small one, by a generator of their own.
Scene random_flame(Scene scene, std::mt19937_64& random) {
  const auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  FlameSpec& flame = scene.flames.front();
  flame.position =
      flame.position + Vec3{between(-2e-3, 2e-3), between(-2e-3, 2e-3), between(-2e-3, 2e-3)};
  for (EllipsoidSpec& layer : flame.layers) {
    layer.temperature = between(1300, 1900);
    layer.absorption = between(5, 60);
  }
  return scene;
}

TEST(CompiledCamera, ErrorsAreTrueAndWithoutBiasOverManyFlames) {
  const Scene spec = small(singlet(), Lattice::square, LensModel::real);
  CompileSettings settings = rough();
  settings.level = 6;
  settings.samples = 2048;
  settings.margin = 2.5e-3;
  const CompiledCamera camera = compile_camera(compile(spec), settings, threads(2));
  std::mt19937_64 random(30);
  const int flames = in_full() ? 20 : 3;
  double bias = 0, bias_variance = 0;
  for (int i = 0; i < flames; ++i) {
    const CompiledScene scene = compile(random_flame(spec, random));
    RenderSettings plain;
    plain.samples = 8192;
    plain.seed = 100 + static_cast<std::uint64_t>(i);
    const LightField few = render_compiled(scene, camera, {}, threads(2)).light_field;
    const LightField many = render(scene, plain, threads(2)).light_field;
    double squares = 0, stated = 0, own_variance = 0;
    for (std::size_t k = 0; k < few.channels[0].flux.pixels.size(); ++k) {
      const auto of = [&](const Image& image) { return static_cast<double>(image.pixels[k]); };
      const auto &a = few.channels[0], &b = many.channels[0];
      const double difference = of(a.flux) - of(b.flux);
      const double ea = of(a.standard_error), eb = of(b.standard_error);
      squares += difference * difference;
      stated += ea * ea + eb * eb;
      own_variance += ea * ea;
    }
    EXPECT_GT(own_variance, 0.5 * stated) << "the reference decides the ratio";
    EXPECT_GT(std::sqrt(stated / squares), 0.8) << "flame " << i;
    EXPECT_LT(std::sqrt(stated / squares), 1.25) << "flame " << i;
    const double flux = sum_of(many.channels[0].flux);
    bias += (sum_of(few.channels[0].flux) - flux) / (flux * flames);
    bias_variance += stated / (flux * flux * flames);
  }
  // All flames are seen by the same rays: their mean is not surer than one of them.
  EXPECT_LT(std::sqrt(bias_variance), 2e-4) << "the test sees no bias";
  EXPECT_LT(std::abs(bias), 5e-4);
}

CompiledScene square_scene() {
  return compile(small(singlet(), Lattice::square, LensModel::real));
}

template <class T>
std::string bytes_of(const std::vector<T>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

/// All that a camera keeps, tile by tile.
std::string content_of(const CompiledCamera& camera) {
  std::string bytes = bytes_of(camera.tiles);
  for (std::size_t t = 0; t < camera.tiles.size(); ++t) {
    const CompiledContent content = camera.content(t);
    bytes += bytes_of(content.groups) + bytes_of(content.nodes);
  }
  return bytes;
}

TEST(CompiledCamera, IsTheSameForAnyNumberOfThreads) {
  Scene spec = paper_flame(200, 150);
  const CompiledScene scene = compile(spec);
  const CompiledCamera one = compile_camera(scene, rough(), threads(1));
  const CompiledCamera three = compile_camera(scene, rough(), threads(3));
  EXPECT_GT(one.nodes, 1000U);
  EXPECT_EQ(content_of(one), content_of(three));
  const LightField a = render_compiled(scene, one, {}, threads(1)).light_field;
  const LightField b = render_compiled(scene, three, {}, threads(3)).light_field;
  EXPECT_EQ(a.channels[0].flux, b.channels[0].flux);
  EXPECT_EQ(a.channels[0].standard_error, b.channels[0].standard_error);
}

TEST(CompiledCamera, GivesAPixelTheSameInAnyWindow) {
  const CompiledScene scene = compile(paper_flame(200, 150));
  const CompiledCamera whole = compile_camera(scene, rough(), threads(2));
  CompileSettings part = rough();
  part.window = {37, 21, 90, 80};
  const CompiledCamera window = compile_camera(scene, part, threads(2));
  RenderSettings settings;
  settings.window = {50, 30, 70, 65};
  const LightField of_whole = render_compiled(scene, whole, settings, threads(2)).light_field;
  const LightField of_part = render_compiled(scene, window, settings, threads(2)).light_field;
  EXPECT_EQ(of_whole.window, settings.window);
  EXPECT_GT(sum_of(of_whole.channels[0].flux), 0);
  EXPECT_EQ(of_whole.channels[0].flux, of_part.channels[0].flux);
  settings.window = {0, 0, 100, 100};
  EXPECT_THROW(render_compiled(scene, window, settings), UsageError);
}

TEST(CompiledCamera, RendersByTheSettingsOfRender) {
  const CompiledScene scene = square_scene();
  RenderSettings settings;
  settings.compiled = std::make_shared<const CompiledCamera>(compile_camera(scene, rough()));
  const RenderResult result = render(scene, settings);
  EXPECT_EQ(result.light_field.channels[0].flux,
            render_compiled(scene, *settings.compiled, {}).light_field.channels[0].flux);
  EXPECT_EQ(result.statistics.rays, static_cast<double>(settings.compiled->nodes));
}

/// The message with which a scene is refused; empty: it is not.
std::string refusal(const Scene& scene, const CompiledCamera& camera) {
  try {
    render_compiled(compile(scene), camera, {}, {}, "a.bundle");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(CompiledCamera, BelongsToItsCameraAndRegion) {
  const Scene spec = small(singlet(), Lattice::square, LensModel::real);
  CompiledCamera camera = compile_camera(compile(spec), rough());
  EXPECT_EQ(refusal(spec, camera), "");
  Scene other = spec;
  other.camera.sensor.full_well = 1000;  // nothing that a ray sees
  other.camera.name = "left";
  other = two_bands(other);
  EXPECT_EQ(refusal(other, camera), "");
  other = spec;
  other.camera.array.pitch = 0.99e-3;
  other.camera.array.diameter = 0.99e-3;
  EXPECT_NE(refusal(other, camera).find("a.bundle: belongs to another camera (camera.array."),
            std::string::npos)
      << refusal(other, camera);
  other = spec;
  other.camera.position.x = -0.01;
  EXPECT_NE(refusal(other, camera).find("camera.position"), std::string::npos);
  other = spec;
  other.flames[0].position.z += 0.002;
  EXPECT_NE(refusal(other, camera).find("reaches 2 mm beyond the region"), std::string::npos)
      << refusal(other, camera);
  other = spec;
  other.lights.emplace_back();
  EXPECT_NE(refusal(other, camera).find("lights"), std::string::npos) << refusal(other, camera);
  camera.version = "0.0.1";
  EXPECT_NE(refusal(spec, camera).find("compiled by version 0.0.1"), std::string::npos);
}

TEST(CompiledCamera, NeedsToKnowWhereFlamesAre) {
  Scene spec = small(singlet(), Lattice::square, LensModel::real);
  spec.flames.clear();
  EXPECT_THROW(compile_camera(compile(spec), rough()), InputError);
  CompileSettings settings = rough();
  settings.region = {{0.99, -0.01, -0.015}, {1.01, 0.01, 0.015}};
  const CompiledCamera camera = compile_camera(compile(spec), settings);
  EXPECT_EQ(refusal(small(singlet(), Lattice::square, LensModel::real), camera), "");
}

TEST(Bundle, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const CompiledScene scene = compile(half_covered());
  const CompiledCamera camera = compile_camera(scene, rough());
  write_bundle(folder.file("a.bundle"), camera);
  const CompiledCamera read = read_bundle(folder.file("a.bundle"));
  EXPECT_EQ(read.key, camera.key);
  EXPECT_EQ(read.window, camera.window);
  EXPECT_EQ(read.region, camera.region);
  EXPECT_EQ(read.anchor, camera.anchor);
  EXPECT_EQ(content_of(read), content_of(camera));
  EXPECT_EQ(pictures(render_compiled(scene, read, {}).light_field),
            pictures(render_compiled(scene, camera, {}).light_field));
  EXPECT_EQ(folder.names().size(), 1U);
}

std::string reading_error(const std::string& path) {
  try {
    read_bundle(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Bundle, IsRefusedInOneLineWhenCutOffOrNoBundle) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.bundle");
  write_bundle(path, compile_camera(square_scene(), rough()));
  const std::string bytes = read_bytes(path);
  for (const std::size_t size :
       {std::size_t{30}, std::size_t{64}, std::size_t{500}, bytes.size() / 2, bytes.size() - 1}) {
    write_bytes(path, bytes.substr(0, size));
    EXPECT_NE(reading_error(path).find("is cut off; compile"), std::string::npos) << size;
  }
  write_bytes(path, "[camera]\n");
  EXPECT_NE(reading_error(path).find("is not a compiled camera"), std::string::npos);
  write_bytes(path, "");
  EXPECT_NE(reading_error(path).find("is not a compiled camera"), std::string::npos);
  std::string later = bytes;
  later[18 + 1] = '9';
  write_bytes(path, later.replace(0, 20, "plenoflame bundle 2\n"));
  EXPECT_NE(reading_error(path).find("another version"), std::string::npos);
  EXPECT_NE(reading_error(folder.path()).find("not a file"), std::string::npos);
}

/// Message of reading all tiles; empty: all were read.
std::string reading_tiles_error(const CompiledCamera& camera) {
  try {
    for (std::size_t t = 0; t < camera.tiles.size(); ++t) camera.content(t);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Into the same file, as cp does it: what is open shows the new bytes.
void overwrite(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  ASSERT_TRUE(file.flush());
}

TEST(Bundle, ThatChangesWhileItIsOpenIsAnErrorOfOneLine) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.bundle");
  const CompiledScene scene = square_scene();
  CompileSettings other = rough();
  other.seed = 2;
  write_bundle(path, compile_camera(scene, other));
  const std::string second = read_bytes(path);
  write_bundle(path, compile_camera(scene, rough()));
  const std::string first = read_bytes(path);
  for (const std::size_t size : {first.size() - 1, first.size() / 2, std::size_t{0}}) {
    write_bytes(path, first);
    const CompiledCamera camera = read_bundle(path);
    EXPECT_EQ(reading_tiles_error(camera), "");
    overwrite(path, first.substr(0, size));
    EXPECT_NE(reading_tiles_error(camera).find("a.bundle: was cut off while it was read"),
              std::string::npos)
        << size;
    EXPECT_THROW(render_compiled(scene, camera, {}), FileError);
  }
  write_bytes(path, first);
  const CompiledCamera camera = read_bundle(path);
  overwrite(path, second + std::string(first.size(), '\0'));
  EXPECT_NE(reading_tiles_error(camera).find("a.bundle: is damaged; compile"), std::string::npos);
  EXPECT_THROW(render_compiled(scene, camera, {}), FileError);
  // A file of that name that takes its place does not touch the one that is open.
  write_bytes(path, first);
  const CompiledCamera kept = read_bundle(path);
  write_bundle(path, compile_camera(scene, other));
  EXPECT_EQ(reading_tiles_error(kept), "");
}

TEST(CompiledCamera, SeesNothingOfARegionBehindIt) {
  const CompiledScene scene = square_scene();
  CompileSettings settings = rough();
  for (const double x : {-1.0, 0.0}) {
    settings.region = {{x - 0.01, -0.01, -0.015}, {x + 0.01, 0.01, 0.015}};
    EXPECT_THROW(compile_camera(scene, settings), InputError) << x;
  }
  settings.region = {{0.99, 4.99, -0.015}, {1.01, 5.01, 0.015}};  // beside what it looks at
  EXPECT_THROW(compile_camera(scene, settings), InputError);
}

TEST(Bundle, DamageIsFound) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.bundle");
  const CompiledScene scene = square_scene();
  CompileSettings settings = rough();
  settings.level = 1;
  write_bundle(path, compile_camera(scene, settings));
  const std::string sound = read_bytes(path);
  const auto expected = pictures(render_compiled(scene, read_bundle(path), {}).light_field);
  std::mt19937_64 random(3);
  read_damaged(
      "bundles", damaged_files_wanted(300), {sound},
      [&](const std::string& bytes) {
        return below(20, random) == 0 ? bytes : damage_bytes(bytes, 9000, random);
      },
      [&](const std::string& bytes) {
        write_bytes(path, bytes);
        EXPECT_EQ(pictures(render_compiled(scene, read_bundle(path), {}).light_field), expected);
      });
}

}  // namespace
}  // namespace plenoflame::test::compiled_camera_test
