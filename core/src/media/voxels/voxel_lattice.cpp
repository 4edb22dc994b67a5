#include "media/voxels/voxel_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame::voxel {
namespace {

// Blocks of the table: 64 million, 256 MB.
constexpr double kMostBlocks = 1 << 26;

bool is_plain(int word) {
  return static_cast<unsigned>(word) == 0x11111111u * kCellStep;
}

}  // namespace

Lattice::Lattice(const FieldReader& primary, VoxelInterpolation interpolation,
                 const FlamePlacement& placement)
    : index_to_flame_(primary.field().index_to_world),
      field_(primary.field().name),
      one_value_per_cell_(interpolation == VoxelInterpolation::constant) {
  set_placement(placement);
}

void Lattice::set_placement(const FlamePlacement& placement) {
  AffineTransform scaled = index_to_flame_;
  for (Vec3& row : scaled.linear.rows) row = placement.scale * row;
  scaled.translation = placement.scale * scaled.translation;
  index_to_world_ = {placement.frame.rotation * scaled.linear,
                     placement.frame.point(scaled.translation)};
  // A voxel reaches half a spacing to each side of its sample.
  if (one_value_per_cell_) index_to_world_.translation = index_to_world_.point({-0.5, -0.5, -0.5});
  world_to_index_ = inverse(index_to_world_, field_);
}

Lattice Lattice::placed(const FlamePlacement& placement) const {
  Lattice moved = *this;
  moved.set_placement(placement);
  return moved;
}

