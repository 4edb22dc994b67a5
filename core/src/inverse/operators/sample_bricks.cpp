#include "inverse/operators/sample_bricks.h"

#include <algorithm>

namespace plenoflame {

VoxelField sample_bricks(const std::array<int, 3>& count, const AffineTransform& index_to_world,
                         const std::string& name,
                         const std::function<double(int, int, int)>& sample) {
  VoxelField field;
  field.name = name;
  field.index_to_world = index_to_world;
  std::vector<float> values(512);
  for (int bi = 0; bi < count[0]; bi += 8)
    for (int bj = 0; bj < count[1]; bj += 8)
      for (int bk = 0; bk < count[2]; bk += 8) {
        for (int v = 0; v < 512; ++v) {
          const int i = bi + v / 64, j = bj + v / 8 % 8, k = bk + v % 8;
          const bool inside = i < count[0] && j < count[1] && k < count[2];
          values[static_cast<std::size_t>(v)] = inside ? static_cast<float>(sample(i, j, k)) : 0.0F;
        }
        if (std::all_of(values.begin(), values.end(), [](float v) { return v == 0; })) continue;
        field.brick_origins.push_back({bi, bj, bk});
        field.values.insert(field.values.end(), values.begin(), values.end());
      }
  return field;
}

}  // namespace plenoflame
