#include "voxel_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kBrick = 8;

Vec3 column(const Mat3& m, int k) {
  const auto pick = [k](Vec3 v) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
  return {pick(m.rows[0]), pick(m.rows[1]), pick(m.rows[2])};
}

Vec3 whole(const std::array<int, 3>& index) {
  return {static_cast<double>(index[0]), static_cast<double>(index[1]),
          static_cast<double>(index[2])};
}

VoxelArray array_for(const IndexBox& box, const std::string& name, float value) {
  const auto [nx, ny, nz] = box.size();
  return {name, std::vector<float>(nx * ny * nz, value)};
}

/// Values of a sparse field at whole index coordinates.
class Lookup {
 public:
  explicit Lookup(const VoxelField& field) : field_(field) {
    for (std::size_t b = 0; b < field.brick_origins.size(); ++b)
      bricks_[key(field.brick_origins[b])] = field.values.data() + b * kBrick * kBrick * kBrick;
  }
  float at(int i, int j, int k) const {
    const auto found = bricks_.find(key({i & ~7, j & ~7, k & ~7}));
    return found == bricks_.end() ? field_.background
                                  : found->second[((i & 7) * kBrick + (j & 7)) * kBrick + (k & 7)];
  }

 private:
  static std::uint64_t key(std::array<int, 3> origin) {
    std::uint64_t out = 0;
    for (const int o : origin) out = out << 21 | (static_cast<std::uint32_t>(o) >> 3 & 0x1fffffu);
    return out;
  }
  const VoxelField& field_;
  std::unordered_map<std::uint64_t, const float*> bricks_;
};

Mat3 inverse(const Mat3& m) {
  const Vec3 a = m.rows[0], b = m.rows[1], c = m.rows[2];
  const Vec3 x = cross(b, c), y = cross(c, a), z = cross(a, b);
  const double scale = 1 / dot(a, x);
  return transpose(Mat3{{scale * x, scale * y, scale * z}});
}

}  // namespace

void IndexBox::add(const IndexBox& other) {
  if (other.empty()) return;
  if (empty()) {
    *this = other;
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    lower[k] = std::min(lower[k], other.lower[k]);
    upper[k] = std::max(upper[k], other.upper[k]);
  }
}

std::array<std::size_t, 3> IndexBox::size() const {
  const auto along = [&](std::size_t k) {
    return empty() ? std::size_t{0} : static_cast<std::size_t>(upper[k] - lower[k] + 1);
  };
  return {along(0), along(1), along(2)};
}

IndexBox stored_box(const VoxelField& field) {
  IndexBox all;
  for (std::size_t b = 0; b < field.brick_origins.size(); ++b) {
    const float* const values = field.values.data() + b * kBrick * kBrick * kBrick;
    IndexBox box{{kBrick, kBrick, kBrick}, {-1, -1, -1}};
    for (int n = 0; n < kBrick * kBrick * kBrick; ++n) {
      if (values[n] == field.background) continue;
      const std::array<int, 3> at{n / (kBrick * kBrick), n / kBrick % kBrick, n % kBrick};
      for (std::size_t k = 0; k < 3; ++k) {
        box.lower[k] = std::min(box.lower[k], at[k]);
        box.upper[k] = std::max(box.upper[k], at[k]);
      }
    }
    if (box.empty()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] += field.brick_origins[b][k];
      box.upper[k] += field.brick_origins[b][k];
    }
    all.add(box);
  }
  return all;
}

VoxelPlace voxel_place(const AffineTransform& transform, const IndexBox& box) {
  VoxelPlace place;
  place.size = box.size();
  place.origin = transform.point(whole(box.lower));
  for (int k = 0; k < 3; ++k) {
    const Vec3 c = column(transform.linear, k);
    place.spacing[static_cast<std::size_t>(k)] = length(c);
    place.direction[static_cast<std::size_t>(k)] = (1 / length(c)) * c;
  }
  return place;
}

VoxelArray voxel_values(const VoxelField& field, const IndexBox& box) {
  VoxelArray array = array_for(box, field.name, field.background);
  float* const out = array.values.data();
  const std::size_t nx = box.size()[0], ny = box.size()[1];
  parallel_for({}, field.brick_origins.size(), [&](std::size_t b, int) {
    const std::array<int, 3> origin = field.brick_origins[b];
    const float* const values = field.values.data() + b * kBrick * kBrick * kBrick;
    std::array<int, 3> first{}, last{};
    for (std::size_t a = 0; a < 3; ++a) {
      first[a] = std::max(origin[a], box.lower[a]);
      last[a] = std::min(origin[a] + kBrick - 1, box.upper[a]);
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j) {
        float* const row = out + (static_cast<std::size_t>(k - box.lower[2]) * ny +
                                  static_cast<std::size_t>(j - box.lower[1])) *
                                     nx;
        for (int i = first[0]; i <= last[0]; ++i)
          row[i - box.lower[0]] =
              values[((i - origin[0]) * kBrick + j - origin[1]) * kBrick + k - origin[2]];
      }
  });
  return array;
}

