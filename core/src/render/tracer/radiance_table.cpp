#include "render/tracer/radiance_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/isa_dispatch.h"

namespace plenoflame {
namespace {

constexpr int kBlockCells = 8;
constexpr int kBlockNodes = (kBlockCells + 1) * (kBlockCells + 1);
constexpr double kStepsPerFeature = 1;   ///< table nodes per voxel
constexpr int kMostPupilNodes = 9;       ///< in each direction
constexpr double kMostFloats = 1 << 27;  ///< 512 MB if all blocks were filled
/// A linear table misses rise^2 / 8 of a function that begins like a square root, 0.2 % and 3 %.
/// Between the coarse voxels of a rough flame it misses more.
constexpr float kSmooth = 0.125F, kFair = 0.5F;
constexpr double kRaysPerNode = 2;     ///< fewer would not make up for filling the table
constexpr double kPupilMargin = 1.05;  ///< for aberrations of the pupil
constexpr int kStride = kBlockRays + 2 * kBlockSlack;

/// The bounding box, in the camera frame, of a box in the world.
Box camera_box(const Camera& camera, const Box& world) {
  const RigidTransform to_camera = camera.to_world().inverse();
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p = to_camera.point({(corner & 1) != 0 ? world.upper.x : world.lower.x,
                                    (corner & 2) != 0 ? world.upper.y : world.lower.y,
                                    (corner & 4) != 0 ? world.upper.z : world.lower.z});
    box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y),
                 std::min(box.lower.z, p.z)};
    box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y),
                 std::max(box.upper.z, p.z)};
  }
  return box;
}

struct TableKernels {
  decltype(&baseline::locate) locate;
  decltype(&baseline::look_up) look_up;
};

TableKernels kernels_for(Isa isa) {
  PLENOFLAME_DISPATCH(isa, return {kernels::locate, kernels::look_up};)
}

}  // namespace

std::unique_ptr<RadianceTable> RadianceTable::make(const Camera& camera, const Medium& medium,
                                                   Vec3 anchor, const MediumOptions& options) {
  if (!medium.is_costly() || medium.bounds().empty()) return nullptr;
  const FirstOrder& lens = camera.lens_first_order();
  const double pupil_radius = 0.5 * kPupilMargin * lens.entrance_pupil_diameter;
  const Box box = camera_box(camera, medium.bounds());
  const Vec3 middle = camera.to_world().inverse().point(anchor);
  const double to_pupil = -lens.entrance_pupil - middle.z;
  const double half_depth = std::max(box.upper.z - middle.z, middle.z - box.lower.z);
  if (!(pupil_radius > 0) || !std::isfinite(pupil_radius) || !std::isfinite(to_pupil) ||
      !(-to_pupil > 1.5 * half_depth))
    return nullptr;
  // Between two nodes of the pupil, the medium's near and far side shift by at most one feature.
  const double feature = medium.feature_size();
  const double pupil_step = feature * -to_pupil / half_depth;
  const double cells_u = std::max(2.0, std::ceil(2 * pupil_radius / pupil_step));
  if (!(cells_u < kMostPupilNodes)) return nullptr;
  // Lines through the box cross the middle plane within this distance.
  const double reach = half_depth / (-to_pupil - half_depth);
  const auto margin = [&](double extent) {
    return reach * (pupil_radius + std::fabs(extent)) + feature;
  };
  const double left = box.lower.x - margin(box.lower.x), right = box.upper.x + margin(box.upper.x);
  const double top = box.lower.y - margin(box.lower.y), bottom = box.upper.y + margin(box.upper.y);
  const double step = feature / kStepsPerFeature;
  const auto blocks = [&](double extent) { return std::ceil(extent / (step * kBlockCells)); };
  const double blocks_a = blocks(right - left), blocks_b = blocks(bottom - top);
  const double side = cells_u + 1;
  if (!(blocks_a * blocks_b * kBlockNodes * side * side * medium.channel_count() < kMostFloats))
    return nullptr;

  KernelRadianceTable kernel{};
  const auto& rows = camera.to_world().rotation.rows;
  for (int i = 0; i < 3; ++i) {
    const Vec3 row = rows[static_cast<std::size_t>(i)];
    kernel.rotation[3 * i] = static_cast<float>(row.x);
    kernel.rotation[3 * i + 1] = static_cast<float>(row.y);
    kernel.rotation[3 * i + 2] = static_cast<float>(row.z);
  }
  kernel.a0 = static_cast<float>(left - middle.x);
  kernel.b0 = static_cast<float>(top - middle.y);
  kernel.per_step = static_cast<float>(1 / step);
  kernel.u0 = static_cast<float>(-pupil_radius - middle.x);
  kernel.v0 = static_cast<float>(-pupil_radius - middle.y);
  kernel.per_pupil_step = static_cast<float>(cells_u / (2 * pupil_radius));
  kernel.to_pupil = static_cast<float>(to_pupil);
  kernel.cells_a = static_cast<int>(blocks_a) * kBlockCells;
  kernel.cells_b = static_cast<int>(blocks_b) * kBlockCells;
  kernel.cells_u = static_cast<int>(cells_u);
  kernel.blocks_a = static_cast<int>(blocks_a);
  kernel.blank = static_cast<int>(blocks_a * blocks_b);
  kernel.side = kernel.cells_u + 1;
  kernel.channels = medium.channel_count();
  kernel.channel_stride = kBlockNodes * kernel.side * kernel.side;
  kernel.block_stride = kernel.channels * kernel.channel_stride;
  kernel.smooth = kSmooth;
  kernel.fair = kFair;
  std::unique_ptr<RadianceTable> table(new RadianceTable(medium, anchor, options, kernel));
  const SensorSpec& sensor = camera.spec().sensor;
  const Vec2 size = sensor.size();
  const double image_scale = lens.focal_length / -to_pupil;
  const double pixels = std::min((right - left) * image_scale, size.x) *
                        std::min((bottom - top) * image_scale, size.y) /
                        (sensor.pixel().x * sensor.pixel().y);
  table->least_samples_ =
      kRaysPerNode * blocks_a * blocks_b * kernel.channel_stride / std::max(pixels, 1.0);
  return table;
}

