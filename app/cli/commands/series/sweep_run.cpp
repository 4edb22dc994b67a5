#include "commands/series/sweep_run.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/render/render_pictures.h"
#include "file_set.h"
#include "medium_loader.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/array_set.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/media/medium_samples.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/exposure.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render_request.h"
#ifdef PLENOFLAME_HAS_VOLUMES
#include "plenoflame/volumes/flame_generators.h"
#include "plenoflame/volumes/grid_samples.h"
#include "plenoflame/volumes/scene_session.h"
#endif

namespace plenoflame::cli {
namespace {

#ifdef PLENOFLAME_HAS_VOLUMES
using FlamesInMemory = std::map<std::string, FlameFields>;

FlamesInMemory generated_flames(const RunSettings& settings, int run, const Execution& execution) {
  FlamesInMemory flames;
  for (const auto& [number, flame] : settings.flames)
    flames.emplace(fmt::format("{}-flame{}.vdb", run_name(run), number),
                   generate_flame(flame.generator, flame.values, execution));
  return flames;
}

MediumLoader loader_of(const FlamesInMemory& flames) {
  return [&flames, load = medium_loader()](
             const FlameSpec& flame, const std::string& folder,
             const std::vector<SourceFunction>& channels,
             const Execution& execution) -> std::shared_ptr<const Medium> {
    const auto found = flame.kind == FlameKind::vdb ? flames.find(flame.file) : flames.end();
    if (found == flames.end()) return load(flame, folder, channels, execution);
    return medium_in_memory(found->second, flame, channels);
  };
}

/// Emission of lines on the lattice [W/m^3], by the names of their grids; flames add up.
std::map<std::string, std::vector<float>> lines_of(const Scene& scene, const FlamesInMemory& flames,
                                                   const TruthLattice& lattice,
                                                   const Execution& execution) {
  std::map<std::string, std::vector<float>> lines;
  const std::string folder = std::filesystem::path(scene.file).parent_path().string();
  for (const FlameSpec& flame : scene.flames) {
    if (flame.kind != FlameKind::vdb || flame.lines.empty()) continue;
    const auto kept = flames.find(flame.file);
    const FlameFields read = kept == flames.end() ? read_flame(flame, folder, {}) : FlameFields{};
    const FlameFields& fields = kept == flames.end() ? read : kept->second;
    const Mat3 turn = rotation_xyz(flame.rotation);
    std::vector<Vec3> places;
    const auto [nx, ny, nz] = lattice.count;
    const Vec3 size = lattice.box.upper - lattice.box.lower;
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const Vec3 world =
              lattice.box.lower +
              Vec3{(i + 0.5) * size.x / nx, (j + 0.5) * size.y / ny, (k + 0.5) * size.z / nz};
          const Vec3 d = world - flame.position;
          // The inverse of a rotation is its transpose.
          Vec3 local = d.x * turn.rows[0];
          local = local + d.y * turn.rows[1];
          local = local + d.z * turn.rows[2];
          places.push_back((1 / flame.scale) * local);
        }
    for (const VoxelField& field : fields.lines) {
      if (execution.stop.stop_requested()) throw Cancelled();
      const std::vector<double> values = sample_field(field, places);
      std::vector<float>& sum = lines[field.name];
      sum.resize(values.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        sum[i] += static_cast<float>(flame.brightness * values[i]);
    }
  }
  return lines;
}
#endif

bool reaches_beyond(const Box& inner, const Box& box) {
  const Vec3 size = box.upper - box.lower;
  constexpr double kSlack = 1e-9;  // of the box: rounding
  return inner.lower.x < box.lower.x - kSlack * size.x ||
         inner.lower.y < box.lower.y - kSlack * size.y ||
         inner.lower.z < box.lower.z - kSlack * size.z ||
         inner.upper.x > box.upper.x + kSlack * size.x ||
         inner.upper.y > box.upper.y + kSlack * size.y ||
         inner.upper.z > box.upper.z + kSlack * size.z;
}

void write_truth(const std::string& path, const TruthLattice& lattice, const MediumSamples& samples,
                 const std::map<std::string, std::vector<float>>& lines) {
  const auto [nx, ny, nz] = lattice.count;
  const std::vector<std::size_t> shape{static_cast<std::size_t>(nz), static_cast<std::size_t>(ny),
                                       static_cast<std::size_t>(nx)};
  ArraySetWriter file(path);
  const auto add = [&](const std::string& name, const std::vector<float>& values,
                       const char* unit) {
    file.rows(name, 1, shape, unit, "run,z,y,x");
    file.put(name, 0, values);
  };
  add("temperature", samples.temperature, "K");
  add("absorption", samples.absorption, "1/m");
  for (const auto& [name, values] : lines) add("lines/" + name, values, "W/m^3");
  const Box& box = lattice.box;
  file.attribute("/", "lower_m", std::vector<double>{box.lower.x, box.lower.y, box.lower.z});
  file.attribute("/", "upper_m", std::vector<double>{box.upper.x, box.upper.y, box.upper.z});
  file.close();
}

}  // namespace

void make_run(const SweepPlan& plan, int run, SweepWorker& worker, std::mutex& arrays,
              const Execution& execution) {
  const RunSettings settings = plan.settings(run);
  std::vector<std::pair<std::string, LightField>> fields;
  nlohmann::ordered_json record;
  record["run"] = run;
  record["split"] = plan.test[static_cast<std::size_t>(run)] ? "test" : "train";
  record["seed"] = seed_of_run(plan.seed(), run);
  record["values"] = nlohmann::ordered_json::object();
  for (const SweepValue& value : plan.runs[static_cast<std::size_t>(run)])
    if (!value.key.empty()) record["values"][value.key] = value.value;
  MediumSamples samples;
  std::map<std::string, std::vector<float>> lines;
  try {
#ifdef PLENOFLAME_HAS_VOLUMES
    const FlamesInMemory flames = generated_flames(settings, run, execution);
    const MediumLoader loader = loader_of(flames);
#else
    const MediumLoader loader = medium_loader();
#endif
    for (const Picture& picture : pictures_of(plan.options_of(run))) {
      const RenderSettings how = render_settings_of(picture.options, picture.document.scene);
      const auto compiled = [&](const Scene& scene) -> const CompiledScene& {
        worker.last = compile(scene, loader, execution, picture.document.positions,
                              {worker.last ? &*worker.last : nullptr});
        return *worker.last;
      };
      const std::vector<SceneMoment> moments = picture.moments();
      RenderResult result = render_exposure(moments, compiled, how, execution);
      if (execution.stop.stop_requested()) throw Cancelled();
      if (!result.statistics.target_reached)
        throw InputError("the target error was not reached within the limit of samples");
      describe(*worker.last, result.light_field);
      RunRecord exposure;
      add_exposure(picture, how, exposure);
      put_exposure(exposure, result.statistics.flux, result.light_field);
      if (moments.size() > 1) compiled(moments.front().scene);
      if (plan.options.truth) add_ground_truth(*worker.last, result.light_field, execution);
      if (plan.lattice && samples.temperature.empty()) {
        if (worker.last->medium)
          samples = sample_medium(*worker.last->medium, plan.lattice->box, plan.lattice->count,
                                  execution);
        const auto [nx, ny, nz] = plan.lattice->count;
        samples.temperature.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                                   static_cast<std::size_t>(nz));
        samples.absorption.resize(samples.temperature.size());
        record["beyond_lattice"] =
            worker.last->medium && reaches_beyond(worker.last->medium->bounds(), plan.lattice->box);
#ifdef PLENOFLAME_HAS_VOLUMES
        lines = lines_of(moments.front().scene, flames, *plan.lattice, execution);
#endif
        record["lines"] = nlohmann::json::array();
        for (const auto& [name, values] : lines) record["lines"].push_back(name);
      }
      record["pictures"].push_back(
          {{"camera", picture.document.scene.camera.name},
           {"file", std::filesystem::path(picture.options.output).filename().string()},
           {"flux_W", result.statistics.flux},
           {"relative_error", result.statistics.relative_error}});
      fields.emplace_back(picture.options.output, std::move(result.light_field));
    }
  } catch (const InputError& error) {
    throw_of_run(plan, run, error.what());
  } catch (const UsageError& error) {
    throw_of_run(plan, run, error.what());
  }
  FileSet files;
  for (const auto& [path, field] : fields)
    files.write(path, [&](const std::string& name) {
      write_light_field(name, field, execution.stop, ExrCompression::rle);
    });
  const std::string base = plan.folder + "/runs/" + run_name(run);
  if (plan.lattice) {
    const std::lock_guard lock(arrays);
    files.write(base + ".truth.h5",
                [&](const std::string& name) { write_truth(name, *plan.lattice, samples, lines); });
  }
  files.write(base + ".json",
              [&](const std::string& name) { write_file(name, record.dump(2) + "\n"); });
  files.commit();
}

}  // namespace plenoflame::cli
