// The layered flame on a grid against chords through the ellipsoids themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "plenoflame/base/error.h"
#include "plenoflame/volumes/flame_library.h"
#include "support/approx.h"
#include "volumes/support.h"

namespace plenoflame::layered_flame_test {
namespace {

using test::contains;
using test::message_of;
using test::relative;

/// Pieces of a line through ellipsoids, first listed wins: (length, layer), from the quadratic.
struct Piece {
  double length;
  const EllipsoidSpec* layer;
};

std::vector<Piece> pieces(const std::vector<EllipsoidSpec>& layers, const Ray& ray) {
  std::vector<std::array<double, 2>> inside;
  std::vector<double> edges;
  for (const EllipsoidSpec& e : layers) {
    const auto scaled = [&](Vec3 v) {
      return Vec3{v.x / e.semi_axes.x, v.y / e.semi_axes.y, v.z / e.semi_axes.z};
    };
    const Vec3 o = scaled(ray.origin - e.centre), d = scaled(ray.direction);
    const double a = dot(d, d), b = dot(o, d), c = dot(o, o) - 1, discriminant = b * b - a * c;
    if (discriminant <= 0) {
      inside.push_back({1, -1});
      continue;
    }
    inside.push_back({(-b - std::sqrt(discriminant)) / a, (-b + std::sqrt(discriminant)) / a});
    edges.insert(edges.end(), inside.back().begin(), inside.back().end());
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Piece> result;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double middle = 0.5 * (edges[i] + edges[i + 1]);
    for (std::size_t l = 0; l < layers.size(); ++l)
      if (middle > inside[l][0] && middle < inside[l][1]) {
        result.push_back({edges[i + 1] - edges[i], &layers[l]});
        break;
      }
  }
  return result;
}

/// The emission of a layer per absorption: T^4, or Wien's law at 650 nm, c2 = 0.014387768775 m K.
using Emission = double (*)(double);
double total(double t) {
  return t * t * t * t;
}
double wien_650(double t) {
  return std::exp(-0.014387768775 / 650e-9 / t);
}

struct Chord {
  double thickness = 0;  // integral of kappa
  double emission = 0;   // integral of kappa S(T)
};

Chord exact(const std::vector<EllipsoidSpec>& layers, const Ray& ray, Emission source) {
  Chord chord;
  for (const Piece& piece : pieces(layers, ray)) {
    chord.thickness += piece.length * piece.layer->absorption;
    chord.emission += piece.length * piece.layer->absorption * source(piece.layer->temperature);
  }
  return chord;
}

/// Trilinear interpolation of both grids, midpoint rule with eight steps per voxel.
Chord on_grid(const FlameFields& flame, double voxel, const Ray& ray, Emission source) {
  const test::FieldSampler temperature(flame.temperature), absorption(flame.absorption);
  const double step = voxel / 8, reach = 0.06;
  Chord chord;
  for (double t = -reach + step / 2; t < reach; t += step) {
    const Vec3 p = (1 / voxel) * ray.at(t);
    const double kappa = absorption.interpolate(p);
    if (kappa == 0) continue;
    chord.thickness += step * kappa;
    chord.emission += step * kappa * source(temperature.interpolate(p));
  }
  return chord;
}

/// Chords in random directions that either meet each layer well inside or miss it well: at a
/// grazing chord its length has a square-root singularity, which no grid resolves.
std::vector<Ray> random_chords(const std::vector<EllipsoidSpec>& layers, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Ray> rays;
  while (static_cast<int>(rays.size()) < count) {
    const Vec3 d{unit(random), unit(random), 0.5 * unit(random)};
    if (length(d) < 0.3) continue;
    const Ray ray{{9e-3 * unit(random), 9e-3 * unit(random), 30e-3 + 25e-3 * unit(random)},
                  normalize(d)};
    bool grazing = false;
    for (const EllipsoidSpec& e : layers) {
      const auto scaled = [&](Vec3 v) {
        return Vec3{v.x / e.semi_axes.x, v.y / e.semi_axes.y, v.z / e.semi_axes.z};
      };
      const double miss =
          length(cross(scaled(ray.origin - e.centre), normalize(scaled(ray.direction))));
      grazing = grazing || std::fabs(miss - 1) < 0.35;
    }
    if (!grazing) rays.push_back(ray);
  }
  return rays;
}

struct Errors {
  double thickness, emission, bias;  // RMS and mean of emission, relative to the exact values'
};

Errors errors(const FlameFields& flame, double voxel, Emission source) {
  double thickness = 0, emission = 0, thickness_size = 0, emission_size = 0, bias = 0, sum = 0;
  for (const Ray& ray : random_chords(default_layers(), 200, 11)) {
    const Chord truth = exact(default_layers(), ray, source),
                grid = on_grid(flame, voxel, ray, source);
    thickness += std::pow(grid.thickness - truth.thickness, 2);
    emission += std::pow(grid.emission - truth.emission, 2);
    thickness_size += truth.thickness * truth.thickness;
    emission_size += truth.emission * truth.emission;
    bias += grid.emission - truth.emission;
    sum += truth.emission;
  }
  return {std::sqrt(thickness / thickness_size), std::sqrt(emission / emission_size), bias / sum};
}

FlameFields layered(double voxel) {
  LayeredFlameOptions options;
  options.voxel_size = voxel;
  return make_layered_flame(options, {});
}

/// A simpler generator's flame: every voxel has the values of its centre.
FlameFields point_sampled(double voxel) {
  FlameFields flame = layered(voxel);
  const auto layers = default_layers();
  for (VoxelField* field : {&flame.absorption, &flame.temperature})
    for (std::size_t i = 0; i < field->values.size(); ++i) {
      const auto& o = field->brick_origins[i / 512];
      const auto v = static_cast<int>(i % 512);
      const Vec3 p = voxel * Vec3{o[0] + v / 64 + 0.0, o[1] + v / 8 % 8 + 0.0, o[2] + v % 8 + 0.0};
      const bool hot = field == &flame.temperature;
      field->values[i] = hot ? 1900.0f : 0.0f;
      for (const EllipsoidSpec& e : layers) {
        const Vec3 d = p - e.centre;
        if (length({d.x / e.semi_axes.x, d.y / e.semi_axes.y, d.z / e.semi_axes.z}) >= 1) continue;
        field->values[i] = static_cast<float>(hot ? e.temperature : e.absorption);
        break;
      }
    }
  return flame;
}

TEST(LayeredFlame, ChordIntegralsConverge) {
  const double coarse_voxel = 1e-3, fine_voxel = 0.4e-3;
  const double ratio = std::log(coarse_voxel / fine_voxel);
  const FlameFields coarse = layered(coarse_voxel), fine = layered(fine_voxel);
  for (const Emission source : {total, wien_650}) {
    const Errors rough = errors(coarse, coarse_voxel, source),
                 good = errors(fine, fine_voxel, source);
    const Errors points = errors(point_sampled(fine_voxel), fine_voxel, source);
    // Between first order (aliasing of the borders) and second (smoothing).
    EXPECT_GT(std::log(rough.thickness / good.thickness) / ratio, 1.3);
    EXPECT_GT(std::log(rough.emission / good.emission) / ratio, 0.8);
    EXPECT_LT(good.thickness, 0.002);
    EXPECT_LT(good.emission, source == total ? 0.0025 : 0.0065);
    EXPECT_LT(std::fabs(good.bias), 0.0015);
    // Five times better than values of the voxels' centres, or the effort would be idle.
    EXPECT_LT(5 * good.thickness, points.thickness);
    EXPECT_LT(2 * good.emission, points.emission);
  }
}

TEST(LayeredFlame, AbsorptionAddsUpToTheVolumes) {
  // Misaligned overlapping ellipsoids whose parts have closed volumes: one inside of another, one
  // apart. The lattice holds weighted means that add up to the whole: what is left is the error of
  // 64 lines per sample, on semi-axes of 3.4 to 14 voxels.
  LayeredFlameOptions options;
  options.voxel_size = 0.5e-3;
  options.layers = {{"inner", {1e-3, -0.5e-3, 7e-3}, {3e-3, 2e-3, 4e-3}, 1500, 20},
                    {"outer", {0.3e-3, 0, 7.1e-3}, {6e-3, 5.3e-3, 7e-3}, 1800, 3},
                    {"apart", {15.1e-3, 0.2e-3, 2e-3}, {2.2e-3, 3e-3, 1.7e-3}, 1300, 50}};
  const FlameFields flame = make_layered_flame(options, {});
  double sum = 0;
  for (const float value : flame.absorption.values) sum += static_cast<double>(value);
  const auto volume = [](const EllipsoidSpec& e) {
    return 4.0 / 3.0 * std::acos(-1.0) * e.semi_axes.x * e.semi_axes.y * e.semi_axes.z;
  };
  const auto& l = options.layers;
  const double expected = volume(l[0]) * 20 + (volume(l[1]) - volume(l[0])) * 3 + volume(l[2]) * 50;
  EXPECT_TRUE(relative(sum * std::pow(options.voxel_size, 3), expected, 4e-4));
}

TEST(LayeredFlame, HomogeneousInsideAndTemperatureBeyondTheBorder) {
  const FlameFields flame = layered(0.5e-3);
  const test::FieldSampler temperature(flame.temperature), absorption(flame.absorption);
  EXPECT_EQ(absorption.at(0, 0, 28), 1.0f);  // z = 14 mm, the centre of the core
  EXPECT_TRUE(relative(static_cast<double>(temperature.at(0, 0, 28)), 1200, 1e-7));
  EXPECT_EQ(absorption.at(11, 0, 44), 30.0f);  // x = 5.5 mm: luminous
  EXPECT_TRUE(relative(static_cast<double>(temperature.at(11, 0, 44)), 1650, 1e-7));
  EXPECT_EQ(absorption.at(0, 17, 58), 1.5f);  // y = 8.5 mm: outer
  EXPECT_EQ(absorption.at(0, 24, 58), 0.0f);
  EXPECT_EQ(flame.absorption.background, 0.0f);
  // All neighbours of a voxel that absorbs have a flame's temperature, two voxels far.
  std::size_t checked = 0;
  for (std::size_t i = 0; i < flame.absorption.values.size(); ++i) {
    if (flame.absorption.values[i] == 0) continue;
    const auto& o = flame.absorption.brick_origins[i / 512];
    const auto v = static_cast<int>(i % 512);
    for (int corner = 0; corner < 8; ++corner) {
      const auto side = [&](int bit) { return (corner >> bit & 1) != 0 ? 2 : -2; };
      const float t = temperature.at(o[0] + v / 64 + side(0), o[1] + v / 8 % 8 + side(1),
                                     o[2] + v % 8 + side(2));
      ASSERT_GE(t, 1199.99f);
      ASSERT_LE(t, 1900.01f);
      ++checked;
    }
  }
  EXPECT_GT(checked, 100000u);
}

TEST(LayeredFlame, MixedVoxelsEmitTheMeanEmission) {
  // A plane border (a huge ellipsoid's flat side) half way between samples 0 and 1 in x.
  LayeredFlameOptions options;
  options.voxel_size = 1e-3;
  options.layers = {{"a", {-1e3 + 0.5e-3, 0, 0}, {1e3, 2e-3, 2e-3}, 1200, 10},
                    {"b", {0, 0, 0}, {5e-3, 1e3, 1e3}, 2000, 1}};
  // Far too large to be sampled whole: that is refused, with advice.
  EXPECT_TRUE(contains(message_of<InputError>([&] { make_layered_flame(options, {}); }),
                       "choose a larger one"));
  options.layers[0] = {"a", {-50e-3 + 0.5e-3, 0, 0}, {50e-3, 50e-3, 50e-3}, 1200, 10};
  options.layers[1] = {"b", {0, 0, 0}, {60e-3, 60e-3, 60e-3}, 2000, 1};
  const FlameFields flame = make_layered_flame(options, {});
  const test::FieldSampler temperature(flame.temperature), absorption(flame.absorption);
  // The tent of sample 0 has 7/8 of its weight below x = 0.5 mm, that of sample 1 has 1/8. The
  // sphere curves away by 0.01 mm at the edge of the voxel.
  for (const auto& [index, share] : {std::pair{0, 7.0 / 8}, std::pair{1, 1.0 / 8}}) {
    const double kappa = share * 10 + (1 - share) * 1;
    const double emitted = (share * 10 * total(1200) + (1 - share) * 1 * total(2000)) / kappa;
    EXPECT_TRUE(relative(static_cast<double>(absorption.at(index, 0, 0)), kappa, 0.01));
    EXPECT_TRUE(relative(total(static_cast<double>(temperature.at(index, 0, 0))), emitted, 0.01));
  }
}

TEST(LayeredFlame, SameForAnyNumberOfThreads) {
  Execution one, three;
  one.threads = 1;
  three.threads = 3;
  LayeredFlameOptions options;
  options.voxel_size = 1e-3;
  const FlameFields a = make_layered_flame(options, one), b = make_layered_flame(options, three);
  EXPECT_EQ(a.absorption.brick_origins, b.absorption.brick_origins);
  EXPECT_EQ(a.absorption.values, b.absorption.values);
  EXPECT_EQ(a.temperature.values, b.temperature.values);
}

TEST(LayeredFlame, RefusesImpossibleLayers) {
  const auto refused = [](const EllipsoidSpec& layer) {
    LayeredFlameOptions options;
    options.layers = {layer};
    return message_of<InputError>([&] { make_layered_flame(options, {}); });
  };
  const EllipsoidSpec good{"soot", {}, {1e-3, 1e-3, 1e-3}, 1500, 1};
  EllipsoidSpec bad = good;
  bad.semi_axes.y = 0;
  EXPECT_TRUE(contains(refused(bad), "layer \"soot\": every semi-axis must be a positive length"));
  bad = good;
  bad.temperature = -1;
  EXPECT_TRUE(contains(refused(bad), "the temperature must be above 0 K"));
  bad = good;
  bad.absorption = std::nan("");
  bad.name = "";
  EXPECT_TRUE(contains(refused(bad), "layer 1: the absorption must be at least 0"));
  bad = good;
  bad.centre.x = INFINITY;
  EXPECT_TRUE(contains(refused(bad), "the centre must be finite"));
  LayeredFlameOptions options;
  for (const double voxel : {0.0, -1e-3, std::nan(""), 1e-9}) {
    options.voxel_size = voxel;
    EXPECT_TRUE(
        contains(message_of<InputError>([&] { make_layered_flame(options, {}); }), "voxel size"));
  }
}

TEST(LayerFile, ReadsLayersWithUnits) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("layers.toml");
  const auto read = [&](const std::string& text) {
    test::spill(path, {text.begin(), text.end()});
    return read_layers(path);
  };
  const std::string start = "[[layers]]\nname = \"core\"\n";
  const std::string centre = "centre = [\"0 mm\", \"0.1 cm\", \"14 mm\"]\n";
  const std::string rest =
      "semi_axes = [\"4 mm\", \"5 mm\", \"12 mm\"]\ntemperature = \"1200 K\"\nabsorption = \"0.3 "
      "1/cm\"\n";
  const auto layers = read(start + centre + rest + start + centre + rest);
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[1], (EllipsoidSpec{"core", {0, 1e-3, 14e-3}, {4e-3, 5e-3, 12e-3}, 1200, 30}));

