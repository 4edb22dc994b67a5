#include "voxels.h"

#include "plenoflame/base/error.h"

namespace plenoflame::python {

const VoxelArray* Voxels::find(const std::string& name) const {
  for (const VoxelArray& array : arrays)
    if (array.name == name) return &array;
  return nullptr;
}

FlameFields flame_of(const Voxels& voxels, const std::string& temperature,
                     const std::string& absorption, double ambient, const std::stop_token& stop) {
  const auto field = [&](const std::string& name, double background) {
    const VoxelArray* const array = voxels.find(name);
    if (!array) {
      std::string present;
      for (const VoxelArray& other : voxels.arrays)
        present += (present.empty() ? "" : ", ") + other.name;
      throw InputError("there is no array '" + name + "'; " +
                       (present.empty() ? "the data has none" : "the data has " + present));
    }
    VoxelField out = voxels_of(voxels.place, name, static_cast<float>(background),
                               [&](std::size_t n) { return array->values[n]; });
    if (stop.stop_requested()) throw Cancelled();
    check_flame_values(out);
    return out;
  };
  FlameFields flame{field(temperature, ambient), field(absorption, 0)};
  flame.temperature.name = "temperature";
  flame.absorption.name = "absorption";
  for (const LineGrid& line : line_grids()) {
    const std::string name(line.name);
    if (name != temperature && name != absorption && voxels.find(name))
      flame.lines.push_back(field(name, 0));
  }
  return flame;
}

}  // namespace plenoflame::python
