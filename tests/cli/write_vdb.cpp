// Writes a .vdb file for the tests of what the command says about wrong ones.
//
//   write_vdb FILE [--frustum] GRID ...
//
// GRID is NAME:TYPE:UNIT:BACKGROUND:VALUE[:VALUE2]: a grid of TYPE float, double or vec3s with a
// box of 10^3 voxels of 1 mm around (0, 0, 0) that hold VALUE, but voxel (1, 2, -3) VALUE2.
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

std::vector<std::string> fields_of(const std::string& text) {
  std::vector<std::string> fields;
  std::istringstream stream(text);
  for (std::string field; std::getline(stream, field, ':');) fields.push_back(field);
  return fields;
}

template <class Grid>
openvdb::GridBase::Ptr box(typename Grid::ValueType background, typename Grid::ValueType value,
                           typename Grid::ValueType odd) {
  const auto grid = Grid::create(background);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-5), openvdb::Coord(4)), value);
  grid->tree().setValue(openvdb::Coord(1, 2, -3), odd);
  return grid;
}

openvdb::GridBase::Ptr grid_of(const std::vector<std::string>& fields) {
  const double background = std::strtod(fields.at(3).c_str(), nullptr);
  const double value = std::strtod(fields.at(4).c_str(), nullptr);
  const double odd = fields.size() > 5 ? std::strtod(fields[5].c_str(), nullptr) : value;
  if (fields.at(1) == "double") return box<openvdb::DoubleGrid>(background, value, odd);
  const auto f = [](double x) { return static_cast<float>(x); };
  if (fields.at(1) == "vec3s")
    return box<openvdb::Vec3SGrid>(openvdb::Vec3s(f(background)), openvdb::Vec3s(f(value)),
                                   openvdb::Vec3s(f(odd)));
  return box<openvdb::FloatGrid>(f(background), f(value), f(odd));
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  openvdb::math::Transform::Ptr transform = openvdb::math::Transform::createLinearTransform(1e-3);
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--frustum") {
      transform = openvdb::math::Transform::createFrustumTransform(
          openvdb::BBoxd(openvdb::Vec3d(-5), openvdb::Vec3d(5)), 0.5, 1.0, 1e-3);
      continue;
    }
    const std::vector<std::string> fields = fields_of(argument);
    const auto grid = grid_of(fields);
    grid->setName(fields[0]);
    grid->setTransform(transform->copy());
    if (!fields[2].empty()) grid->insertMeta("unit", openvdb::StringMetadata(fields[2]));
    grids.push_back(grid);
  }
  openvdb::io::File file(argv[1]);
  file.write(grids);
  file.close();
  return 0;
}
