#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "plenoflame/base/error.h"
#include "plenoflame/volumes/reconstructor.h"
#include "reconstruct_settings.h"
#include "runnable.h"
#include "scene_handle.h"
#include "setting_tuples.h"
#include "voxels.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;
using Handle = std::shared_ptr<SceneHandle>;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::array<int, 3> shape_of(const Unknowns& unknowns) {
  return unknowns.shape();
}

py::array places_of(const Unknowns& unknowns) {
  std::vector<double> places;
  for (std::size_t j = 0; j < unknowns.size(); ++j) {
    const Vec3 p = unknowns.place(j);
    places.insert(places.end(), {p.x, p.y, p.z});
  }
  const auto count = static_cast<py::ssize_t>(unknowns.size());
  return given(std::move(places), {count, 3});
}

/// Makes an operator of one or several cameras.
class OperatorRun : public Runnable {
 public:
  OperatorRun() { request.unknowns.names = kNames; }
  void run(const Execution& execution) override {
    if (scenes.empty()) throw UsageError("an operator needs a camera");
    if (!problem) {
      check_operator(request);
      compiled.clear();  // of a run that failed halfway
      std::vector<const CompiledScene*> views;
      for (const Handle& scene : scenes) {
        compiled.push_back(scene->compile(execution, {IssueCode::no_flame}));
        views.push_back(compiled.back().get());
      }
      problem = make_operator_problem(request, views, "the scene", execution);
    }
    const Execution plain = execution.threads_only();
    if (stored && !matrix) {
      matrix = std::make_shared<const CsrMatrix<float>>(
          make_emission_matrix(problem->problem, execution));
      a = make_csr_operator(*matrix, plain);
    } else if (!a) {
      a = make_emission_operator(problem->problem, plain);
    }
  }

  /// A numpy array of the matrix' memory, which it keeps.
  template <class Value>
  py::object shared_array(std::span<const Value> values) const {
    const py::capsule keeper(new std::shared_ptr<const CsrMatrix<float>>(matrix), [](void* p) {
      delete static_cast<std::shared_ptr<const CsrMatrix<float>>*>(p);
    });
    return py::array_t<Value>(static_cast<py::ssize_t>(values.size()), values.data(), keeper);
  }

  py::array times(bool transpose, const Numbers& x) const {
    if (!a) throw UsageError("the operator was not made: call Run()");
    std::vector<double> y(transpose ? a->columns() : a->rows());
    const std::span<const double> in(x.data(), static_cast<std::size_t>(x.size()));
    if (in.size() != (transpose ? a->rows() : a->columns()))
      throw UsageError("the operator takes another number of values");
    {
      const py::gil_scoped_release release;
      if (transpose)
        a->apply_transpose(in, y);
      else
        a->apply(in, y);
    }
    const auto count = static_cast<py::ssize_t>(y.size());
    return given(std::move(y), {count});
  }

  OperatorRequest request;
  std::vector<Handle> scenes;
  bool stored = false;
  std::vector<std::shared_ptr<const CompiledScene>> compiled;
  std::unique_ptr<OperatorProblem> problem;
  std::shared_ptr<const CsrMatrix<float>> matrix;
  std::unique_ptr<LinearOperator> a;
};

void bind_operator(py::module_& module) {
  using Run = OperatorRun;
  py::class_<Run, Runnable>(module, "Operator")
      .def(py::init<>())
      .def("set_option", [](Run& r, const std::string& name,
                            const std::string& text) { set_option(r.request, name, text); })
      .def("add_camera", [](Run& r, Handle scene) { r.scenes.push_back(std::move(scene)); })
      .def_readwrite("stored", &Run::stored)
      .def_property_readonly("shape",
                             [](const Run& r) {
                               return r.problem ? py::make_tuple(r.problem->rays.rows.size(),
                                                                 r.problem->unknowns->size())
                                                : py::make_tuple(0, 0);
                             })
      .def_property_readonly(
          "rays", [](const Run& r) { return r.problem ? r.problem->rays.ray_count() : 0; })
      .def_property_readonly("matrix_bytes",
                             [](const Run& r) {
                               return kBytesOfEntry *
                                      static_cast<double>(estimated_entries(r.problem->problem));
                             })
      .def_property_readonly(
          "of_source", [](const Run& r) { return r.problem->problem.model == RowModel::source; })
      .def_property_readonly("grid_shape",
                             [](const Run& r) { return shape_of(*r.problem->unknowns); })
      .def_property_readonly("pixels",
                             [](const Run& r) {
                               std::vector<int> pixels;
                               for (const auto& row : r.problem->rays.rows)
                                 pixels.insert(pixels.end(), {row.column, row.row, row.view});
                               const auto count =
                                   static_cast<py::ssize_t>(r.problem->rays.rows.size());
                               return given(std::move(pixels), {count, 3});
                             })
      .def_property_readonly("places", [](const Run& r) { return places_of(*r.problem->unknowns); })
      .def_property_readonly("volumes",
                             [](const Run& r) {
                               std::vector<double> volumes;
                               for (std::size_t j = 0; j < r.problem->unknowns->size(); ++j)
                                 volumes.push_back(r.problem->unknowns->volume(j));
                               const auto count = static_cast<py::ssize_t>(volumes.size());
                               return given(std::move(volumes), {count});
                             })
      .def_property_readonly("row_starts",
                             [](const Run& r) { return r.shared_array(r.matrix->row_starts()); })
      .def_property_readonly(
          "column_indices", [](const Run& r) { return r.shared_array(r.matrix->column_indices()); })
      .def_property_readonly("values",
                             [](const Run& r) { return r.shared_array(r.matrix->values()); })
      .def("times", &Run::times);
}

