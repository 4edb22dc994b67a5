#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "ray_block_queue.h"
#include "runnable.h"
#include "scene_handle.h"
#include "values.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

/// Moves a column into an array; one of several components has two dimensions.
template <class T>
py::array moved(pipeline::GrowingColumn<T>& column) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(column.rows())};
  if (column.components() > 1) shape.push_back(column.components());
  T* const values = column.release();
  return py::array_t<T>(shape, values,
                        py::capsule(values, [](void* p) { delete[] static_cast<T*>(p); }));
}

template <class Real>
py::dict plain(pipeline::RayTable<Real>& rays) {
  py::dict columns, fields, out;
  columns["pixel"] = moved(rays.pixel);
  columns["microlens"] = moved(rays.microlens);
  columns["type"] = moved(rays.type);
  columns["replicate"] = moved(rays.replicate);
  columns["status"] = moved(rays.status);
  columns["ended_at"] = moved(rays.ended_at);
  columns["etendue"] = moved(rays.etendue);
  columns["sampled_etendue"] = moved(rays.sampled_etendue);
  columns["origin"] = moved(rays.origin);
  columns["direction"] = moved(rays.direction);
  columns["t_near"] = moved(rays.t_near);
  columns["t_far"] = moved(rays.t_far);
  if (!rays.channels.empty()) columns["radiance"] = moved(rays.radiance);
  fields["anchor"] = given(std::vector<double>{rays.anchor.x, rays.anchor.y, rays.anchor.z}, {3});
  fields["tile"] = given(std::vector<int>{rays.tile}, {1});
  fields["path"] = given(std::vector<int>{rays.path}, {1});
  fields["channels"] =
      given(std::vector<int>(rays.channels), {static_cast<py::ssize_t>(rays.channels.size())});
  out["columns"] = columns;
  out["fields"] = fields;
  out["rows"] = rays.rays;
  return out;
}

class RayStream {
 public:
  void start(const std::shared_ptr<SceneHandle>& scene) {
    stop();
    Execution execution;
    execution.threads = threads;
    execution.message = [this](Severity severity, const std::string& text) {
      if (severity == Severity::warning) warnings.push_back(text);
    };
    const auto compiled = scene->compile(execution);
    settings.replicates = std::clamp(settings.samples, 1, settings.replicates);
    settings.seed = seed.value_or(compiled->scene.render.seed);
    const auto content = radiance ? RayStreamContent::radiance : RayStreamContent::rays;
    if (double_precision)
      double_ = std::make_unique<pipeline::RayBlockQueue<double>>(compiled, settings, threads,
                                                                  content, rays_per_block);
    else
      single_ = std::make_unique<pipeline::RayBlockQueue<float>>(compiled, settings, threads,
                                                                 content, rays_per_block);
  }
  /// None at the end.
  py::object next() {
    py::object table = double_ ? next_of(*double_) : single_ ? next_of(*single_) : py::none();
    if (table.is_none()) stop();
    return table;
  }
  bool is_ready() {
    if (double_) return double_->is_ready();
    return !single_ || single_->is_ready();
  }
  void stop() {
    single_.reset();
    double_.reset();
  }

  RenderSettings settings;
  std::optional<std::uint64_t> seed;  ///< none: the scene's
  bool double_precision = true, radiance = false;
  std::size_t rays_per_block = 65536;
  int threads = 0;
  std::vector<std::string> warnings;

 private:
  template <class Real>
  py::object next_of(pipeline::RayBlockQueue<Real>& queue) {
    auto rays = [&] {
      const py::gil_scoped_release release;
      return queue.next();
    }();
    if (!rays) return py::none();
    return plain(*rays);
  }
  std::unique_ptr<pipeline::RayBlockQueue<float>> single_;
  std::unique_ptr<pipeline::RayBlockQueue<double>> double_;
};

}  // namespace

void bind_ray_stream(py::module_& module) {
  using Stream = RayStream;
  const auto released = py::call_guard<py::gil_scoped_release>();
  py::class_<Stream> stream(module, "RayStream");
  attributes(stream, &Stream::settings, "samples", &RenderSettings::samples, "window",
             &RenderSettings::window, "skip", &RenderSettings::skip);
  stream.def(py::init<>())
      .def_readwrite("double_precision", &Stream::double_precision)
      .def_readwrite("radiance", &Stream::radiance)
      .def_readwrite("seed", &Stream::seed)
      .def_readwrite("rays_per_block", &Stream::rays_per_block)
      .def_readwrite("threads", &Stream::threads)
      .def("start", &Stream::start, released)
      .def("is_ready", &Stream::is_ready)
      .def("next", &Stream::next)
      .def("stop", &Stream::stop, released)
      .def("take_warnings", [](Stream& s) { return std::exchange(s.warnings, {}); });
}

}  // namespace plenoflame::python
