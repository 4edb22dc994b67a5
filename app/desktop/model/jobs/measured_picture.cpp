#include "model/jobs/measured_picture.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/calibration/raw_import.h"
#include "plenoflame/camera/sensor_levels.h"
#include "plenoflame/image/raw_picture.h"
#include "plenoflame/scene/glass_indices.h"

namespace plenoflame::desktop {
namespace {

std::string size_text(int columns, int rows) {
  return std::to_string(columns) + " x " + std::to_string(rows) + " pixels";
}

[[noreturn]] void refuse_size(const std::string& path, int columns, int rows,
                              const SensorSpec& sensor) {
  throw InputError("'" + path + "' has " + size_text(columns, rows) + ", the camera's sensor " +
                   size_text(sensor.columns, sensor.rows) +
                   ": open the scene of the camera that took it");
}

/// Pixels of a window where they are on the sensor.
Image on_sensor(const Image& part, const PixelWindow& window, const SensorSpec& sensor) {
  Image whole(sensor.columns, sensor.rows);
  for (int row = 0; row < part.height; ++row)
    for (int column = 0; column < part.width; ++column)
      whole.at(window.x + column, window.y + row) = part.at(column, row);
  return whole;
}

LightField read_light_field_of(const std::string& path, const SensorSpec& sensor,
                               const Execution& execution) {
  LightField field = read_light_field(path, execution.stop);
  if (field.sensor_width != sensor.columns || field.sensor_height != sensor.rows)
    refuse_size(path, field.sensor_width, field.sensor_height, sensor);
  const bool whole = field.window.width == sensor.columns && field.window.height == sensor.rows;
  if (whole) return field;
  for (LightFieldChannel& channel : field.channels) {
    channel.flux = on_sensor(channel.flux, field.window, sensor);
    if (!channel.standard_error.empty())
      channel.standard_error = on_sensor(channel.standard_error, field.window, sensor);
  }
  field.layers.clear();
  field.window = {0, 0, sensor.columns, sensor.rows};
  return field;
}

/// A camera's own file, without the corrections that take further pictures.
LightField read_counts(const std::string& path, const Scene& scene, const Execution& execution) {
  const SensorSpec levels = resolved_levels(scene.camera.sensor);
  FrameSums sums(std::ldexp(1.0, levels.bits) - 1);
  read_raw_pictures(path, {}, [&](RawPicture&& picture) {
    if (execution.stop.stop_requested()) throw Cancelled();
    if (picture.width != levels.columns || picture.height != levels.rows)
      refuse_size(path, picture.width, picture.height, levels);
    if (picture.lossy || picture.display_curve)
      execution.warn("'" + path +
                     "' was packed or toned to be looked at: its numbers are no counts");
    sums.add(picture, "'" + path + "'");
  });
  const CountFrames frames = sums.result();
  ImportSettings settings;
  settings.response.gain = levels.gain;
  settings.response.read_noise = levels.read_noise;
  settings.response.black_level = levels.black_level;
  settings.response.exposure_time = levels.exposure_time;
  settings.response.dark_current = levels.dark_current;
  settings.window = {0, 0, levels.columns, levels.rows};
  settings.mosaic = levels.mosaic;
  const std::size_t wanted = settings.mosaic != MosaicPattern::none ? 3 : frames.mean.size();
  if (scene.channels.size() < wanted)
    throw InputError("'" + path + "' has " + std::to_string(wanted) + " channels, the scene " +
                     std::to_string(scene.channels.size()) + ": add them to the scene");
  for (std::size_t c = 0; c < wanted; ++c) settings.names.push_back(scene.channels[c].name);
  ImportSummary summary;
  LightField field = import_counts(frames, {}, settings, summary);
  field.sensor_width = levels.columns;
  field.sensor_height = levels.rows;
  return field;
}

QString in_words(const Registration& found) {
  const PictureFit& whole = found.whole;
  return MeasuredPicture::tr(
             "measured = %1 x simulated, shifted by %2, %3 pixel (right, down); %4 % rms are left; "
             "micro-images are shifted by %5 pixel (median)")
      .arg(whole.gain, 0, 'g', 4)
      .arg(whole.shift.x, 0, 'f', 3)
      .arg(whole.shift.y, 0, 'f', 3)
      .arg(100 * whole.residual, 0, 'g', 3)
      .arg(found.median_shift, 0, 'f', 3);
}

}  // namespace

QString gain_in_words(const QString& name, const SensorSpec& sensor) {
  return MeasuredPicture::tr(
             "%1: %2 electrons per count (%3); a gain that the file itself names is not used")
      .arg(name)
      .arg(resolved_levels(sensor).gain, 0, 'g', 4)
      .arg(sensor.gain > 0 ? MeasuredPicture::tr("the scene's sensor.gain")
                           : MeasuredPicture::tr("full well over bits, as sensor.gain is 0"));
}

bool is_measured(const LightField& field) {
  return field.texts.contains("import.pictures");
}

std::shared_ptr<const LightField> read_measured(const std::string& path, const Scene& scene,
                                                const Execution& execution) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::make_shared<const LightField>(
      ending == ".exr" ? read_light_field_of(path, scene.camera.sensor, execution)
                       : read_counts(path, scene, execution));
}

