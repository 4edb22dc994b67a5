#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <string>

#include "arrays.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/ground_truth.h"
#include "plenoflame/render/render.h"
#include "plenoflame/render/render_request.h"
#include "runnable.h"
#include "scene_handle.h"
#include "values.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Field = std::shared_ptr<LightField>;

/// Renders a scene.
class LightFieldSource : public Runnable {
 public:
  void run(const Execution& execution) override {
    output = nullptr;
    const auto compiled = white ? white_scene(execution) : scene->compile(execution);
    RenderSettings settings = render_settings(compiled->scene, request);
    if (window.width != 0) settings.window = window;  // render() checks it
    if (white && (truth || settings.estimator == Estimator::forward))
      throw UsageError("white has no flames: neither truth nor the forward estimator goes with it");
    RenderResult result = render(*compiled, settings, execution);
    describe(*compiled, result.light_field);
    if (truth)  // also for a run that was stopped: it is kept
      add_ground_truth(*compiled, result.light_field, execution.threads_only());
    relative_error = result.statistics.relative_error;
    output = std::make_shared<LightField>(std::move(result.light_field));
  }

  /// The camera in light of 1 W/(m^2 sr) from everywhere.
  std::shared_ptr<const CompiledScene> white_scene(const Execution& execution) const {
    SceneDocument document;
    document.scene = scene->scene_of_camera();
    document.scene.flames.clear();
    CompiledScene made =
        plenoflame::compile(document, load_core_medium, execution, {}, {IssueCode::no_flame});
    fill_with_light(made);
    return std::make_shared<const CompiledScene>(std::move(made));
  }

  std::shared_ptr<SceneHandle> scene;
  RenderRequest request;
  PixelWindow window;
  bool truth = false, white = false;
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

/// By name; they share its memory.
py::dict arrays_of(const Field& field) {
  py::dict arrays;
  for (const auto& [name, image] : images_of(*field)) arrays[py::str(name)] = shared(*image, field);
  return arrays;
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
  py::dict state;
  state["images"] = arrays_of(field);
  state["channels"] = channels_of(*field);
  state["layers"] = layers_of(*field);
  state["sensor"] = py::make_tuple(field->sensor_width, field->sensor_height);
  state["window"] = field->window;
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
  const auto texts = state["texts"].cast<std::array<std::string, 4>>();
  field->sensor_width = sensor[0];
  field->sensor_height = sensor[1];
  field->window = state["window"].cast<PixelWindow>();
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
  py::enum_<Estimator>(module, "Estimator")
      .value("backward", Estimator::backward)
      .value("forward", Estimator::forward);
  py::class_<Source, Runnable> source(module, "LightFieldSource");
  attributes(source, &Source::request, "samples", &RenderRequest::samples, "seed",
             &RenderRequest::seed, "estimator", &RenderRequest::estimator, "target_error",
             &RenderRequest::target_error, "time_limit", &RenderRequest::time_limit);
  source.def(py::init<>())
      .def_readwrite("scene", &Source::scene)
      .def_readwrite("window", &Source::window)
      .def_readwrite("truth", &Source::truth)
      .def_readwrite("white", &Source::white)
      .def_readonly("relative_error", &Source::relative_error)
      .def_property_readonly("output", [](const Source& s) {
        if (!s.output) throw Cancelled();
        return s.output;
      });
}

}  // namespace

void bind_light_field(py::module_& module) {
  py::class_<LightField, Field>(module, "LightField")
      .def_property_readonly("arrays", &arrays_of)
      .def("add_error",
           [](LightField& f) {
             LightFieldChannel& first = f.channels.at(0);
             if (first.standard_error.empty())
               first.standard_error = Image(first.flux.width, first.flux.height);
           })
      .def_property_readonly("channels", &channels_of)
      .def_property_readonly("layers", &layers_of)
      .def_readonly("scene_text", &LightField::scene_text)
      .def_readonly("unit", &LightField::unit)
      .def_readonly("window", &LightField::window)
      .def_readonly("complete", &LightField::complete)
      .def_property_readonly(
          "sensor",
          [](const LightField& f) { return py::make_tuple(f.sensor_width, f.sensor_height); })
      .def_property_readonly("state", &state_of)
      .def_static("from_state", &field_of);
  bind_source(module);
}

}  // namespace plenoflame::python