RadianceTable::RadianceTable(const Medium& medium, Vec3 anchor, const MediumOptions& options,
                             const KernelRadianceTable& kernel)
    : medium_(medium),
      anchor_(anchor),
      options_(options),
      kernel_(kernel),
      nodes_(new float[static_cast<std::size_t>(kernel.blank + 1) *
                       static_cast<std::size_t>(kernel.block_stride)]),
      filled_(new std::atomic<bool>[static_cast<std::size_t>(kernel.blank)]),
      once_(new std::once_flag[static_cast<std::size_t>(kernel.blank)]) {
  for (int b = 0; b < kernel.blank; ++b) filled_[static_cast<std::size_t>(b)] = false;
  std::fill_n(nodes_.get() + static_cast<std::ptrdiff_t>(kernel.blank) * kernel.block_stride,
              kernel.block_stride, 0.F);
}

void RadianceTable::need(int block, TableCounters& counters, MediumCounters& medium) {
  const auto b = static_cast<std::size_t>(block);
  if (filled_[b].load(std::memory_order_acquire)) return;
  std::call_once(once_[b], [&] {
    fill(block, counters, medium);
    filled_[b].store(true, std::memory_order_release);
  });
}

void RadianceTable::fill(int block, TableCounters& counters, MediumCounters& medium) {
  struct alignas(64) Arrays {
    float value[7][kMaxBatch];
  };
  const auto arrays = std::make_unique<Arrays>();
  auto& v = arrays->value;
  const auto channels = static_cast<std::size_t>(kernel_.channels);
  std::vector<float> radiance(channels * kMaxBatch);
  const KernelRadianceTable& k = kernel_;
  float* const out =
      nodes_.get() + static_cast<std::size_t>(block) * static_cast<std::size_t>(k.block_stride);
  const int first_a = block % k.blocks_a * kBlockCells, first_b = block / k.blocks_a * kBlockCells;
  for (int first = 0; first < k.channel_stride; first += kMaxBatch) {
    const int count = std::min(kMaxBatch, k.channel_stride - first);
    const int padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
    for (int i = 0; i < padded; ++i) {
      const int node = first + std::min(i, count - 1);
      const int u = node % k.side, w = node / k.side % k.side, place = node / (k.side * k.side);
      const int a = first_a + place % (kBlockCells + 1), b = first_b + place / (kBlockCells + 1);
      const double px = static_cast<double>(k.a0) + a / static_cast<double>(k.per_step);
      const double py = static_cast<double>(k.b0) + b / static_cast<double>(k.per_step);
      const double qx = static_cast<double>(k.u0) + u / static_cast<double>(k.per_pupil_step);
      const double qy = static_cast<double>(k.v0) + w / static_cast<double>(k.per_pupil_step);
      const Vec3 d = normalize({px - qx, py - qy, -static_cast<double>(k.to_pupil)});
      const auto world = [&](int row, Vec3 c) {
        return static_cast<float>(static_cast<double>(k.rotation[3 * row]) * c.x +
                                  static_cast<double>(k.rotation[3 * row + 1]) * c.y +
                                  static_cast<double>(k.rotation[3 * row + 2]) * c.z);
      };
      for (int row = 0; row < 3; ++row) {
        v[row][i] = world(row, {px, py, 0});
        v[3 + row][i] = world(row, d);
      }
    }
    RayBatch<float> rays;
    rays.size = padded;
    rays.anchor = anchor_;
    rays.x = v[0], rays.y = v[1], rays.z = v[2];
    rays.dx = v[3], rays.dy = v[4], rays.dz = v[5];
    medium_.integrate(rays, options_, {radiance.data(), kMaxBatch, v[6]}, medium);
    for (std::size_t c = 0; c < channels; ++c)
      std::copy_n(radiance.data() + c * kMaxBatch, count,
                  out + c * static_cast<std::size_t>(k.channel_stride) + first);
    counters.nodes += count;
  }
}