namespace {

// Adds the bricks of cells that are touched by samples other than `nothing`. Sample i + shift of
// the field belongs to sample i of the lattice. Leaves the bricks in ascending order.
void add_touched(const FieldReader& reader, Index shift, float nothing, bool one_value_per_cell,
                 std::vector<Index>& bricks) {
  const VoxelField& field = reader.field();
  const int reach = one_value_per_cell ? 0 : 1;  // a sample touches the cells below it, too
  for (std::size_t b = 0; b < field.brick_origins.size(); ++b) {
    // The samples of a brick reach into at most 2^3 bricks of cells; a bit for each of these.
    Index first;
    int reached[3][8];  // by a sample's place along each axis
    for (int a = 0; a < 3; ++a) {
      const int lowest = field.brick_origins[b][a] - shift[a];
      first[a] = floor_div(lowest - reach, 8);
      for (int i = 0; i < 8; ++i) {
        reached[a][i] = 0;
        for (int n = 0; n < 8; ++n) {
          const int brick = first[a] + (n >> a & 1);
          const bool touches =
              brick == floor_div(lowest + i - reach, 8) || brick == floor_div(lowest + i, 8);
          reached[a][i] |= touches ? 1 << n : 0;
        }
      }
    }
    int touched = 0;
    for (int v = 0; v < 512; ++v)
      if (field.values[b * 512 + static_cast<std::size_t>(v)] != nothing)
        touched |= reached[0][v / 64] & reached[1][v / 8 % 8] & reached[2][v % 8];
    for (int n = 0; n < 8; ++n)
      if (touched >> n & 1)
        bricks.push_back({first[0] + (n & 1), first[1] + (n >> 1 & 1), first[2] + (n >> 2)});
  }
  for (const Index& brick : bricks)
    for (const int at : brick)
      if (std::abs(at) > kFarthestBrick)
        throw InputError(fmt::format("field '{}' lies too far from the absorption", field.name));
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

// The 9^3 samples from `low`: at most 2^3 bricks, found once.
class Window {
 public:
  Window(const FieldReader* reader, Index low) {
    if (!reader) return;
    background_ = reader->field().background;
    Index first;
    for (int a = 0; a < 3; ++a) {
      first[a] = floor_div(low[a], 8);
      low_[a] = low[a] - 8 * first[a];
    }
    for (int n = 0; n < 8; ++n)
      bricks_[n] =
          reader->brick({first[0] + (n >> 2), first[1] + (n >> 1 & 1), first[2] + (n & 1)});
  }
  float at(int i, int j, int k) const {
    const int x = low_[0] + i, y = low_[1] + j, z = low_[2] + k;
    const float* brick = bricks_[(x >> 3) << 2 | (y >> 3) << 1 | z >> 3];
    return brick ? brick[((x & 7) * 8 + (y & 7)) * 8 + (z & 7)] : background_;
  }

 private:
  Index low_{};
  const float* bricks_[8] = {};
  float background_ = 0;
};

}  // namespace

Lattice Lattice::of_absorption(const FieldReader& absorption, const ExtraField& temperature,
                               const std::vector<ExtraField>& extras,
                               VoxelInterpolation interpolation, const StepPlanner& steps,
                               const FlamePlacement& placement) {
  Lattice lattice(absorption, interpolation, placement);
  if (temperature.field) lattice.background_temperature_ = temperature.field->field().background;
  std::vector<Index> bricks;
  add_touched(absorption, {}, 0, lattice.one_value_per_cell_, bricks);
  for (const ExtraField& extra : extras)
    if (extra.emits) add_touched(*extra.field, extra.shift, 0, lattice.one_value_per_cell_, bricks);
  lattice.store(bricks, &absorption, temperature.field, temperature.shift, extras, &steps);
  return lattice;
}

Lattice Lattice::of_temperature(const FieldReader& temperature, VoxelInterpolation interpolation,
                                const FlamePlacement& placement) {
  Lattice lattice(temperature, interpolation, placement);
  lattice.background_temperature_ = temperature.field().background;
  std::vector<Index> bricks;
  add_touched(temperature, {}, temperature.field().background, lattice.one_value_per_cell_, bricks);
  lattice.store(bricks, nullptr, &temperature, {}, {}, nullptr);
  return lattice;
}

void Lattice::store(const std::vector<Index>& bricks, const FieldReader* absorption,
                    const FieldReader* temperature, Index shift,
                    const std::vector<ExtraField>& extras, const StepPlanner* steps) {
  extra_fields_ = static_cast<int>(extras.size());
  temperature_range_ = {background_temperature_, background_temperature_};
  if (bricks.empty()) return;
  const FieldReader& primary = absorption ? *absorption : *temperature;
  Index low = bricks[0], high = bricks[0];
  for (const Index& b : bricks)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], b[a]);
      high[a] = std::max(high[a], b[a]);
    }
  origin_ = low;
  double block_count = 1;
  for (int a = 0; a < 3; ++a) {
    bricks_[a] = high[a] - low[a] + 1;
    blocks_[a] = (bricks_[a] + 7) / 8;
    block_count *= blocks_[a];
  }
  if (block_count > kMostBlocks)
    throw InputError(fmt::format(
        "field '{}': its values are spread over {} x {} x {} voxels; remove stray voxels",
        primary.field().name, 8 * bricks_[0], 8 * bricks_[1], 8 * bricks_[2]));
  top_.assign(static_cast<std::size_t>(block_count), -1);

  Index tight_low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
                  std::numeric_limits<int>::max()};
  Index tight_high{std::numeric_limits<int>::min(), std::numeric_limits<int>::min(),
                   std::numeric_limits<int>::min()};
  std::map<std::vector<float>, int> constant_data;
  std::vector<float> pairs(2 * kBrickPairs), further(extras.size() * kBrickPairs);
  const auto append = [&] {
    values_.insert(values_.end(), pairs.begin(), pairs.end());
    extras_.insert(extras_.end(), further.begin(), further.end());
    steps_.resize(steps_.size() + kStepWords, 0);
    if (steps)
      steps->plan(pairs.data(), one_value_per_cell_, temperature == nullptr, further.data(),
                  extra_fields_, steps_.data() + steps_.size() - kStepWords);
    float most = 0;
    for (std::size_t i = 1; i < pairs.size(); i += 2) most = std::max(most, pairs[i]);
    most_of_brick_.push_back(most);
    most_ = std::max(most_, static_cast<double>(most));
    plain_.push_back(std::all_of(steps_.end() - kStepWords, steps_.end(), is_plain) ? 1 : 0);
    return static_cast<int>(values_.size() / pairs.size()) - 1;
  };
  blank_ = append();  // still all 0
  const int checked = one_value_per_cell_ ? kBrickSide : kApronSide;
  for (const Index& b : bricks) {
    const Window temperatures(temperature,
                              {8 * b[0] + shift[0], 8 * b[1] + shift[1], 8 * b[2] + shift[2]});
    const Window absorptions(absorption, {8 * b[0], 8 * b[1], 8 * b[2]});
    bool constant = true;
    std::vector<bool> lit(kBrickPairs);  // samples at which an extra field is not 0
    for (std::size_t e = 0; e < extras.size(); ++e) {
      const Index& by = extras[e].shift;
      const Window window(extras[e].field, {8 * b[0] + by[0], 8 * b[1] + by[1], 8 * b[2] + by[2]});
      float* const field = further.data() + e * kBrickPairs;
      for (int s = 0; s < kBrickPairs; ++s) {
        const int i = s / (kApronSide * kApronSide), j = s / kApronSide % kApronSide,
                  k = s % kApronSide;
        field[s] = window.at(i, j, k);
        if (extras[e].emits && field[s] != 0) lit[s] = true;
        if (i < checked && j < checked && k < checked && field[s] != field[0]) constant = false;
      }
    }
    float* out = pairs.data();
    for (int i = 0; i < kApronSide; ++i)
      for (int j = 0; j < kApronSide; ++j)
        for (int k = 0; k < kApronSide; ++k, out += 2) {
          const int x = 8 * b[0] + i, y = 8 * b[1] + j, z = 8 * b[2] + k;
          out[0] = temperature ? temperatures.at(i, j, k) : 0;
          out[1] = absorption ? absorptions.at(i, j, k) : 0;
          const bool counts = i < checked && j < checked && k < checked;
          if (counts && (out[0] != pairs[0] || out[1] != pairs[1])) constant = false;
          const bool bright = lit[(i * kApronSide + j) * kApronSide + k];
          if (counts && (absorption ? out[1] != 0 || bright : out[0] != background_temperature_))
            for (int a = 0; a < 3; ++a) {
              const int at = a == 0 ? x : a == 1 ? y : z;
              tight_low[a] = std::min(tight_low[a], at - (one_value_per_cell_ ? 0 : 1));
              tight_high[a] = std::max(tight_high[a], at + 1);
            }
          if (temperature && counts) {
            temperature_range_[0] = std::min(temperature_range_[0], out[0]);
            temperature_range_[1] = std::max(temperature_range_[1], out[0]);
          }
        }
    int entry;
    if (constant) {
      std::vector<float> values{pairs[0], pairs[1]};
      for (std::size_t e = 0; e < extras.size(); ++e) values.push_back(further[e * kBrickPairs]);
      const auto [at, fresh] = constant_data.try_emplace(std::move(values), 0);
      if (fresh) at->second = append();
      entry = 2 * static_cast<int>(constants_.size()) + 1;
      constants_.push_back({pairs[0], pairs[1], at->second});
      constant_data_.push_back(at->second);
    } else {
      entry = 2 * append();
      ++varying_;
    }
    Index local;
    std::size_t block = 0;
    for (int a = 0; a < 3; ++a) {
      local[a] = b[a] - low[a];
      block = block * blocks_[a] + local[a] / 8;
    }
    if (top_[block] < 0) {
      top_[block] = static_cast<int>(table_.size());
      table_.resize(table_.size() + 512, -1);
    }
    table_[top_[block] + ((local[0] & 7) * 8 + (local[1] & 7)) * 8 + (local[2] & 7)] = entry;
  }
  lower_ = {double(tight_low[0]), double(tight_low[1]), double(tight_low[2])};
  upper_ = {double(tight_high[0]), double(tight_high[1]), double(tight_high[2])};
}

