#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "core/inverse/glow_scene.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/sampling/noise.h"

/// Cameras around a ring of light, their pictures, and what is to be found of it.
namespace plenoflame::test {

inline Scene camera_scene(bool from_side) {
  Scene scene = glow_scene(40);
  if (from_side) {
    scene.camera.position = {1, -1, 0};
    scene.camera.look_direction = {0, 1, 0};
  }
  return scene;
}

struct Rig {
  std::vector<CompiledScene> scenes;
  std::unique_ptr<Unknowns> unknowns, finer;  ///< the finer ones fill the same space
  /// The samples are of this field; times the factor of the place where unknowns fade beyond the
  /// last of them, which finer ones do not.
  std::function<double(Vec3)> field, edge = [](Vec3) { return 1.0; };
  std::vector<double> truth, absorption;  ///< an absorption is the same everywhere
  ReconstructionSettings settings;

  void set_truth() {
    truth.clear();
    for (std::size_t j = 0; j < unknowns->size(); ++j) truth.push_back(field(unknowns->place(j)));
  }

  void get_ready(int iterations) {
    set_truth();
    settings.rays.samples = 16;
    settings.iterations = iterations;
    settings.draws = settings.probes = 0;
    settings.ray_noise = false;  // the pictures are made of the same rays
  }

  /// Fluxes of the operator that is inverted.
  ReconstructionInput input(double noise, std::uint64_t seed = 5) const {
    return measured(*unknowns, truth, absorption, settings.rays, noise, seed);
  }
  /// Fluxes of the same field on the finer grid, seen along other rays, and more of them.
  ReconstructionInput finer_input(double noise, std::uint64_t seed = 5) const {
    std::vector<double> samples, absorbing;
    for (std::size_t j = 0; j < finer->size(); ++j) {
      const Vec3 p = finer->place(j);
      samples.push_back(field(p) * edge(p));
      if (!absorption.empty()) absorbing.push_back(absorption[0] * edge(p));
    }
    CameraRaySettings other = settings.rays;
    other.samples *= 8;
    other.seed += 77;
    return measured(*finer, samples, absorbing, other, noise, seed);
  }
  ReconstructionInput measured(const Unknowns& shining, const std::vector<double>& samples,
                               const std::vector<double>& absorbing, const CameraRaySettings& how,
                               double noise, std::uint64_t seed) const {
    ReconstructionInput in;
    in.unknowns = unknowns.get();
    in.absorption = absorption;
    for (const CompiledScene& scene : scenes) in.views.push_back({&scene, {}});
    const CameraRays rays = draw_camera_rays(in.views, shining.bounds(), how);
    const EmissionProblem problem{
        &rays, &shining, absorbing.empty() ? RowModel::emission : RowModel::source, absorbing};
    const auto a = make_emission_operator(problem, {});
    std::vector<double> b(a->rows());
    a->apply(samples, b);
    double largest = 0;
    for (const double value : b) largest = std::max(largest, value);
    for (const CompiledScene& scene : scenes) {
      const SensorSpec& sensor = scene.scene.camera.sensor;
      Measurement m;
      m.window = {0, 0, sensor.columns, sensor.rows};
      m.flux = Image(sensor.columns, sensor.rows);
      m.deviation =
          Image(sensor.columns, sensor.rows, static_cast<float>(std::max(noise, 1e-5) * largest));
      in.measurements.push_back(std::move(m));
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
      const CameraRays::Row& row = rays.rows[i];
      in.measurements[static_cast<std::size_t>(row.view)].flux.at(row.column, row.row) =
          static_cast<float>(b[i] + noise * largest * NoiseStream(seed, i).gaussian());
    }
    return in;
  }
  double error(const std::vector<double>& values) const {
    double away = 0, all = 0;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      away += unknowns->volume(j) * (values[j] - truth[j]) * (values[j] - truth[j]);
      all += unknowns->volume(j) * truth[j] * truth[j];
    }
    return std::sqrt(away / all);
  }
};

inline Rig ring_rig() {
  Rig rig;
  rig.scenes.push_back(compile(camera_scene(false)));
  RingGrid grid = glow_rings();
  rig.unknowns = make_ring_unknowns(grid);
  rig.field = glow_at;
  rig.edge = [grid](Vec3 p) {
    return std::min(1.0, grid.rings - std::hypot(p.x - grid.base.x, p.y) / grid.radial_step);
  };
  grid.radial_step /= 4;
  grid.height_step /= 4;
  grid.rings *= 4;
  grid.heights = 4 * (grid.heights - 1) + 1;
  rig.finer = make_ring_unknowns(grid);
  rig.get_ready(400);
  return rig;
}

inline Rig voxel_rig(bool two) {
  Rig rig;
  rig.scenes.push_back(compile(camera_scene(false)));
  if (two) rig.scenes.push_back(compile(camera_scene(true)));
  RegularLattice lattice;
  lattice.count = {9, 9, 9};
  lattice.index_to_world.linear = {{{{1.1e-3, 0, 0}, {0, 1.1e-3, 0}, {0, 0, 2e-3}}}};
  lattice.index_to_world.translation = {1 - 4.4e-3, -4.4e-3, -8e-3};
  rig.unknowns = make_voxel_unknowns(lattice);
  rig.field = [](Vec3 p) {
    const double end = std::max(0.0, 1 - p.z * p.z / (8e-3 * 8e-3));
    return end * glow_at(p) * (1 + 0.5 * std::sin(900 * (p.x - 1) + 500 * p.y));
  };
  lattice.count = {33, 33, 33};
  lattice.index_to_world.linear = {{{{0.275e-3, 0, 0}, {0, 0.275e-3, 0}, {0, 0, 0.5e-3}}}};
  rig.finer = make_voxel_unknowns(lattice);
  rig.get_ready(200);
  return rig;
}

}  // namespace plenoflame::test