/// Reconstructs a flame from pictures.
class ReconstructionRun : public Runnable {
 public:
  void run(const Execution& execution) override {
    result.reset();
    request.start_values = start;
    request.prior_values = prior;
    static_cast<void>(reconstruction_settings(request, 1));  // before any work
    std::vector<CameraPicture> pictures;
    for (const auto& [scene, picture, what] : cameras)
      pictures.push_back({scene->compile(execution, {IssueCode::no_flame}), *picture,
                          camera_text(scene->camera()), what});
    result = reconstruct_flame(request, std::move(pictures), execution);
  }

  /// @param use "start" or "prior"
  void set_earlier(const std::string& use, const std::string& field, const Numbers& values) {
    std::shared_ptr<EarlierResult>& earlier = use == "start" ? start : prior;
    if (!earlier) earlier = std::make_shared<EarlierResult>();
    std::vector<double>& to = field == "emission"      ? earlier->emission
                              : field == "temperature" ? earlier->temperature
                                                       : earlier->absorption;
    to.assign(values.data(), values.data() + values.size());
  }

  const FlameReconstruction& found() const {
    if (!result) throw UsageError("there is no result yet");
    return *result;
  }

  struct Camera {
    Handle scene;
    std::shared_ptr<LightField> picture;
    std::string what;
  };
  ReconstructRequest request;
  std::shared_ptr<EarlierResult> start, prior;
  std::vector<Camera> cameras;
  std::unique_ptr<const FlameReconstruction> result;
};

std::shared_ptr<Voxels> voxels_of_result(const ReconstructionRun& run) {
  const auto voxels = std::make_shared<Voxels>();
  IndexBox box;
  std::vector<VoxelField> fields;
  for (const ReconstructedField& field : reconstructed_fields(run.found().result)) {
    fields.push_back(on_voxels(field, run.found().unknowns()));
    box.add(stored_box(fields.back()));
  }
  if (box.empty()) return voxels;
  voxels->place = voxel_place(fields.front().index_to_world, box);
  for (const VoxelField& field : fields) voxels->arrays.push_back(voxel_values(field, box));
  return voxels;
}

py::list pictures_of(const std::vector<Image>& images) {
  py::list pictures;
  for (const Image& image : images) pictures.append(given(Image(image)));
  return pictures;
}

void bind_reconstruction(py::module_& module) {
  using Run = ReconstructionRun;
  py::class_<Run, Runnable>(module, "Reconstruction")
      .def(py::init<>())
      .def("set_option", [](Run& r, const std::string& name,
                            const std::string& text) { set_option(r.request, name, text); })
      .def("add_camera",
           [](Run& r, const Handle& scene, const std::shared_ptr<LightField>& picture,
              const std::string& what) {
             r.cameras.push_back({scene, picture, what});
           })
      .def(
          "set_built",
          [](Run& r, const OperatorRun& made) {
            if (!made.problem) throw UsageError("the operator was not made");
            r.request.built = {&made.problem->rays, made.matrix.get()};
          },
          py::keep_alive<1, 2>())
      .def("set_earlier", &Run::set_earlier)
      .def_property_readonly("has_result", [](const Run& r) { return r.result != nullptr; })
      .def_property_readonly(
          "complete", [](const Run& r) { return r.result && r.result->result.figures.complete; })
      .def_property_readonly("figures", [](const Run& r) { return r.found().report.json_text(); })
      .def_property_readonly("report", [](const Run& r) { return r.found().report.text(); })
      .def_property_readonly("shape", [](const Run& r) { return shape_of(r.found().unknowns()); })
      .def_property_readonly(
          "fields",
          [](const Run& r) {
            py::dict fields;
            if (!r.result) return fields;
            for (const ReconstructedField& field : reconstructed_fields(r.result->result)) {
              std::vector<double> values = *field.values;
              const auto count = static_cast<py::ssize_t>(values.size());
              fields[py::str(field.name)] = given(std::move(values), {count});
            }
            return fields;
          })
      .def_property_readonly("places", [](const Run& r) { return places_of(r.found().unknowns()); })
      .def_property_readonly(
          "residuals", [](const Run& r) { return pictures_of(r.found().result.figures.residual); })
      .def_property_readonly(
          "explained", [](const Run& r) { return pictures_of(r.found().result.figures.explained); })
      .def_property_readonly("output", &voxels_of_result)
      .def("write", [](const Run& r, const std::string& path) {
        write_estimate(path, r.found().result, r.found().unknowns());
      });
}

template <class Request>
py::list settings_of() {
  py::list list;
  add_settings<UnknownsRequest>(list);
  add_settings<Request>(list);
  return list;
}

void bind_settings(py::module_& module) {
  py::enum_<SettingKind>(module, "SettingKind")
      .value("text", SettingKind::text)
      .value("word", SettingKind::word)
      .value("whole", SettingKind::whole)
      .value("number", SettingKind::number)
      .value("flag", SettingKind::flag)
      .value("lengths", SettingKind::lengths)
      .value("sides", SettingKind::sides)
      .value("file", SettingKind::file);
  module.def("operator_settings", &settings_of<OperatorRequest>);
  module.def("reconstruct_settings", &settings_of<ReconstructRequest>);
}

}  // namespace

void bind_inverse(py::module_& module) {
  bind_settings(module);
  bind_operator(module);
  bind_reconstruction(module);
}

}  // namespace plenoflame::python