MeasuredPicture::MeasuredPicture(Document& document, QObject* parent)
    : QObject(parent), document_(document) {
  connect(&document_, &Document::scene_changed, this, &MeasuredPicture::on_scene);
  connect(&document_, &Document::image_changed, this, &MeasuredPicture::on_image);
}

void MeasuredPicture::set(std::shared_ptr<const LightField> field, const QString& name,
                          const QString& counts_path) {
  if (!field && !field_) return;
  field_ = std::move(field);
  name_ = name;
  counts_path_ = counts_path;
  if (field_) sensor_ = document_.camera().sensor;
  forget_registration();
  emit changed();
  on_image();
}

void MeasuredPicture::renew(std::shared_ptr<const LightField> field) {
  field_ = std::move(field);
  forget_registration();
  emit renewed();
  on_image();
}

void MeasuredPicture::on_scene(const SceneChanges& changes) {
  if (!field_) return;
  const SensorSpec& sensor = document_.camera().sensor;
  // Another scene, or another sensor, has not taken it.
  if (changes.opened || sensor.columns != field_->sensor_width ||
      sensor.rows != field_->sensor_height)
    return clear();
  if (changes.image()) forget_registration();
  if (sensor == sensor_) return;
  sensor_ = sensor;
  emit outdated();
}

void MeasuredPicture::forget_registration() {
  ++newest_;
  task_.cancel();
  if (!registration_ && text_.isEmpty()) return;
  registration_ = nullptr;
  text_.clear();
  emit registration_changed();
}

/// The registration is of whole pictures: one that is being refined is waited for.
void MeasuredPicture::on_image() {
  const auto& simulated = document_.image();
  // An imported picture was opened as such.
  if (simulated && document_.image_is_current() && is_measured(*simulated)) {
    if (simulated != field_)
      set(simulated, QString::fromStdString(simulated->texts.at("import.pictures")));
    return;
  }
  if (!field_ || !simulated || !simulated->complete || !document_.image_is_current() ||
      simulated == field_ || !document_.is_valid())
    return;
  if (!document_.camera().array.present) return;
  const unsigned number = ++newest_;
  const auto show = [this, number](std::shared_ptr<const Registration> found, const QString& text) {
    if (number != newest_) return;
    registration_ = std::move(found);
    text_ = text;
    emit registration_changed();
  };
  task_.request([this, show, measured = field_, simulated,
                 scene = document_.scene_of_camera().scene](const std::stop_token& stop) {
    Execution execution;
    execution.stop = stop;
    try {
      Scene at_wavelength = scene;
      set_indices(at_wavelength);
      const MicroImages micro_images(Camera(at_wavelength.camera), false, execution);
      auto found = std::make_shared<const Registration>(
          register_pictures(measured->channels.front().flux, simulated->channels.front().flux,
                            simulated->window, micro_images, execution));
      post(this, [show, found] { show(found, in_words(*found)); });
    } catch (const Cancelled&) {
    } catch (const std::exception& error) {
      post(this, [show, why = QString::fromUtf8(error.what())] { show(nullptr, why); });
    }
  });
}

}  // namespace plenoflame::desktop
