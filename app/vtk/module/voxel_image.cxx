#include "voxel_image.h"

#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "plenoflame/base/error.h"
#include "plenoflame/base/execution.h"

namespace plenoflame::pipeline {
namespace {

constexpr int kBrick = 8;

Vec3 column(const Mat3& m, int k) {
  const auto pick = [k](Vec3 v) { return k == 0 ? v.x : k == 1 ? v.y : v.z; };
  return {pick(m.rows[0]), pick(m.rows[1]), pick(m.rows[2])};
}

std::size_t size_of(const IndexBox& box, int k) {
  return static_cast<std::size_t>(box.upper[k] - box.lower[k] + 1);
}

vtkNew<vtkFloatArray> values_for(const IndexBox& box, const char* name, float value) {
  vtkNew<vtkFloatArray> array;
  array->SetName(name);
  array->SetNumberOfValues(
      static_cast<vtkIdType>(size_of(box, 0) * size_of(box, 1) * size_of(box, 2)));
  std::fill_n(array->GetPointer(0), array->GetNumberOfValues(), value);
  return array;
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

void place_image(const AffineTransform& transform, const IndexBox& box, bool local,
                 vtkImageData& image) {
  image.SetExtent(0, box.upper[0] - box.lower[0], 0, box.upper[1] - box.lower[1], 0,
                  box.upper[2] - box.lower[2]);
  std::array<double, 3> spacing{};
  vtkNew<vtkMatrix3x3> direction;
  for (int k = 0; k < 3; ++k) {
    const Vec3 c = column(transform.linear, k);
    spacing[static_cast<std::size_t>(k)] = length(c);
    const Vec3 unit = (1 / length(c)) * c;
    if (local) continue;
    direction->SetElement(0, k, unit.x);
    direction->SetElement(1, k, unit.y);
    direction->SetElement(2, k, unit.z);
  }
  const Vec3 origin =
      transform.point({static_cast<double>(box.lower[0]), static_cast<double>(box.lower[1]),
                       static_cast<double>(box.lower[2])});
  image.SetSpacing(spacing.data());
  image.SetDirectionMatrix(direction);
  if (local)
    image.SetOrigin(0, 0, 0);
  else
    image.SetOrigin(origin.x, origin.y, origin.z);
}

void local_to_world(const AffineTransform& transform, const IndexBox& box, vtkMatrix4x4& matrix) {
  matrix.Identity();
  const Vec3 origin =
      transform.point({static_cast<double>(box.lower[0]), static_cast<double>(box.lower[1]),
                       static_cast<double>(box.lower[2])});
  for (int k = 0; k < 3; ++k) {
    const Vec3 c = column(transform.linear, k);
    const Vec3 unit = (1 / length(c)) * c;
    matrix.SetElement(0, k, unit.x);
    matrix.SetElement(1, k, unit.y);
    matrix.SetElement(2, k, unit.z);
  }
  matrix.SetElement(0, 3, origin.x);
  matrix.SetElement(1, 3, origin.y);
  matrix.SetElement(2, 3, origin.z);
}

void add_values(const VoxelField& field, const IndexBox& box, const char* name,
                vtkImageData& image) {
  const vtkNew<vtkFloatArray> array = values_for(box, name, field.background);
  float* const out = array->GetPointer(0);
  const std::size_t nx = size_of(box, 0), ny = size_of(box, 1);
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
  image.GetPointData()->AddArray(array);
}

void add_interpolated(const VoxelField& field, const AffineTransform& transform,
                      const IndexBox& box, const char* name, vtkImageData& image) {
  const vtkNew<vtkFloatArray> array = values_for(box, name, field.background);
  float* const out = array->GetPointer(0);
  const Lookup lookup(field);
  const Mat3 to_index = inverse(field.index_to_world.linear);
  const std::size_t nx = size_of(box, 0), ny = size_of(box, 1);
  parallel_for({}, size_of(box, 2), [&](std::size_t k, int) {
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
  image.GetPointData()->AddArray(array);
}

VoxelField image_to_voxels(vtkImageData& image, const std::string& name, float background) {
  vtkDataArray* array = image.GetPointData()->GetArray(name.c_str());
  const bool cells = !array;
  if (cells) array = image.GetCellData()->GetArray(name.c_str());
  if (!array) {
    std::string present;
    for (vtkFieldData* data : {static_cast<vtkFieldData*>(image.GetPointData()),
                               static_cast<vtkFieldData*>(image.GetCellData())})
      for (int i = 0; i < data->GetNumberOfArrays(); ++i)
        if (const char* other = data->GetArrayName(i))
          present += (present.empty() ? "" : ", ") + std::string(other);
    throw InputError("there is no array '" + name + "'; " +
                     (present.empty() ? "the data has none" : "the data has " + present));
  }
  if (array->GetNumberOfComponents() != 1)
    throw InputError("the array '" + name + "' has " +
                     std::to_string(array->GetNumberOfComponents()) +
                     " components; a flame's values are single numbers");
  VoxelField field;
  field.name = name;
  field.background = background;
  // Cell values sit in the middles of the cells.
  const double shift = cells ? 0.5 : 0;
  std::array<int, 3> size{};
  const std::array<int, 6> extent{image.GetExtent()[0], image.GetExtent()[1], image.GetExtent()[2],
                                  image.GetExtent()[3], image.GetExtent()[4], image.GetExtent()[5]};
  for (std::size_t a = 0; a < 3; ++a) size[a] = extent[2 * a + 1] - extent[2 * a] + (cells ? 0 : 1);
  vtkMatrix3x3* const direction = image.GetDirectionMatrix();
  const double* const spacing = image.GetSpacing();
  for (int r = 0; r < 3; ++r) {
    const auto d = [&](int k) { return direction->GetElement(r, k) * spacing[k]; };
    field.index_to_world.linear.rows[static_cast<std::size_t>(r)] = {d(0), d(1), d(2)};
  }
  const double* const o = image.GetOrigin();
  field.index_to_world.translation =
      Vec3{o[0], o[1], o[2]} +
      field.index_to_world.linear * Vec3{extent[0] + shift, extent[2] + shift, extent[4] + shift};
  const auto nx = static_cast<vtkIdType>(size[0]), ny = static_cast<vtkIdType>(size[1]);
  std::vector<float> brick(kBrick * kBrick * kBrick);
  for (int bi = 0; bi < size[0]; bi += kBrick)
    for (int bj = 0; bj < size[1]; bj += kBrick)
      for (int bk = 0; bk < size[2]; bk += kBrick) {
        std::fill(brick.begin(), brick.end(), background);
        bool any = false;
        for (int k = bk; k < std::min(bk + kBrick, size[2]); ++k)
          for (int j = bj; j < std::min(bj + kBrick, size[1]); ++j)
            for (int i = bi; i < std::min(bi + kBrick, size[0]); ++i) {
              const auto value = static_cast<float>(array->GetTuple1((k * ny + j) * nx + i));
              brick[static_cast<std::size_t>(((i - bi) * kBrick + j - bj) * kBrick + k - bk)] =
                  value;
              any = any || !(value == background);
            }
        if (!any) continue;
        field.brick_origins.push_back({bi, bj, bk});
        field.values.insert(field.values.end(), brick.begin(), brick.end());
      }
  return field;
}

}  // namespace plenoflame::pipeline