  const auto refused = [&](const std::string& text) {
    const std::string message = message_of<InputError>([&] { read(text); });
    EXPECT_EQ(message.rfind(path, 0), 0u) << message;
    return message;
  };
  EXPECT_TRUE(contains(refused(start + centre), ":1:1: layers[0].semi_axes is missing"));
  EXPECT_TRUE(contains(refused(start + "centr = 3\n" + rest),
                       ":3:1: unknown key \"centr\" in layers[0]; did you mean \"centre\"?"));
  EXPECT_TRUE(contains(refused(start + "centre = [1, 2, 3]\n" + rest),
                       ":3:11: layers[0].centre: a unit is missing"));
  EXPECT_TRUE(contains(refused(start + "centre = [\"1 m\"]\n" + rest),
                       ":3:10: layers[0].centre: this has 1 components, but 3 are expected"));
  EXPECT_TRUE(contains(refused(start + rest + "[[layers]]\nabsorption = \"-1 1/m\"\n"),
                       ":7:14: layers[1].absorption: -1 1/m is not possible here; 0 1/m to "));
  EXPECT_TRUE(contains(refused("layer = 3\n"), ":1:1: unknown key \"layer\""));
  EXPECT_TRUE(contains(refused(""), "there are no [[layers]] tables"));
  EXPECT_TRUE(contains(refused("layers = [3]\n"), ":1:11: layers[0] is a whole number"));
  EXPECT_TRUE(contains(refused("[[layers\n"), path + ":1:"));
  EXPECT_TRUE(contains(message_of<FileError>([&] { read_layers(folder.file("none.toml")); }),
                       "No such file"));
}

}  // namespace
}  // namespace plenoflame::layered_flame_test