VoxelArray interpolated_values(const VoxelField& field, const AffineTransform& transform,
                               const IndexBox& box) {
  VoxelArray array = array_for(box, field.name, field.background);
  float* const out = array.values.data();
  const Lookup lookup(field);
  const Mat3 to_index = inverse(field.index_to_world.linear);
  const std::size_t nx = box.size()[0], ny = box.size()[1];
  parallel_for({}, box.size()[2], [&](std::size_t k, int) {
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i) {
        const Vec3 world = transform.point({static_cast<double>(i) + box.lower[0],
                                            static_cast<double>(j) + box.lower[1],
                                            static_cast<double>(k) + box.lower[2]});
        const Vec3 at = to_index * (world - field.index_to_world.translation);
        const std::array<double, 3> low{std::floor(at.x), std::floor(at.y), std::floor(at.z)};
        const std::array<double, 3> part{at.x - low[0], at.y - low[1], at.z - low[2]};
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
          double weight = 1;
          std::array<int, 3> index{};
          for (std::size_t a = 0; a < 3; ++a) {
            const int up = corner >> a & 1;
            weight *= up ? part[a] : 1 - part[a];
            index[a] = static_cast<int>(low[a]) + up;
          }
          if (weight > 0)
            sum += weight * static_cast<double>(lookup.at(index[0], index[1], index[2]));
        }
        out[(k * ny + j) * nx + i] = static_cast<float>(sum);
      }
  });
  return array;
}

LatticeFields on_one_lattice(const std::vector<VoxelField>& fields, const std::string& file,
                             const std::string& alone, const Execution& execution) {
  LatticeFields found;
  found.transform = fields.front().index_to_world;
  const auto same = [&](const VoxelField& field) {
    return field.index_to_world.linear == found.transform.linear &&
           field.index_to_world.translation == found.transform.translation;
  };
  for (const VoxelField& field : fields)
    if (same(field)) found.box.add(stored_box(field));
  if (found.box.empty())
    throw InputError((file.empty() ? "the flame is empty" : "'" + file + "'") +
                     ": every voxel has the background's value");
  for (const VoxelField& field : fields) {
    if (same(field)) {
      found.arrays.push_back(voxel_values(field, found.box));
      continue;
    }
    execution.warn("'" + file + "': " + field.name +
                   " has a lattice of its own and was interpolated; read it alone (" + alone +
                   ") to keep it");
    found.arrays.push_back(interpolated_values(field, found.transform, found.box));
  }
  return found;
}

VoxelField voxels_of(const VoxelPlace& place, const std::string& name, float background,
                     const std::function<float(std::size_t n)>& value) {
  VoxelField field;
  field.name = name;
  field.background = background;
  const auto component = [&](auto pick) {
    return Vec3{pick(place.direction[0]) * place.spacing[0],
                pick(place.direction[1]) * place.spacing[1],
                pick(place.direction[2]) * place.spacing[2]};
  };
  field.index_to_world.linear.rows = {component([](Vec3 v) { return v.x; }),
                                      component([](Vec3 v) { return v.y; }),
                                      component([](Vec3 v) { return v.z; })};
  field.index_to_world.translation = place.origin;
  const std::size_t nx = place.size[0], ny = place.size[1];
  const std::array<int, 3> size{static_cast<int>(place.size[0]), static_cast<int>(place.size[1]),
                                static_cast<int>(place.size[2])};
  std::vector<float> brick(kBrick * kBrick * kBrick);
  for (int bi = 0; bi < size[0]; bi += kBrick)
    for (int bj = 0; bj < size[1]; bj += kBrick)
      for (int bk = 0; bk < size[2]; bk += kBrick) {
        std::fill(brick.begin(), brick.end(), background);
        bool any = false;
        for (int k = bk; k < std::min(bk + kBrick, size[2]); ++k)
          for (int j = bj; j < std::min(bj + kBrick, size[1]); ++j)
            for (int i = bi; i < std::min(bi + kBrick, size[0]); ++i) {
              const float own =
                  value((static_cast<std::size_t>(k) * ny + static_cast<std::size_t>(j)) * nx +
                        static_cast<std::size_t>(i));
              brick[static_cast<std::size_t>(((i - bi) * kBrick + j - bj) * kBrick + k - bk)] = own;
              any = any || !(own == background);
            }
        if (!any) continue;
        field.brick_origins.push_back({bi, bj, bk});
        field.values.insert(field.values.end(), brick.begin(), brick.end());
      }
  return field;
}

void check_flame_values(const VoxelField& field) {
  for (std::size_t n = 0; n < field.values.size(); ++n) {
    if (std::isfinite(field.values[n]) && field.values[n] >= 0) continue;
    const std::array<int, 3> origin = field.brick_origins[n / 512];
    const int at = static_cast<int>(n % 512);
    throw InputError(
        "the array '" + field.name + "' is " + std::to_string(field.values[n]) + " at (" +
        std::to_string(origin[0] + at / 64) + ", " + std::to_string(origin[1] + at / 8 % 8) + ", " +
        std::to_string(origin[2] + at % 8) + "); values must be finite and not negative");
  }
}

}  // namespace plenoflame