RadianceTable::Worker::Worker(RadianceTable& table)
    : table_(table),
      memory_(static_cast<std::size_t>(12 + table.kernel_.channels) * kStride + 16),
      whole_(3 * static_cast<std::size_t>(kStride)) {
  float* base = memory_.data();
  while (reinterpret_cast<std::uintptr_t>(base) % 64 != 0) ++base;
  const auto next = [&] {
    float* const array = base;
    base += kStride;
    return array;
  };
  for (float*& array : packed_) array = next();
  places_.a = next(), places_.b = next(), places_.u = next(), places_.v = next();
  transmittance_ = next();
  exact_ = base;
  places_.block = whole_.data();
  places_.corner = whole_.data() + kStride;
  quality_ = whole_.data() + 2 * static_cast<std::ptrdiff_t>(kStride);
  chosen_.reserve(kStride);
}

void RadianceTable::Worker::integrate(const Request& request, MediumCounters& medium) {
  const KernelBlock<float>& r = *request.rays;
  const TableKernels kernels = kernels_for(table_.options_.isa);
  kernels.locate(table_.kernel_, request.count, r.x, r.y, r.z, r.dx, r.dy, r.dz, r.code, places_);
  int last = -1;
  for (int i = 0; i < request.count; ++i) {
    if (places_.block[i] == last || places_.block[i] < 0) continue;
    last = places_.block[i];
    table_.need(last, counters_, medium);
  }
  kernels.look_up(table_.kernel_, table_.nodes_.get(), request.count, places_, request.radiance,
                  request.stride, quality_);
  choose(request);
  if (!chosen_.empty()) integrate_chosen(request, medium);
}

void RadianceTable::Worker::choose(const Request& request) {
  chosen_.clear();
  for (int i = 0; i < request.count; ++i) {
    if (request.rays->code[i] != 0) continue;  // weight 0
    const int quality = quality_[i];
    if (quality == 0) {
      if (places_.block[i] >= 0) counters_.rough += 1;  // other rays miss the flame
      chosen_.push_back(i);
    } else if ((quality == 2 ? request.smooth_factor : request.fair_factor)[i] > 0) {
      counters_.corrected += 1;
      chosen_.push_back(i);
    } else {
      counters_.looked_up += 1;
    }
  }
}

void RadianceTable::Worker::integrate_chosen(const Request& request, MediumCounters& medium) {
  const KernelBlock<float>& r = *request.rays;
  const float* const from[6] = {r.x, r.y, r.z, r.dx, r.dy, r.dz};
  const int count = static_cast<int>(chosen_.size());
  const int padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
  for (int c = 0; c < 6; ++c)
    for (int i = 0; i < padded; ++i)
      packed_[c][i] = from[c][chosen_[static_cast<std::size_t>(std::min(i, count - 1))]];
  RayBatch<float> rays;
  rays.size = padded;
  rays.anchor = table_.anchor_;
  rays.x = packed_[0], rays.y = packed_[1], rays.z = packed_[2];
  rays.dx = packed_[3], rays.dy = packed_[4], rays.dz = packed_[5];
  table_.medium_.integrate(rays, table_.options_, {exact_, kStride, transmittance_}, medium);
  for (int c = 0; c < table_.kernel_.channels; ++c) {
    float* const out = request.radiance + static_cast<std::ptrdiff_t>(c) * request.stride;
    const float* const exact = exact_ + static_cast<std::ptrdiff_t>(c) * kStride;
    for (int k = 0; k < count; ++k) {
      const int i = chosen_[static_cast<std::size_t>(k)];
      float value = exact[k];
      if (quality_[i] != 0)
        value = out[i] + (quality_[i] == 2 ? request.smooth_factor : request.fair_factor)[i] *
                             (value - out[i]);
      out[i] = value;
    }
  }
}

}  // namespace plenoflame
