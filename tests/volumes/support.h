#pragma once
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/media/voxel_medium.h"
#include "support/temporary_folder.h"

namespace plenoflame::test {

/// Random access to a field; knows nothing of how the library reads it.
class FieldSampler {
 public:
  explicit FieldSampler(const VoxelField& field) : field_(field) {
    for (std::size_t b = 0; b < field.brick_origins.size(); ++b)
      bricks_[field.brick_origins[b]] = b;
  }
  float at(int i, int j, int k) const {
    const auto base = [](int x) { return x >= 0 ? x / 8 * 8 : -((-x + 7) / 8 * 8); };
    const std::array<int, 3> origin{base(i), base(j), base(k)};
    const auto brick = bricks_.find(origin);
    if (brick == bricks_.end()) return field_.background;
    return field_.values[brick->second * 512 +
                         static_cast<std::size_t>(((i - origin[0]) * 8 + j - origin[1]) * 8 + k -
                                                  origin[2])];
  }
  /// Trilinear interpolation at index coordinates.
  double interpolate(Vec3 p) const {
    const double x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
      const double weight = (a != 0 ? p.x - x : 1 - p.x + x) * (b != 0 ? p.y - y : 1 - p.y + y) *
                            (c != 0 ? p.z - z : 1 - p.z + z);
      sum += weight * static_cast<double>(at(static_cast<int>(x) + a, static_cast<int>(y) + b,
                                             static_cast<int>(z) + c));
    }
    return sum;
  }

 private:
  const VoxelField& field_;
  std::map<std::array<int, 3>, std::size_t> bricks_;
};

inline std::vector<char> slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void spill(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The message that action throws as Exception; fails the test when it does not.
template <class Exception, class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no exception";
  return {};
}

inline ::testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\"" << part << "\" is not in \"" << text << "\"";
}

}  // namespace plenoflame::test