int Lattice::entry(Index brick) const {
  Index local;
  std::size_t block = 0;
  for (int a = 0; a < 3; ++a) {
    local[a] = brick[a] - origin_[a];
    if (local[a] < 0 || local[a] >= bricks_[a]) return -1;
    block = block * blocks_[a] + local[a] / 8;
  }
  if (top_[block] < 0) return -1;
  return table_[top_[block] + ((local[0] & 7) * 8 + (local[1] & 7)) * 8 + (local[2] & 7)];
}

namespace {

struct Place {
  Index brick{}, cell{};
  Vec3 fraction;
  bool valid = false;
};

Place place(Vec3 p) {
  Place result;
  const double coordinates[3] = {p.x, p.y, p.z};
  double fractions[3];
  for (int a = 0; a < 3; ++a) {
    const double whole = std::floor(coordinates[a]);
    if (!(std::fabs(whole) < 8.0 * kFarthestBrick)) return result;
    fractions[a] = coordinates[a] - whole;
    result.brick[a] = floor_div(static_cast<int>(whole), 8);
    result.cell[a] = static_cast<int>(whole) - 8 * result.brick[a];
  }
  result.fraction = {fractions[0], fractions[1], fractions[2]};
  result.valid = true;
  return result;
}

}  // namespace

bool Lattice::occupied(Vec3 index) const {
  const Place at = place(index);
  return at.valid && !empty() && entry(at.brick) >= 0;
}

