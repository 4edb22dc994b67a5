// Frames of a sensor, temperatures and ground truth of light fields. Light fields of several
// others.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "light_field_camera.h"
#include "light_field_filter.h"
#include "plenoflame/base/units.h"
#include "plenoflame/lightfield/colour.h"
#include "plenoflame/lightfield/ground_truth.h"
#include "plenoflame/measure/sensor_frames.h"
#include "plenoflame/measure/temperatures.h"
#include "plenoflame/render/merge.h"
#include "plenoflame/render/pattern_images.h"
#include "plenoflame/render/projections.h"
#include "scene_handle.h"
#include "values.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

/// An array of what each item has; several numbers make columns.
template <class Number, class Items, class Value>
py::array column(const Items& items, int width, const Value& value) {
  std::vector<Number> numbers;
  for (const auto& item : items)
    for (int k = 0; k < width; ++k) numbers.push_back(static_cast<Number>(value(item, k)));
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(items.size())};
  if (width > 1) shape.push_back(width);
  return given(std::move(numbers), std::move(shape));
}

double part(Vec2 v, int k) {
  return k == 0 ? v.x : v.y;
}
double part(Vec3 v, int k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}
int part(LensIndex lens, int k) {
  return k == 0 ? lens.q : lens.r;
}

class ColourFilter : public Filter {
 public:
  void run(const Execution&) override {
    const Scene scene = scene_of(*input, "the light field").scene;
    const ColourChannels colours = display_colours(*input, scene);
    std::array<const Image*, 3> images{};
    for (std::size_t k = 0; k < 3; ++k) images[k] = &find_channel(*input, colours.names[k]).flux;
    output = colour_picture(images, {colours.is_xyz, saturation});
  }
  py::array array() const {
    std::vector<std::uint8_t> samples(output.samples.begin(), output.samples.end());
    return given(std::move(samples), {output.height, output.width, 3});
  }
  double saturation = 0;
  PngImage output;
};

/// Frames of the sensor, as digital numbers or as electrons.
class SensorFilter : public Filter {
 public:
  void run(const Execution& execution) override {
    const Scene scene = scene_of(*input, "the light field").scene;
    SensorFrames sensor(*input, scene, noise, execution);
    if (!channel_exposure.empty()) {
      std::vector<double> times(input->channels.size(), scene.camera.sensor.exposure_time);
      for (const auto& [name, time] : channel_exposure) times[place_of(name)] = time;
      sensor.expose_each(std::move(times));
    }
    FrameSettings settings;
    settings.light = light;
    settings.exposure_time = exposure < 0 ? scene.camera.sensor.exposure_time : exposure;
    if (settings.exposure_time == 0) settings.exposure_time = sensor.automatic();
    frames.clear();
    for (int number = 0; number < count; ++number) {
      settings.number = static_cast<std::uint64_t>(number) << 32;
      frames.emplace_back();
      if (as_electrons)
        electrons = std::make_shared<LightField>(sensor.electrons(settings, frames.back()));
      else
        frames.back() = sensor.frame(place_of(channel), settings);
    }
  }
  std::size_t place_of(const std::string& name) const {
    const LightFieldChannel& found = find_channel(*input, name);
    return static_cast<std::size_t>(&found - input->channels.data());
  }
  py::tuple numbers() const {
    std::vector<std::uint16_t> all;
    for (const SensorFrame& frame : frames)
      all.insert(all.end(), frame.numbers.begin(), frame.numbers.end());
    const SensorFrame& first = frames.front();
    const auto saturated =
        column<std::size_t>(frames, 1, [](const SensorFrame& f, int) { return f.saturated; });
    return py::make_tuple(given(std::move(all), {static_cast<py::ssize_t>(frames.size()),
                                                 first.window.height, first.window.width}),
                          first.exposure_time, first.gain, first.black_level, saturated);
  }
  SensorNoise noise;
  double exposure = -1;  ///< [s]; 0: automatic; negative: the sensor's
  std::map<std::string, double> channel_exposure;
  int count = 1;
  bool light = true, as_electrons = false;
  std::vector<SensorFrame> frames;
  Field electrons;
};

