// Temperature and absorption from two channels over families of flames: stated deviations against
// errors. Pictures are rendered of voxels that are four times finer than what is solved for.
#include <gtest/gtest.h>

#include "plenoflame/inverse/thermal_reconstruction.h"
#include "statistical/flame_families.h"

namespace plenoflame::test::soot_families_test {
namespace {

constexpr double kThickest = 40;  // [1/m], of a flame 9 mm wide
constexpr double kWavelengths[] = {650e-9, 850e-9};
constexpr double kRatio = 650.0 / 850;  // of absorptions, as soot has it

SourceFunction source_of(double wavelength) {
  return SourceFunction::band(wavelength, 10e-9);
}

struct Soot {
  Flame absorption;   ///< [1/m]
  Flame temperature;  ///< [K]
};

/// Soot is where the light of the families is. In rings, half of the light's decades are its
/// amount, the other half its source function. In voxels, its temperature is other blobs'.
Soot soot_of(const FamilyTrial& trial) {
  const Flame light = draw_flame(trial.family, trial.rings, trial.seed);
  if (!trial.rings) {
    const Flame other = draw_flame(Family::blobs, false, 100 + trial.seed);
    return {[=](Vec3 p) { return kThickest * light(p); },
            [=](Vec3 p) { return 1450 + 350 * std::min(1.2, other(p)); }};
  }
  const SourceFunction source = source_of(kWavelengths[0]);
  return {[=](Vec3 p) { return kThickest * std::sqrt(light(p)); },
          [=](Vec3 p) {
            return temperature_of(source, source(kHottest) * std::max(std::sqrt(light(p)), 1e-3));
          }};
}

/// A camera that resolves much: near, with thin lenses and small pixels.
void look_closely(CameraSpec& camera) {
  constexpr double kDistance = 0.3;
  camera.position = Vec3{1, 0, 0} - kDistance * camera.look_direction;
  camera.focus.object_distance = kDistance;
  camera.lens = {};
  camera.lens.model = LensModel::ideal;
  camera.lens.focal_length = 0.1;
  camera.lens.diameter = 0.025;
  camera.array.lattice = Lattice::square;
  camera.array.model = LensModel::ideal;
  camera.array.pitch = camera.array.diameter = 0.5e-3;
  camera.array.sensor_distance = 3e-3;
  camera.array.types = {{.name = "all", .focal_length = 3e-3}};
  camera.sensor = {40, 72, 0.125e-3};
}

CompiledScene scene_of(const Soot& soot, const FamilyTrial& trial, const FamilyGrid& places,
                       int camera) {
  const double across = places.across / places.finer, up = places.up / places.finer;
  const GlowingGrid hot = fine_grid(trial, soot.temperature, across, up);
  const GlowingGrid thick = fine_grid(trial, soot.absorption, across, up);
  const auto field = [](const GlowingGrid& grid) {
    return make_field(
        {0, 0, 0}, grid.count,
        [&](int i, int j, int k) {
          return static_cast<float>(
              grid.emission[static_cast<std::size_t>((i * grid.count[1] + j) * grid.count[2] + k)]);
        },
        grid.map);
  };
  Scene scene = family_scene(camera, trial.cameras);
  if (trial.coarser > 1) look_closely(scene.camera);
  FlameSpec flame;
  flame.kind = FlameKind::vdb;
  flame.file = "soot.vdb";
  scene.flames = {flame};
  scene.channels.clear();
  for (const double wavelength : kWavelengths)
    scene.channels.push_back({std::to_string(std::lround(1e9 * wavelength)) + "nm",
                              ChannelKind::band, wavelength, 10e-9});
  return compile(scene, [&](const FlameSpec&, const std::string&,
                            const std::vector<SourceFunction>& channels, const Execution&) {
    VoxelField temperature = field(hot);
    temperature.background = static_cast<float>(kAmbient);
    return make_voxel_medium(temperature, field(thick), VoxelInterpolation::trilinear, channels,
                             {.absorption_factors = {1, kRatio}});
  });
}

struct Outcome {
  Errors temperature, absorption, emission;
};

Outcome reconstruct_soot(const FamilyTrial& trial) {
  const Soot soot = soot_of(trial);
  const FamilyGrid grid = family_grid(trial);
  const Unknowns* const unknowns = grid.unknowns.get();
  std::vector<CompiledScene> scenes;
  for (int n = 0; n < trial.cameras; ++n) scenes.push_back(scene_of(soot, trial, grid, n));
  ThermalInput input;
  input.unknowns = unknowns;
  for (std::size_t c = 0; c < 2; ++c) {
    ThermalPictures pictures;
    pictures.channel = static_cast<int>(c);
    pictures.source = source_of(kWavelengths[c]);
    pictures.absorption_ratio = c == 0 ? 1 : kRatio;
    input.channels.push_back(std::move(pictures));
  }
  RenderSettings how;
  how.samples = 256;
  how.control_variate = false;
  how.seed = 7000 + trial.seed;
  for (std::size_t v = 0; v < scenes.size(); ++v) {
    input.views.push_back({&scenes[v], {}});
    const RenderResult picture = render(scenes[v], how);
    for (std::size_t c = 0; c < 2; ++c) {
      const LightFieldChannel& light = picture.light_field.channels[c];
      const double brightest = static_cast<double>(std::ranges::max(light.flux.pixels));
      input.channels[c].measurements.push_back(
          frame_of(light, brightest / trial.electrons, 100 * trial.seed + 10 * v + c));
    }
  }
  ThermalSettings settings;
  settings.linear.rays.samples = 64;
  settings.linear.rays.seed = 500 + trial.seed;
  const FlameEstimate found = reconstruct_thermal(input, settings).estimate;
  std::vector<double> temperature, absorption, emission;
  for (std::size_t j = 0; j < unknowns->size(); ++j) {
    const Vec3 at = unknowns->place(j);
    const Vec3 p{(at.x - 1) / kFlameRadius, at.y / kFlameRadius, at.z / kFlameHalfHeight};
    temperature.push_back(soot.temperature(p));
    absorption.push_back(soot.absorption(p));
    emission.push_back(absorption.back() * source_of(kWavelengths[0])(temperature.back()));
  }
  const double brightest = std::ranges::max(emission);
  std::vector<char> lit;
  for (const double value : emission) lit.push_back(value > 0.05 * brightest);
  return {errors_of(found.temperature, found.temperature_deviation, temperature, lit),
          errors_of(found.absorption, found.absorption_deviation, absorption, lit),
          errors_of(found.emission, found.emission_deviation, emission, lit)};
}

struct SootTotals {
  Totals temperature, absorption, emission;

