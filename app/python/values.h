#pragma once
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>

#include "plenoflame/camera/microlens_lattice.h"
#include "plenoflame/image/image.h"
#include "plenoflame/math/vector.h"
#include "plenoflame/render/ray_paths.h"

/// Plain values of the library as Python's: numbers that belong together are tuples.
namespace plenoflame::python {

template <class Plain, class Number, Number Plain::*... fields>
class TupleCaster {
 public:
  PYBIND11_TYPE_CASTER(Plain, pybind11::detail::const_name("tuple"));

  bool load(pybind11::handle source, bool convert) {
    pybind11::detail::make_caster<std::array<Number, sizeof...(fields)>> numbers;
    if (!numbers.load(source, convert)) return false;
    const std::array<Number, sizeof...(fields)>& found = numbers;
    std::size_t k = 0;
    ((value.*fields = found[k++]), ...);
    return true;
  }
  static pybind11::handle cast(const Plain& plain, pybind11::return_value_policy,
                               pybind11::handle) {
    return pybind11::make_tuple(plain.*fields...).release();
  }
};

/// Fields of a member as attributes of a class:
/// attributes(made, &Class::settings, "error", &Settings::error, "seed", &Settings::seed)
template <class PyClass, class Class, class Outer, class Value, class... Others>
void attributes(PyClass& made, Outer Class::*outer, const char* name, Value Outer::*field,
                Others... others) {
  made.def_property(
      name, [outer, field](const Class& self) { return (self.*outer).*field; },
      [outer, field](Class& self, const Value& value) { (self.*outer).*field = value; });
  if constexpr (sizeof...(others) > 0) attributes(made, outer, others...);
}

}  // namespace plenoflame::python

namespace pybind11::detail {

template <>
class type_caster<plenoflame::Vec3>
    : public plenoflame::python::TupleCaster<plenoflame::Vec3, double, &plenoflame::Vec3::x,
                                             &plenoflame::Vec3::y, &plenoflame::Vec3::z> {};
template <>
class type_caster<plenoflame::Box>
    : public plenoflame::python::TupleCaster<plenoflame::Box, plenoflame::Vec3,
                                             &plenoflame::Box::lower, &plenoflame::Box::upper> {};
template <>
class type_caster<plenoflame::Pixel>
    : public plenoflame::python::TupleCaster<plenoflame::Pixel, int, &plenoflame::Pixel::column,
                                             &plenoflame::Pixel::row> {};
template <>
class type_caster<plenoflame::LensIndex>
    : public plenoflame::python::TupleCaster<plenoflame::LensIndex, int, &plenoflame::LensIndex::q,
                                             &plenoflame::LensIndex::r> {};
template <>
class type_caster<plenoflame::PixelWindow>
    : public plenoflame::python::TupleCaster<
          plenoflame::PixelWindow, int, &plenoflame::PixelWindow::x, &plenoflame::PixelWindow::y,
          &plenoflame::PixelWindow::width, &plenoflame::PixelWindow::height> {};

}  // namespace pybind11::detail