Lattice::Corners Lattice::corners(Vec3 index) const {
  Corners corners;
  const Place at = place(index);
  const int found = at.valid && !empty() ? entry(at.brick) : -1;
  if (found < 0) return corners;
  corners.brick = found & 1 ? constants_[found / 2].data : found / 2;
  corners.count = one_value_per_cell_ ? 1 : 8;
  const double f[3] = {at.fraction.x, at.fraction.y, at.fraction.z};
  for (int m = 0; m < corners.count; ++m) {
    const int step[3] = {m >> 2, m >> 1 & 1, m & 1};
    double weight = 1;
    int sample = 0;
    for (int a = 0; a < 3; ++a) {
      if (!one_value_per_cell_) weight *= step[a] ? f[a] : 1 - f[a];
      sample = sample * kApronSide + at.cell[a] + step[a];
    }
    corners.sample[m] = sample;
    corners.weight[m] = weight;
  }
  return corners;
}

std::array<double, 2> Lattice::sample(Vec3 index) const {
  const Corners around = corners(index);
  if (around.brick < 0) return {background_temperature_, 0};
  const float* values = values_.data() + 2 * kBrickPairs * static_cast<std::size_t>(around.brick);
  std::array<double, 2> sum{0, 0};
  for (int m = 0; m < around.count; ++m) {
    sum[0] += around.weight[m] * values[2 * around.sample[m]];
    sum[1] += around.weight[m] * values[2 * around.sample[m] + 1];
  }
  return sum;
}

void Lattice::sample_cell(const Vec3* index, int count, double* temperature,
                          double* absorption) const {
  const auto give = [count](double* values, double value) {
    if (values) std::fill_n(values, count, value);
  };
  // The middle ones lie farthest from the cell's faces.
  const Place at = place(0.5 * (index[0] + index[count - 1]));
  const int found = at.valid && !empty() ? entry(at.brick) : -1;
  if (found < 0) {
    give(temperature, static_cast<double>(background_temperature_));
    give(absorption, 0);
    return;
  }
  const int brick = found & 1 ? constants_[static_cast<std::size_t>(found / 2)].data : found / 2;
  const int lowest = (at.cell[0] * kApronSide + at.cell[1]) * kApronSide + at.cell[2];
  const float* const first =
      values_.data() +
      2 * (static_cast<std::ptrdiff_t>(brick) * kBrickPairs + static_cast<std::ptrdiff_t>(lowest));
  if (one_value_per_cell_) {
    give(temperature, static_cast<double>(first[0]));
    give(absorption, static_cast<double>(first[1]));
    return;
  }
  constexpr std::ptrdiff_t kStep[3] = {2 * kApronSide * kApronSide, 2 * kApronSide, 2};
  const double corner[3] = {8.0 * at.brick[0] + at.cell[0], 8.0 * at.brick[1] + at.cell[1],
                            8.0 * at.brick[2] + at.cell[2]};
  for (int field = 0; field < 2; ++field) {
    double* const out = field == 0 ? temperature : absorption;
    if (!out) continue;
    double value[8];  // bit 2, 1, 0: one step along the first, second, third axis
    for (int m = 0; m < 8; ++m)
      value[m] = static_cast<double>(
          first[(m >> 2) * kStep[0] + (m >> 1 & 1) * kStep[1] + (m & 1) * kStep[2] + field]);
    for (int i = 0; i < count; ++i) {
      const double x = index[i].x - corner[0], y = index[i].y - corner[1],
                   z = index[i].z - corner[2];
      double edge[4];
      for (int m = 0; m < 4; ++m) edge[m] = value[2 * m] + z * (value[2 * m + 1] - value[2 * m]);
      const double low = edge[0] + y * (edge[1] - edge[0]);
      const double high = edge[2] + y * (edge[3] - edge[2]);
      out[i] = low + x * (high - low);
    }
  }
}

