#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "operator_problem.h"
#include "plenoflame/base/error.h"
#include "reconstruction_task.h"
#include "runnable.h"
#include "scene_handle.h"
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
      .def("SetOption", [](Run& r, const std::string& name,
                           const std::string& text) { set_option(r.request, name, text); })
      .def("AddCamera", [](Run& r, Handle scene) { r.scenes.push_back(std::move(scene)); })
      .def("SetStored", [](Run& r, bool stored) { r.stored = stored; })
      .def("GetNumberOfRows",
           [](const Run& r) { return r.problem ? r.problem->rays.rows.size() : 0; })
      .def("GetNumberOfColumns",
           [](const Run& r) { return r.problem ? r.problem->unknowns->size() : 0; })
      .def("GetNumberOfRays",
           [](const Run& r) { return r.problem ? r.problem->rays.ray_count() : 0; })
      .def("GetMatrixBytes",
           [](const Run& r) {
             return kBytesOfEntry * static_cast<double>(estimated_entries(r.problem->problem));
           })
      .def("IsOfSource", [](const Run& r) { return r.problem->problem.model == RowModel::source; })
      .def("GetShape",
           [](const Run& r, std::size_t axis) { return shape_of(*r.problem->unknowns).at(axis); })
      .def("GetPixels",
           [](const Run& r) {
             std::vector<int> pixels;
             for (const auto& row : r.problem->rays.rows)
               pixels.insert(pixels.end(), {row.column, row.row, row.view});
             const auto count = static_cast<py::ssize_t>(r.problem->rays.rows.size());
             return given(std::move(pixels), {count, 3});
           })
      .def("GetPlaces", [](const Run& r) { return places_of(*r.problem->unknowns); })
      .def("GetVolumes",
           [](const Run& r) {
             std::vector<double> volumes;
             for (std::size_t j = 0; j < r.problem->unknowns->size(); ++j)
               volumes.push_back(r.problem->unknowns->volume(j));
             const auto count = static_cast<py::ssize_t>(volumes.size());
             return given(std::move(volumes), {count});
           })
      .def("GetRowStarts", [](const Run& r) { return r.shared_array(r.matrix->row_starts()); })
      .def("GetColumnIndices",
           [](const Run& r) { return r.shared_array(r.matrix->column_indices()); })
      .def("GetValues", [](const Run& r) { return r.shared_array(r.matrix->values()); })
      .def("Times", &Run::times);
}

/// Reconstructs a flame from pictures.
class ReconstructionRun : public Runnable {
 public:
  void run(const Execution& execution) override { task.run(execution); }
  ReconstructionTask task;
};

std::shared_ptr<Voxels> voxels_of_result(const ReconstructionRun& run) {
  const auto voxels = std::make_shared<Voxels>();
  IndexBox box;
  const std::vector<VoxelField> fields = run.task.voxels(box);
  if (box.empty()) return voxels;
  voxels->place = voxel_place(fields.front().index_to_world, box);
  for (const VoxelField& field : fields) voxels->arrays.push_back(voxel_values(field, box));
  return voxels;
}

void bind_reconstruction(py::module_& module) {
  using Run = ReconstructionRun;
  const auto fields = [](const Run& r) {
    return r.task.has_result() ? reconstructed_fields(r.task.result())
                               : std::vector<ReconstructedField>();
  };
  py::class_<Run, Runnable>(module, "Reconstruction")
      .def(py::init<>())
      .def("SetOption", [](Run& r, const std::string& name,
                           const std::string& text) { r.task.set_option(name, text); })
      .def("AddCamera",
           [](Run& r, const Handle& scene, const std::shared_ptr<LightField>& picture,
              const std::string& what) {
             r.task.add_camera(
                 [scene](const Execution& execution) {
                   return scene->compile(execution, {IssueCode::no_flame});
                 },
                 scene->camera(), *picture, what);
           })
      .def("SetEarlierField",
           [](Run& r, const std::string& use, const std::string& field, const Numbers& values) {
             r.task.set_earlier(use, field,
                                std::vector<double>(values.data(), values.data() + values.size()));
           })
      .def("HasResult", [](const Run& r) { return r.task.has_result(); })
      .def("IsComplete",
           [](const Run& r) { return r.task.has_result() && r.task.result().figures.complete; })
      .def("GetFiguresAsJson", [](const Run& r) { return r.task.report().json_text(); })
      .def("GetReport", [](const Run& r) { return r.task.report_text(); })
      .def("GetShape",
           [](const Run& r, std::size_t axis) { return shape_of(r.task.unknowns()).at(axis); })
      .def("GetNumberOfFields", [fields](const Run& r) { return fields(r).size(); })
      .def("GetFieldName", [fields](const Run& r, std::size_t i) { return fields(r).at(i).name; })
      .def("GetField",
           [fields](const Run& r, std::size_t i) {
             std::vector<double> values = *fields(r).at(i).values;
             const auto count = static_cast<py::ssize_t>(values.size());
             return given(std::move(values), {count});
           })
      .def("GetPlaces", [](const Run& r) { return places_of(r.task.unknowns()); })
      .def("GetNumberOfPictures",
           [](const Run& r) { return r.task.result().figures.residual.size(); })
      .def("GetPicture",
           [](const Run& r, std::size_t i) {
             py::dict pictures;
             pictures["residual"] = given(Image(r.task.result().figures.residual.at(i)));
             pictures["explained"] = given(Image(r.task.result().figures.explained.at(i)));
             return pictures;
           })
      .def("GetOutput", &voxels_of_result)
      .def("Write", [](const Run& r, const std::string& path) { r.task.write(path); });
}

}  // namespace

void bind_inverse(py::module_& module) {
  bind_operator(module);
  bind_reconstruction(module);
}

}  // namespace plenoflame::python
