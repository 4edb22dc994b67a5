#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <string>

#include "arrays.h"
#include "compiled_handle.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render.h"
#include "plenoflame/render/render_request.h"
#include "runnable.h"
#include "scene_handle.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Field = std::shared_ptr<LightField>;

/// Renders a scene.
class LightFieldSource : public Runnable {
 public:
  void run(const Execution& execution) override {
    output = nullptr;
    const auto compiled = scene->compile(execution);
    RenderSettings settings = render_settings(compiled->scene, request);
    if (window.width != 0) settings.window = window;  // render() checks it
    settings.compiled = camera;
    RenderResult result = render(*compiled, settings, execution);
    describe(*compiled, result.light_field);
    if (truth)  // also for a run that was stopped: it is kept
      add_ground_truth(*compiled, result.light_field, execution.threads_only());
    relative_error = result.statistics.relative_error;
    output = std::make_shared<LightField>(std::move(result.light_field));
  }

  std::shared_ptr<SceneHandle> scene;
  RenderRequest request;
  PixelWindow window;
  std::shared_ptr<const CompiledCamera> camera;  ///< nullptr: rays are traced
  bool truth = false;
  double relative_error = -1;
  Field output;
};

/// Names of all pictures of a light field.
std::map<std::string, Image*> images_of(LightField& field) {
  std::map<std::string, Image*> images;
  for (LightFieldChannel& channel : field.channels) {
    images[channel.name] = &channel.flux;
    if (!channel.standard_error.empty()) images[channel.name + ".error"] = &channel.standard_error;
  }
  for (auto& [name, layer] : field.layers) images[name] = &layer;
  return images;
}

/// None where there is no picture of this name.
py::object array_of(const Field& field, const std::string& name) {
  const auto images = images_of(*field);
  const auto found = images.find(name);
  if (found == images.end()) return py::none();
  return shared(*found->second, field);
}

std::vector<std::string> array_names(const Field& field) {
  std::vector<std::string> names;
  for (const auto& [name, image] : images_of(*field)) names.push_back(name);
  return names;
}

std::vector<std::string> channels_of(const LightField& field) {
  std::vector<std::string> names;
  for (const LightFieldChannel& channel : field.channels) names.push_back(channel.name);
  return names;
}

std::vector<std::string> layers_of(const LightField& field) {
  std::vector<std::string> names;
  for (const auto& [name, layer] : field.layers) names.push_back(name);
  return names;
}

/// Plain values that hold all of it; pictures share its memory.
py::dict state_of(const Field& field) {
  py::dict images, state;
  for (const auto& [name, image] : images_of(*field)) images[py::str(name)] = array_of(field, name);
  const PixelWindow& w = field->window;
  state["images"] = images;
  state["channels"] = channels_of(*field);
  state["layers"] = layers_of(*field);
  state["sensor"] = py::make_tuple(field->sensor_width, field->sensor_height);
  state["window"] = py::make_tuple(w.x, w.y, w.width, w.height);
  state["texts"] = py::make_tuple(field->scene_text, field->estimator, field->version, field->unit);
  state["seed"] = field->seed;
  state["samples"] = field->samples;
  state["complete"] = field->complete;
  state["numbers"] = field->numbers;
  state["attributes"] = field->texts;
  return state;
}

Field field_of(const py::dict& state) {
  const Field field = std::make_shared<LightField>();
  const auto images = state["images"].cast<std::map<std::string, py::array>>();
  const auto sensor = state["sensor"].cast<std::array<int, 2>>();
  const auto window = state["window"].cast<std::array<int, 4>>();
  const auto texts = state["texts"].cast<std::array<std::string, 4>>();
  field->sensor_width = sensor[0];
  field->sensor_height = sensor[1];
  field->window = {window[0], window[1], window[2], window[3]};
  for (const auto& name : state["channels"].cast<std::vector<std::string>>()) {
    LightFieldChannel channel{name, image_of(images.at(name)), {}};
    const auto error = images.find(name + ".error");
    if (error != images.end()) channel.standard_error = image_of(error->second);
    field->channels.push_back(std::move(channel));
  }
  for (const auto& name : state["layers"].cast<std::vector<std::string>>())
    field->layers[name] = image_of(images.at(name));
  field->scene_text = texts[0];
  field->estimator = texts[1];
  field->version = texts[2];
  field->unit = texts[3];
  field->seed = state["seed"].cast<std::uint64_t>();
  field->samples = state["samples"].cast<double>();
  field->complete = state["complete"].cast<bool>();
  field->numbers = state["numbers"].cast<std::map<std::string, double>>();
  field->texts = state["attributes"].cast<std::map<std::string, std::string>>();
  return field;
}

void bind_source(py::module_& module) {
  using Source = LightFieldSource;
  py::class_<Source, Runnable>(module, "LightFieldSource")
      .def(py::init<>())
      .def("SetInputDataObject",
           [](Source& s, std::shared_ptr<SceneHandle> scene) { s.scene = std::move(scene); })
      .def("SetSamples",
           [](Source& s, int samples) {
             s.request.samples = samples > 0 ? std::optional(samples) : std::nullopt;
           })
      .def("SetSeed",
           [](Source& s, std::int64_t seed) {
             s.request.seed =
                 seed >= 0 ? std::optional(static_cast<std::uint64_t>(seed)) : std::nullopt;
           })
      .def("SetEstimator",
           [](Source& s, int estimator) {
             if (estimator == 1) s.request.estimator = Estimator::backward;
             if (estimator == 2) s.request.estimator = Estimator::forward;
           })
      .def("SetTargetError",
           [](Source& s, double error) {
             s.request.target_error = error > 0 ? std::optional(error) : std::nullopt;
           })
      .def("SetTimeLimit",
           [](Source& s, double limit) {
             s.request.time_limit = limit > 0 ? std::optional(limit) : std::nullopt;
           })
      .def("SetCompiledCamera",
           [](Source& s, const CompiledCameraRun& run) {
             if (!run.rays) throw UsageError("the compiled camera has no rays yet");
             s.camera = run.rays;
           })
      .def("SetTruth", [](Source& s, bool truth) { s.truth = truth; })
      .def("SetWindow",
           [](Source& s, int x, int y, int width, int height) {
             s.window = {x, y, width, height};
           })
      .def("GetRelativeError", [](const Source& s) { return s.relative_error; })
      .def("GetOutput", [](const Source& s) {
        if (!s.output) throw Cancelled();
        return s.output;
      });
}

}  // namespace

void bind_light_field(py::module_& module) {
  py::class_<LightField, Field>(module, "LightField")
      .def("Array", &array_of)
      .def("ArrayNames", &array_names)
      .def("Channels", &channels_of)
      .def("Layers", &layers_of)
      .def("SceneText", [](const LightField& f) { return f.scene_text; })
      .def("Window",
           [](const LightField& f) {
             return py::make_tuple(f.window.x, f.window.y, f.window.width, f.window.height);
           })
      .def("Complete", [](const LightField& f) { return f.complete; })
      .def("Unit", [](const LightField& f) { return f.unit; })
      .def("Sensor",
           [](const LightField& f) { return py::make_tuple(f.sensor_width, f.sensor_height); })
      .def("State", &state_of)
      .def_static("FromState", &field_of);
  bind_source(module);
}

}  // namespace plenoflame::python