  void add(const Outcome& found) {
    temperature.add(found.temperature);
    absorption.add(found.absorption);
    emission.add(found.emission);
  }
  void print_as(const std::string& name, const std::string& mark = "") const {
    print(mark + name + ", temperature" + mark, temperature.mean());
    print(mark + name + ", absorption" + mark, absorption.mean());
    print(mark + name + ", emission" + mark, emission.mean());
  }
};

// Blobs before sharp cameras. Chi^2 is above 1, and its rest is an error of the grid.
TEST(SootFamilies, DeviationsHoldWhatACoarseGridCannotTell) {
  for (const bool rings : {true, false}) {
    if (!in_full() && !rings) continue;  // minutes
    FamilyTrial trial{Family::blobs, rings, rings ? 1 : 3, 20000, 1, 0};
    trial.coarser = rings ? 2 : 1.4;
    SootTotals found;
    found.add(reconstruct_soot(trial));
    found.print_as(std::string("blobs, coarse ") + (rings ? "rings" : "voxels") +
                   " of two channels");
    expect_true(found.temperature);
    expect_true(found.absorption);
    EXPECT_LT(found.temperature.mean().error, 0.05);
    EXPECT_LT(found.absorption.mean().error, 0.5);
  }
}

TEST(SootFamilies, DeviationsAreTheErrors) {
  SootTotals all;
  for (const Family family : kFamilies) {
    SootTotals own;
    for (const int seed : {1, 2, 3}) {
      if (!in_full() && !(family == Family::blobs && seed == 2)) continue;
      FamilyTrial trial;
      trial.family = family;
      trial.electrons = seed == 1 ? 20000 : seed == 2 ? 5000 : 1000;
      trial.seed = static_cast<std::uint64_t>(seed);
      const Outcome found = reconstruct_soot(trial);
      own.add(found);
      all.add(found);
    }
    if (own.emission.count > 0) own.print_as(name_of(family) + ", two channels");
  }
  all.print_as("all, two channels", "**");
  expect_true(all.temperature);
  expect_true(all.absorption);
  if (in_full()) expect_true(all.emission);  // blobs alone have pulls of 1.6, 75 % within 1.96
  EXPECT_LT(all.temperature.mean().error, 0.03);
  EXPECT_LT(all.absorption.mean().error, 0.3);
}

}  // namespace
}  // namespace plenoflame::test::soot_families_test