class PyrometryFilter : public Filter {
 public:
  void run(const Execution&) override {
    output = find_temperatures(*input, scene_of(*input, "the light field").scene, request);
  }
  py::dict figures() const {
    const TemperatureMap& map = output.map;
    py::dict found;
    found["law"] = output.law;
    found["pixels"] = map.pixels;
    found["bins"] = map.bins;
    found["mean"] = map.mean;
    found["deviation"] = map.deviation;
    found["lowest"] = map.lowest;
    found["highest"] = map.highest;
    found["expected_deviation"] = map.expected_deviation;
    found["scale_error"] = output.scale_error;
    found["saturated"] = output.left_out.saturated;
    found["defective"] = output.left_out.defective;
    return found;
  }
  TemperatureRequest request;
  Temperatures output;
};

class TruthFilter : public Filter {
 public:
  void run(const Execution& execution) override {
    const Scene scene = scene_of(*input, "the light field").scene;
    check_raw_image(*input, scene.camera, "the light field");
    const Camera camera(scene.camera);
    projections = project_points(camera, points, rays, execution);
    const MicroImages images(camera, false, execution);
    micro_images = micro_image_truth(images);
    if (!chief_rays) return;
    with_rays = std::make_shared<LightField>(*input);
    add_chief_rays(images, *with_rays, execution);
  }
  std::vector<Vec3> points;
  int rays = 4096;
  bool chief_rays = false;
  std::vector<MicroImageTruth> micro_images;
  std::vector<PointProjection> projections;
  Field with_rays;
};

py::tuple micro_image_arrays(const TruthFilter& truth) {
  using One = MicroImageTruth;
  const auto& all = truth.micro_images;
  return py::make_tuple(
      column<int>(all, 2, [](const One& m, int k) { return part(m.lens, k); }),
      column<int>(all, 1, [](const One& m, int) { return m.type; }),
      column<double>(all, 2, [](const One& m, int k) { return part(m.centre, k); }),
      column<double>(all, 1, [](const One& m, int) { return m.radius; }));
}

py::tuple projection_arrays(const TruthFilter& truth) {
  using One = PointProjection;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto& all = truth.projections;
  const auto light = [](const One& p) {
    return p.light.value_or(PointImage{{}, -1, kNone, kNone, kNone, 0});
  };
  return py::make_tuple(
      column<int>(all, 1, [](const One& p, int) { return p.point; }),
      column<int>(all, 2, [](const One& p, int k) { return part(p.lens, k); }),
      column<int>(all, 1, [](const One& p, int) { return p.type; }),
      column<double>(all, 2,
                     [](const One& p, int k) {
                       return part(p.chief.value_or(Vec2{kNone, kNone}), k);
                     }),
      column<double>(all, 2,
                     [&](const One& p, int k) { return k == 0 ? light(p).column : light(p).row; }),
      column<double>(all, 1, [&](const One& p, int) { return light(p).spread; }),
      column<double>(all, 1, [&](const One& p, int) { return light(p).share; }));
}

/// Merges light fields: files, and such in memory.
class Merge : public Runnable {
 public:
  void run(const Execution& execution) override {
    std::vector<MergeInput> all;
    for (const auto& [name, field] : inputs) all.push_back({name, field.get()});
    output = std::make_shared<LightField>(merge_light_fields(all, execution.stop));
  }
  std::vector<std::pair<std::string, Field>> inputs;
  Field output;
};

class Corners : public Runnable {
 public:
  void run(const Execution& execution) override {
    // The place of a corner does not depend on the flames.
    SceneHandle bare(*scene);
    bare.change().flames.clear();
    output = pattern_images(*bare.compile(execution, {IssueCode::no_flame}), rays, execution);
  }
  std::shared_ptr<SceneHandle> scene;
  int rays = 4096;
  std::vector<PatternImage> output;
};

