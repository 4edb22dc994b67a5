#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <vector>

#include "arrays.h"
#include "camera_mesh.h"
#include "runnable.h"
#include "scene_handle.h"

namespace plenoflame::python {
namespace {

namespace py = pybind11;

py::array vectors(const std::vector<Vec3>& all) {
  std::vector<double> values;
  for (const Vec3 v : all) values.insert(values.end(), {v.x, v.y, v.z});
  return given(std::move(values), {static_cast<py::ssize_t>(all.size()), 3});
}

template <class T>
py::array flat(std::vector<T> values) {
  const auto count = static_cast<py::ssize_t>(values.size());
  return given(std::move(values), {count});
}

py::dict plain(const CameraMesh& mesh) {
  std::vector<int> lenses;
  for (const LensIndex lens : mesh.lenses) lenses.insert(lenses.end(), {lens.q, lens.r});
  py::dict out;
  out["points"] = vectors(mesh.points);
  out["normals"] = vectors(mesh.normals);
  out["offsets"] = flat(mesh.offsets);
  out["connectivity"] = flat(mesh.connectivity);
  out["surface"] = flat(mesh.surfaces);
  out["type"] = flat(mesh.types);
  out["microlens"] = given(std::move(lenses), {static_cast<py::ssize_t>(mesh.lenses.size()), 2});
  return out;
}

class CameraSource : public Runnable {
 public:
  void run(const Execution&) override { output = camera_meshes(scene->scene_of_camera(), request); }
  std::shared_ptr<SceneHandle> scene;
  CameraMeshRequest request;
  CameraMeshes output;
};

py::dict parts_of(const CameraSource& source) {
  const CameraMeshes& meshes = source.output;
  py::dict out;
  out["lens surfaces"] = plain(meshes.lens_surfaces);
  out["lens edges"] = plain(meshes.lens_edges);
  out["stop"] = plain(meshes.stop);
  out["microlenses"] = plain(meshes.microlenses);
  out["array plate"] = plain(meshes.plate);
  out["sensor"] = plain(meshes.sensor);
  return out;
}

}  // namespace

void bind_camera(py::module_& module) {
  py::class_<CameraSource, Runnable>(module, "CameraSource")
      .def(py::init<>())
      .def_readwrite("scene", &CameraSource::scene)
      .def_property_readonly("output", &parts_of);
}

}  // namespace plenoflame::python
