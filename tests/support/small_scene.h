#pragma once
#include "plenoflame/scene/scene.h"

/// Small scenes of every kind of camera, for tests that compare whole renderings: a layered flame
/// of 24 mm height in front of a camera of 60 x 60 pixels.
namespace plenoflame::test {

inline MainLensSpec singlet() {
  MainLensSpec lens;
  lens.surfaces = {
      {0.3, 0.02426, 1.5, 0.12, false}, {-0.3, 0, 1, 0.12, false}, {kInfinity, 0, 1, 0.1, true}};
  return lens;
}

inline MainLensSpec ideal_singlet() {
  MainLensSpec lens = singlet();
  lens.model = LensModel::ideal;
  return lens;
}

/// Microlenses of 1 mm: the paper's, ten times as large.
inline ArraySpec large_array(Lattice lattice, LensModel model) {
  ArraySpec array;
  array.present = true;
  array.lattice = lattice;
  array.model = model;
  array.pitch = 1e-3;
  array.diameter = 1e-3;
  array.thickness = 0.5e-3;
  array.sensor_distance = 2.534e-3;
  array.types = {{"type1", 2.25e-3, 2.25e-3, 1.50, 0}};
  if (lattice == Lattice::hexagonal) {
    array.types.push_back({"type2", 2.25e-3, 2.25e-3, 1.59, 0});
    array.types.push_back({"type3", 2.25e-3, 2.25e-3, 1.69, 0});
    array.offset = {0.2e-3, 0.1e-3};
    array.rotation = 0.05;
  }
  return array;
}

inline FlameSpec small_flame() {
  FlameSpec flame;
  flame.name = "small";
  flame.position = {1, 0.001, -0.012};
  flame.layers = {{"core", {0, 0, 0.006}, {0.002, 0.002, 0.005}, 1200, 20},
                  {"luminous", {0.001, 0, 0.009}, {0.004, 0.004, 0.009}, 1650, 120},
                  {"outer", {0, 0, 0.012}, {0.006, 0.006, 0.012}, 1900, 8}};
  return flame;
}

inline Scene small_scene(const MainLensSpec& lens, const ArraySpec& array) {
  Scene scene;
  scene.camera.lens = lens;
  scene.camera.array = array;
  scene.camera.sensor = {60, 60, 0.2e-3};
  scene.camera.focus.object_distance = 1;
  scene.camera.focus.conjugate = array.present ? "array" : "sensor";
  scene.flames = {small_flame()};
  return scene;
}

}  // namespace plenoflame::test