double Lattice::sum_extras(Vec3 index, const double* weights) const {
  const Corners around = corners(index);
  if (around.brick < 0) return 0;
  double sum = 0;
  for (int e = 0; e < extra_fields_; ++e) {
    const float* field =
        extras_.data() + static_cast<std::size_t>(around.brick * extra_fields_ + e) * kBrickPairs;
    for (int m = 0; m < around.count; ++m)
      sum += weights[e] * around.weight[m] * field[around.sample[m]];
  }
  return sum;
}

LatticeView Lattice::view() const {
  LatticeView view{};
  view.values = values_.data();
  view.extras = extra_fields_ > 0 ? extras_.data() : nullptr;
  view.extra_fields = extra_fields_;
  view.top = top_.data();
  view.table = table_.data();
  view.steps = steps_.data();
  view.plain = plain_.data();
  view.blank = blank_;
  const double low[3] = {lower_.x, lower_.y, lower_.z}, high[3] = {upper_.x, upper_.y, upper_.z};
  for (int a = 0; a < 3; ++a) {
    view.blocks[a] = blocks_[a];
    view.bricks[a] = bricks_[a];
    view.lower[a] = low[a] - 8.0 * origin_[a];
    view.upper[a] = high[a] - 8.0 * origin_[a];
  }
  view.constant_data = constant_data_.data();
  view.one_value_per_cell = one_value_per_cell_;
  view.background_temperature = background_temperature_;
  return view;
}

Vec3 Lattice::origin() const {
  return {8.0 * origin_[0], 8.0 * origin_[1], 8.0 * origin_[2]};
}

double Lattice::spacing() const {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Vec3& row : world_to_index_.linear.rows)
    smallest = std::min(smallest, 1 / length(row));
  return smallest;
}

double Lattice::largest_absorption(Vec3 lower, Vec3 upper) const {
  if (empty()) return 0;
  const double low[3] = {lower.x, lower.y, lower.z}, high[3] = {upper.x, upper.y, upper.z};
  Index first{}, last{};  // bricks, from the lowest
  for (int a = 0; a < 3; ++a) {
    const double from = std::floor(low[a] / 8) - origin_[a];
    const double to = std::floor(high[a] / 8) - origin_[a];
    if (to < 0 || from >= bricks_[a]) return 0;
    first[a] = static_cast<int>(std::max(from, 0.0));
    last[a] = static_cast<int>(std::min(to, bricks_[a] - 1.0));
  }
  float most = 0;
  const auto look_into = [&](const Index& block, int table) {
    Index begin{}, end{};
    for (int a = 0; a < 3; ++a) {
      begin[a] = std::max(first[a], 8 * block[a]) & 7;
      end[a] = std::min(last[a], 8 * block[a] + 7) & 7;
    }
    for (int i = begin[0]; i <= end[0]; ++i)
      for (int j = begin[1]; j <= end[1]; ++j)
        for (int k = begin[2]; k <= end[2]; ++k) {
          const int found = table_[table + (i * 8 + j) * 8 + k];
          if (found < 0) continue;
          const int brick = found & 1 ? constants_[found / 2].data : found / 2;
          most = std::max(most, most_of_brick_[brick]);
        }
  };
  // By blocks: stray voxels may lie far apart, with nothing between them.
  for (int i = first[0] / 8; i <= last[0] / 8; ++i)
    for (int j = first[1] / 8; j <= last[1] / 8; ++j)
      for (int k = first[2] / 8; k <= last[2] / 8; ++k)
        if (const int table = top_[(static_cast<std::size_t>(i) * blocks_[1] + j) * blocks_[2] + k];
            table >= 0)
          look_into({i, j, k}, table);
  return static_cast<double>(most);
}

std::size_t Lattice::bytes() const {
  return (values_.size() + extras_.size()) * sizeof(float) +
         (steps_.size() + top_.size() + table_.size()) * sizeof(int);
}

}  // namespace plenoflame::voxel
