#include "arrays.h"

#include <algorithm>

#include "plenoflame/base/error.h"

namespace plenoflame::python {

py::array given(Image image) {
  const std::vector<py::ssize_t> shape{image.height, image.width};
  return given(std::move(image.pixels), shape);
}

py::array shared(Image& image, const std::shared_ptr<LightField>& owner) {
  const py::capsule keeper(new std::shared_ptr<LightField>(owner),
                           [](void* p) { delete static_cast<std::shared_ptr<LightField>*>(p); });
  return py::array_t<float>(std::vector<py::ssize_t>{image.height, image.width},
                            image.pixels.data(), keeper);
}

Image image_of(const py::array& array) {
  const auto values = py::array_t<float, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!values || values.ndim() != 2) throw UsageError("a picture is an array (rows, columns)");
  Image image(static_cast<int>(values.shape(1)), static_cast<int>(values.shape(0)));
  std::copy_n(values.data(), values.size(), image.pixels.begin());
  return image;
}

}  // namespace plenoflame::python
