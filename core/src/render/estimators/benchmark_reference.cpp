#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/fnv.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/version.h"
#include "plenoflame/render/benchmark.h"
#include "plenoflame/sampling/sobol.h"
#include "plenoflame/scene/input_files.h"
#include "plenoflame/scene/scene_file.h"
#include "render/run/run_control.h"

namespace plenoflame {
namespace {

constexpr int kReplicates = 4;
const char* const kChecksum = "benchmark.checksum";

std::string_view bytes_of(const Image& image) {
  return {reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(float)};
}

/// The checksum of all data of a light field except for the checksum itself.
std::string checksum(const LightField& field) {
  Fnv sum;
  const auto add = [&sum](const auto&... parts) { (sum.add(fmt::format("{}|", parts)), ...); };
  const PixelWindow& window = field.window;
  add(field.sensor_width, field.sensor_height, window.x, window.y, window.width, window.height,
      field.scene_text, field.estimator, field.seed, field.samples, field.complete, field.version,
      field.unit);
  for (const auto& [name, value] : field.numbers) add(name, value);
  for (const auto& [name, value] : field.texts)
    if (name != kChecksum) add(name, value);
  for (const LightFieldChannel& channel : field.channels) {
    add(channel.name);
    sum.add(bytes_of(channel.flux));
    sum.add(bytes_of(channel.standard_error));
  }
  for (const auto& [name, image] : field.layers) {
    add(name);
    sum.add(bytes_of(image));
  }
  return fmt::format("{:016x}", sum.value());
}

/// All inputs of the picture, except for the program itself.
std::string key_of(const Scene& scene, const PixelWindow& window) {
  Fnv key;
  key.add(write_scene(scene));
  for (const InputFile& file : input_files(scene))
    key.add(fmt::format("|{}|{}|{}", file.name, file.size, file.modified));
  for (const int number : {window.x, window.y, window.width, window.height}) {
    key.add("|");
    key.add(std::to_string(number));
  }
  return fmt::format("{:016x}", key.value());
}

/// The reference from a file; no value if the file is missing or does not fit.
std::optional<LightField> from_cache(const std::string& file, const ReferenceSettings& settings,
                                     std::uint64_t seed, const Execution& execution) {
  std::error_code none;
  if (!std::filesystem::exists(file, none)) return {};
  const auto useless = [&](const std::string& why) {
    execution.note("the reference in " + file + " " + why + "; it is computed again");
    return std::optional<LightField>();
  };
  try {
    LightField field = read_light_field(file);
    if (field.version != version())
      return useless("is of version " + field.version + ", this is " + std::string(version()));
    if (field.channels.empty() || field.channels.front().standard_error.empty() ||
        field.texts[kChecksum] != checksum(field))
      return useless("is damaged");
    if (field.samples < settings.samples) return useless("has too few samples");
    if (field.seed != seed) return useless("has another seed");
    return field;
  } catch (const Error&) {
    return useless("is damaged");
  }
}

bool keep(const std::string& file, LightField& field, const Execution& execution) {
  try {
    std::filesystem::create_directories(std::filesystem::path(file).parent_path());
    field.texts[kChecksum] = checksum(field);
    write_light_field(file, field);
    return true;
  } catch (const std::filesystem::filesystem_error& error) {
    execution.warn("the reference is not kept: " + error.path1().string() + ": " +
                   error.code().message());
  } catch (const FileError& error) {
    execution.warn(std::string("the reference is not kept: ") + error.what());
  }
  return false;
}

}  // namespace

BenchmarkReference benchmark_reference(const CompiledScene& scene,
                                       const ReferenceSettings& settings,
                                       const Execution& execution) {
  const SensorSpec& sensor = scene.scene.camera.sensor;
  const PixelWindow window =
      settings.window.width > 0 ? settings.window : PixelWindow{0, 0, sensor.columns, sensor.rows};
  const std::uint64_t seed = mix64(settings.seed ^ 0x7265666572656e63u);
  BenchmarkReference reference;
  if (!settings.cache.empty())
    reference.file = (std::filesystem::path(settings.cache) /
                      ("reference-" + key_of(scene.scene, window) + ".exr"))
                         .string();
  std::optional<LightField> cached;
  if (!reference.file.empty()) cached = from_cache(reference.file, settings, seed, execution);
  reference.cached = cached.has_value();
  if (cached) {
    reference.light_field = std::move(*cached);
  } else {
    RenderSettings render_settings;
    render_settings.samples = settings.samples;
    render_settings.replicates = std::min(kReplicates, std::max(2, settings.samples));
    render_settings.seed = seed;
    render_settings.window = window;
    const auto start = std::chrono::steady_clock::now();
    RenderResult result = render(scene, render_settings, execution);
    reference.seconds = seconds_since(start);
    if (!result.statistics.complete) throw Cancelled();
    reference.light_field = std::move(result.light_field);
    reference.light_field.scene_text = write_scene(scene.scene);
    reference.light_field.version = version();
  }
  const LightFieldChannel& channel = reference.light_field.channels.front();
  reference.relative_error = estimated_relative_rmse(channel.flux, channel.standard_error);
  bool lit = false;
  for (const float value : channel.flux.pixels) lit = lit || value > 0;
  if (!lit)
    throw InputError("no pixel is lit, so there is no error to measure; choose another window");
  if (!reference.cached && !reference.file.empty() &&
      !keep(reference.file, reference.light_field, execution))
    reference.file.clear();
  return reference;
}

}  // namespace plenoflame
