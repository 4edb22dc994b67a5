#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plenoflame/image/image.h"
#include "plenoflame/image/light_field.h"

/// Memory of the library as numpy arrays, without a copy wherever it can be given away.
namespace plenoflame::python {

namespace py = pybind11;

/// Gives a container's memory away. @param shape of the array, rows first
template <class Container>
py::array given(Container&& values, std::vector<py::ssize_t> shape) {
  using Value = typename std::decay_t<Container>::value_type;
  auto* const kept = new std::decay_t<Container>(std::forward<Container>(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::decay_t<Container>*>(p); });
  return py::array_t<Value>(std::move(shape), kept->data(), owner);
}

/// A picture: (rows, columns), row 0 at the top.
py::array given(Image image);

/// A picture within a light field; changing one changes the other.
py::array shared(Image& image, const std::shared_ptr<LightField>& owner);

/// Pixels of an array (rows, columns). @throws UsageError for another shape
Image image_of(const py::array& array);

}  // namespace plenoflame::python