py::tuple corner_arrays(const Corners& corners) {
  using One = PatternImage;
  const auto& all = corners.output;
  return py::make_tuple(
      column<int>(all, 1, [](const One& c, int) { return c.point.surface; }),
      column<int>(all, 1, [](const One& c, int) { return c.point.column; }),
      column<int>(all, 1, [](const One& c, int) { return c.point.row; }),
      column<double>(all, 3, [](const One& c, int k) { return part(c.point.point, k); }),
      column<double>(all, 3, [](const One& c, int k) { return part(c.in_camera, k); }),
      column<int>(all, 2, [](const One& c, int k) { return part(c.image.lens, k); }),
      column<int>(all, 1, [](const One& c, int) { return c.image.type; }),
      column<double>(all, 2,
                     [](const One& c, int k) { return k == 0 ? c.image.column : c.image.row; }),
      column<double>(all, 1, [](const One& c, int) { return c.image.spread; }),
      column<double>(all, 1, [](const One& c, int) { return c.image.share; }));
}

void bind_sensor(py::module_& module) {
  py::class_<ColourFilter, Filter>(module, "Colour")
      .def(py::init<>())
      .def_readwrite("saturation", &ColourFilter::saturation)
      .def_property_readonly("output", &ColourFilter::array);
  py::class_<SensorFilter, Filter> sensor(module, "Sensor");
  attributes(sensor, &SensorFilter::noise, "shot", &SensorNoise::shot, "read", &SensorNoise::read,
             "dark", &SensorNoise::dark, "defects", &SensorNoise::defects, "noise_seed",
             &SensorNoise::seed);
  sensor.def(py::init<>())
      .def_readwrite("exposure", &SensorFilter::exposure)
      .def_readwrite("channel_exposure", &SensorFilter::channel_exposure)
      .def_readwrite("count", &SensorFilter::count)
      .def_readwrite("light", &SensorFilter::light)
      .def_readwrite("as_electrons", &SensorFilter::as_electrons)
      .def_readonly("electrons", &SensorFilter::electrons)
      .def_property_readonly("output", &SensorFilter::numbers);
}

void bind_pyrometry(py::module_& module) {
  py::class_<PyrometryFilter, Filter> pyrometry(module, "Pyrometry");
  attributes(pyrometry, &PyrometryFilter::request, "channels", &TemperatureRequest::channels,
             "filters", &TemperatureRequest::filters, "law", &TemperatureRequest::law, "exponent",
             &TemperatureRequest::exponent, "block", &TemperatureRequest::block, "cells",
             &TemperatureRequest::cells);
  pyrometry.def(py::init<>())
      .def_property(
          "threshold", [](const PyrometryFilter& f) { return f.request.pixels.threshold; },
          [](PyrometryFilter& f, double value) { f.request.pixels.threshold = value; })
      .def_property(
          "least_signal",
          [](const PyrometryFilter& f) { return f.request.pixels.least_signal_to_noise; },
          [](PyrometryFilter& f, double value) { f.request.pixels.least_signal_to_noise = value; })
      .def_property_readonly("figures", &PyrometryFilter::figures)
      .def_property_readonly("output", [](PyrometryFilter& f) {
        return std::make_shared<LightField>(std::move(f.output.picture));
      });
}

}  // namespace

void bind_measurements(py::module_& module) {
  bind_sensor(module);
  bind_pyrometry(module);
  py::class_<TruthFilter, Filter>(module, "Truth")
      .def(py::init<>())
      .def_readwrite("points", &TruthFilter::points)
      .def_readwrite("rays", &TruthFilter::rays)
      .def_readwrite("chief_rays", &TruthFilter::chief_rays)
      .def_property_readonly("micro_images", &micro_image_arrays)
      .def_property_readonly("projections", &projection_arrays)
      .def_readonly("with_rays", &TruthFilter::with_rays);
  py::class_<Merge, Runnable>(module, "Merge")
      .def(py::init<>())
      .def_readwrite("inputs", &Merge::inputs)
      .def_readonly("output", &Merge::output);
  py::class_<Corners, Runnable>(module, "Corners")
      .def(py::init<>())
      .def_readwrite("scene", &Corners::scene)
      .def_readwrite("rays", &Corners::rays)
      .def_property_readonly("output", &corner_arrays);
  module.def("seconds",
             [](const std::string& text) { return parse_quantity(text, Dimension::time); });
}

}  // namespace plenoflame::python
