#include "plenoflame/media/voxel_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/isa_dispatch.h"
#include "media/absorption_factors.h"
#include "media/source_fit.h"
#include "media/voxels/cell_sampling.h"
#include "media/voxels/unscattered_share.h"
#include "media/voxels/voxel_lattice.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

using voxel::Index;

// Whole-sample shift between two lattices with the same axes: temperature index = absorption index
// + shift. None when they differ by more than rounding.
std::optional<Index> shift_between(const AffineTransform& temperature,
                                   const AffineTransform& absorption, const std::string& name) {
  const AffineTransform back = voxel::inverse(temperature, name);
  const Mat3 linear = back.linear * absorption.linear;
  const Vec3 offset = back.linear * (absorption.translation - temperature.translation);
  const Mat3 unit;
  const double offsets[3] = {offset.x, offset.y, offset.z};
  Index shift;
  for (int a = 0; a < 3; ++a) {
    // Over 1e5 samples the lattices stay together to 1e-7 of a spacing.
    if (!(length(linear.rows[a] - unit.rows[a]) < 1e-12)) return std::nullopt;
    if (!(std::fabs(offsets[a]) < 1e6)) return std::nullopt;
    shift[a] = static_cast<int>(std::lround(offsets[a]));
    if (!(std::fabs(offsets[a] - shift[a]) < 1e-7)) return std::nullopt;
  }
  return shift;
}

/// A field on the samples of another one; no field if it has samples of its own.
voxel::ExtraField on_samples(const voxel::FieldReader& reader, const VoxelField& other,
                             bool emits) {
  const VoxelField& field = reader.field();
  const auto shift = shift_between(field.index_to_world, other.index_to_world, field.name);
  return {shift ? &reader : nullptr, shift.value_or(Index{}), emits};
}

/// Fields on the samples of the absorption.
class Extras {
 public:
  Extras(const VoxelExtras& extras, const VoxelField& absorption, std::size_t channels) {
    if (extras.lines.size() > kMostVoxelLines)
      throw InputError(fmt::format("a voxel medium has {} emission lines at most, not {}",
                                   kMostVoxelLines, extras.lines.size()));
    if (extras.line_weights.size() != channels * extras.lines.size())
      throw InputError("a voxel medium needs one weight for each line and channel");
    for (const double weight : extras.line_weights)
      if (!(weight >= 0) || !std::isfinite(weight))
        throw InputError("an emission line's weight must be a number of at least 0");
    readers_.reserve(extras.lines.size() + 1);
    if (extras.albedo) {
      share_ = voxel::unscattered_share(*extras.albedo);
      add(share_, absorption, false);
    }
    for (const VoxelField& line : extras.lines) {
      if (line.background != 0)
        throw InputError(fmt::format(
            "field '{}': its background is {} W/(m^3 sr); it must be 0, or all of space would glow",
            line.name, line.background));
      add(line, absorption, true);
    }
    const std::size_t lines = extras.lines.size();
    for (std::size_t c = 0; c < channels; ++c) {
      if (extras.albedo) weights.push_back(0);
      const auto own = extras.line_weights.begin() + static_cast<std::ptrdiff_t>(c * lines);
      weights.insert(weights.end(), own, own + static_cast<std::ptrdiff_t>(lines));
    }
  }
  bool has_share() const { return !share_.values.empty() || share_.background > 0; }
  /// Turns absorption into extinction.
  void scatter(VoxelField& absorption) const {
    if (!has_share()) return;
    const auto& [reader, shift, unused] = fields.front();
    for (std::size_t v = 0; v < absorption.values.size(); ++v) {
      Index at = voxel::index_of(absorption, v);
      for (int a = 0; a < 3; ++a) at[a] += shift[a];
      absorption.values[v] /= reader->at(at);
    }
  }
  std::vector<voxel::ExtraField> fields;
  std::vector<double> weights;  ///< of field e in channel c, at [c * fields + e]

 private:
  void add(const VoxelField& field, const VoxelField& absorption, bool emits) {
    readers_.emplace_back(field);
    fields.push_back(on_samples(readers_.back(), absorption, emits));
    if (!fields.back().field)
      throw InputError(
          fmt::format("field '{}' is not on the lattice of '{}': its voxels must have the same "
                      "size and axes and lie a whole number of voxels apart; resample one of them",
                      field.name, absorption.name));
  }
  VoxelField share_;
  std::vector<voxel::FieldReader> readers_;
};

voxel::CellMap cell_map(const voxel::Lattice& lattice, Vec3 anchor) {
  const AffineTransform& map = lattice.world_to_index();
  voxel::CellMap out{};
  // The differences first: anchor and translation may be large and nearly equal.
  const Vec3 origin =
      map.linear * (anchor - lattice.index_to_world().translation) - lattice.origin();
  const double parts[3] = {origin.x, origin.y, origin.z};
  for (int a = 0; a < 3; ++a) {
    const Vec3& row = map.linear.rows[a];
    out.linear[3 * a] = row.x;
    out.linear[3 * a + 1] = row.y;
    out.linear[3 * a + 2] = row.z;
    out.origin[a] = parts[a];
  }
  return out;
}

// The kernel's tables in one precision.
template <class Real>
struct Tables {
  std::vector<std::vector<Real>> exponents, weights;
  std::vector<voxel::SourceView<Real>> sources;
  std::vector<Real> constant_absorption, constant_source, factors, line_weights, constant_lines;

  // @param temperatures lowest and highest that occur [K]
  Tables(const std::vector<SourceFunction>& channels, const std::vector<double>& given_factors,
         const std::vector<double>& given_weights, int share_fields, const voxel::Lattice& cells,
         std::array<float, 2> temperatures) {
    const std::size_t fields = given_weights.size() / channels.size();
    for (const double weight : given_weights) line_weights.push_back(static_cast<Real>(weight));
    for (std::size_t c = 0; c < channels.size() && fields > 0; ++c)
      for (const auto& constant : cells.constants()) {
        double emission = 0;
        for (std::size_t e = 0; e < fields; ++e)
          emission += given_weights[c * fields + e] *
                      static_cast<double>(cells.constant_extra(constant, static_cast<int>(e)));
        constant_lines.push_back(static_cast<Real>(emission));
      }
    for (const double factor : given_factors) factors.push_back(static_cast<Real>(factor));
    for (const SourceFunction& channel : channels) {
      auto& e = exponents.emplace_back();
      auto& w = weights.emplace_back();
      for (const auto& node : channel.nodes()) {
        e.push_back(static_cast<Real>(node.exponent));
        w.push_back(static_cast<Real>(node.weight));
      }
      for (const auto& constant : cells.constants())
        constant_source.push_back(static_cast<Real>(
            channel(constant.temperature) *
            (share_fields > 0 ? static_cast<double>(cells.constant_extra(constant, 0)) : 1)));
    }
    for (std::size_t c = 0; c < channels.size(); ++c) {
      voxel::SourceView<Real>& view = sources.emplace_back();
      // In double the sum over the band itself: the reference.
      if constexpr (sizeof(Real) == sizeof(float)) {
        const voxel::SourceFit fit =
            voxel::fit_source(channels[c], temperatures[0], temperatures[1], 1e-7,
                              voxel::kMaxFitTerms, voxel::kTermsOfTwo);
        view.fit_terms = static_cast<int>(fit.terms.size());
        for (std::size_t k = 0; k < fit.terms.size(); ++k)
          view.fit[voxel::kMaxFitTerms - fit.terms.size() + k] = static_cast<float>(fit.terms[k]);
        view.split_terms = static_cast<int>(fit.far_terms.size());
        for (std::size_t k = 0; k < fit.far_terms.size(); ++k)
          view.far_fit[voxel::kMaxFitTerms - fit.far_terms.size() + k] =
              static_cast<float>(fit.far_terms[k]);
        view.split = static_cast<float>(fit.split);
        view.at_split = static_cast<float>(fit.at_split);
        view.scale = static_cast<float>(fit.highest * (1 - fit.occupation));
        view.occupation = static_cast<float>(fit.occupation);
        view.last = static_cast<float>(fit.last());
        if (fit.terms.empty() && fit.coldest > 0 && !channels[c].is_total()) {
          exponents[c].clear();
          weights[c].clear();
          for (const auto& node : voxel::fewer_nodes(channels[c], fit.coldest, fit.hottest, 1e-7)) {
            exponents[c].push_back(static_cast<Real>(node.exponent));
            weights[c].push_back(static_cast<Real>(node.weight));
          }
        }
      }
      view.exponents = exponents[c].data();
      view.weights = weights[c].data();
      view.count = static_cast<int>(exponents[c].size());
    }
    for (const auto& constant : cells.constants())
      constant_absorption.push_back(constant.absorption);
  }
};

class VoxelMedium final : public Medium, public CellSampling {
 public:
  VoxelMedium(const voxel::FieldReader& temperature, const voxel::FieldReader& absorption,
              VoxelInterpolation interpolation, std::vector<SourceFunction> channels,
              const VoxelMediumOptions& options, const Extras& extras)
      : channels_(std::move(channels)),
        factors_(grey_or_checked(options.absorption_factors, channels_.size())),
        line_weights_(extras.weights),
        share_fields_(extras.has_share() ? 1 : 0),
        constant_(interpolation == VoxelInterpolation::constant),
        shared_cells_(std::make_shared<const voxel::Lattice>(voxel::Lattice::of_absorption(
            absorption, on_samples(temperature, absorption.field(), false), extras.fields,
            interpolation, voxel::StepPlanner(channels_, options.tolerance), options.placement))),
        cells_(*shared_cells_),
        temperature_(on_samples(temperature, absorption.field(), false).field
                         ? nullptr
                         : std::make_shared<const voxel::Lattice>(voxel::Lattice::of_temperature(
                               temperature, interpolation, options.placement))),
        single_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()),
        double_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()) {
    if (!cells_.empty()) set_bounds();
  }

  /// One channel of another one, on the same lattices. Cells are cut as all channels need it.
  VoxelMedium(const VoxelMedium& whole, std::size_t channel)
      : channels_{whole.channels_.at(channel)},
        factors_(grey_or_checked({whole.factors_.empty() ? 1.0 : whole.factors_[channel]}, 1)),
        line_weights_(row_of(whole, channel)),
        share_fields_(whole.share_fields_),
        constant_(whole.constant_),
        shared_cells_(whole.shared_cells_),
        cells_(*shared_cells_),
        temperature_(whole.temperature_),
        single_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()),
        double_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()),
        bounds_(whole.bounds_) {}

  /// Another one elsewhere.
  VoxelMedium(const VoxelMedium& other, const FlamePlacement& placement)
      : channels_(other.channels_),
        factors_(other.factors_),
        line_weights_(other.line_weights_),
        share_fields_(other.share_fields_),
        constant_(other.constant_),
        shared_cells_(std::make_shared<const voxel::Lattice>(other.cells_.placed(placement))),
        cells_(*shared_cells_),
        temperature_(other.temperature_ ? std::make_shared<const voxel::Lattice>(
                                              other.temperature_->placed(placement))
                                        : nullptr),
        single_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()),
        double_(channels_, factors_, line_weights_, share_fields_, cells_, temperature_range()) {
    if (!cells_.empty()) set_bounds();
  }

  std::shared_ptr<const Medium> single_channel(int channel) const override {
    return std::make_shared<VoxelMedium>(*this, static_cast<std::size_t>(channel));
  }

  std::shared_ptr<const Medium> placed(const FlamePlacement& placement) const override {
    return std::make_shared<VoxelMedium>(*this, placement);
  }

  int channel_count() const override { return static_cast<int>(channels_.size()); }

  Box bounds() const override { return bounds_; }
  std::vector<Box> occupied() const override;

  bool is_costly() const override { return true; }
  bool is_grey() const override { return factors_.empty(); }
  double largest_absorption(int channel) const override {
    return cells_.largest_absorption() *
           (factors_.empty() ? 1 : factors_[static_cast<std::size_t>(channel)]);
  }
  double largest_share(const Box& box) const override;
  void absorptions(Vec3 world, double* each) const override {
    const double absorption = sample(world).absorption;
    for (std::size_t c = 0; c < channels_.size(); ++c)
      each[c] = absorption * (factors_.empty() ? 1 : factors_[c]);
  }
  double feature_size() const override {
    return temperature_ ? std::min(cells_.spacing(), temperature_->spacing()) : cells_.spacing();
  }

  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    integrate_batch(rays, single_, options, out, counters);
  }

  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    integrate_batch(rays, double_, options, out, counters);
  }

  MediumSample sample(Vec3 world) const override {
    const auto both = cells_.sample(cells_.world_to_index().point(world));
    if (!temperature_) return {both[0], both[1]};
    return {temperature_->sample(temperature_->world_to_index().point(world))[0], both[1]};
  }

  double coefficients(Vec3 world, double* emission) const override {
    const double absorption = Medium::coefficients(world, emission);
    const std::size_t fields = line_weights_.size() / channels_.size();
    const Vec3 index = cells_.world_to_index().point(world);
    const double share = 1 - albedo(world);
    for (std::size_t c = 0; c < channels_.size() && fields > 0; ++c)
      emission[c] = share * emission[c] + cells_.sum_extras(index, &line_weights_[c * fields]);
    return absorption;
  }

  void coefficients_between(const Ray& ray, std::span<const double> t, int channels,
                            const CoefficientBatch& out) const override;

  double albedo(Vec3 world) const override {
    if (share_fields_ == 0) return 0;
    double first[voxel::kMaxExtras] = {1};
    // Nothing is scattered where nothing is stored.
    const Vec3 index = cells_.world_to_index().point(world);
    return cells_.occupied(index) ? 1 - cells_.sum_extras(index, first) : 0;
  }

  double source(int channel, double temperature) const override {
    return channels_.at(static_cast<std::size_t>(channel))(temperature);
  }

  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override;

  std::string description() const override {
    const std::size_t bytes = cells_.bytes() + (temperature_ ? temperature_->bytes() : 0);
    return fmt::format(
        "voxels of {:.4g} mm, {}, {} varying and {} constant bricks of 8^3, {}{}{:.1f} MB",
        1e3 * cells_.spacing(), constant_ ? "one value each" : "trilinear", cells_.varying_bricks(),
        cells_.constant_bricks(), temperature_ ? "temperature on a lattice of its own, " : "",
        lines_text(), 1e-6 * double(bytes));
  }

 private:
  /// Weights of the extra fields in one channel.
  static std::vector<double> row_of(const VoxelMedium& whole, std::size_t channel) {
    const std::size_t fields = whole.line_weights_.size() / whole.channels_.size();
    const auto row = whole.line_weights_.begin() + static_cast<std::ptrdiff_t>(channel * fields);
    return {row, row + static_cast<std::ptrdiff_t>(fields)};
  }
  std::array<float, 2> temperature_range() const {
    return (temperature_ ? *temperature_ : cells_).temperature_range();
  }
  std::string lines_text() const {
    const std::size_t lines =
        line_weights_.size() / channels_.size() - static_cast<std::size_t>(share_fields_);
    std::string text = share_fields_ > 0 ? "a field of albedos, " : "";
    if (lines > 0) text += fmt::format("{} emission line{}, ", lines, lines == 1 ? "" : "s");
    return text;
  }

  void set_bounds() {
    const double infinity = std::numeric_limits<double>::infinity();
    bounds_ = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    const Vec3 low = cells_.lower(), high = cells_.upper();
    for (int m = 0; m < 8; ++m) {
      const Vec3 p = cells_.index_to_world().point(
          {m & 1 ? high.x : low.x, m & 2 ? high.y : low.y, m & 4 ? high.z : low.z});
      bounds_.lower = {std::min(bounds_.lower.x, p.x), std::min(bounds_.lower.y, p.y),
                       std::min(bounds_.lower.z, p.z)};
      bounds_.upper = {std::max(bounds_.upper.x, p.x), std::max(bounds_.upper.y, p.y),
                       std::max(bounds_.upper.z, p.z)};
    }
  }

  template <class Real>
  void integrate_batch(const RayBatch<Real>& rays, const Tables<Real>& tables,
                       const MediumOptions& options, RadianceBatch<Real> out,
                       MediumCounters& counters) const;

  std::vector<SourceFunction> channels_;
  std::vector<double> factors_;       ///< on the absorption, per channel; empty: grey
  std::vector<double> line_weights_;  ///< of extra field e in channel c, at [c * fields + e]
  int share_fields_;  ///< 1: the first extra field is the share that is not scattered
  bool constant_;
  std::shared_ptr<const voxel::Lattice> shared_cells_;
  const voxel::Lattice& cells_;
  std::shared_ptr<const voxel::Lattice> temperature_;  ///< nullptr: on the cells' samples
  Tables<float> single_;
  Tables<double> double_;
  Box bounds_;
};

double VoxelMedium::largest_share(const Box& box) const {
  // The box of the rotated box, including the corners that the rotation adds.
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Vec3 lower{kInf, kInf, kInf}, upper = -1.0 * lower;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at = cells_.world_to_index().point({corner & 1 ? box.upper.x : box.lower.x,
                                                   corner & 2 ? box.upper.y : box.lower.y,
                                                   corner & 4 ? box.upper.z : box.lower.z});
    lower = {std::min(lower.x, at.x), std::min(lower.y, at.y), std::min(lower.z, at.z)};
    upper = {std::max(upper.x, at.x), std::max(upper.y, at.y), std::max(upper.z, at.z)};
  }
  const double most = cells_.largest_absorption();
  return most > 0 ? cells_.largest_absorption(lower, upper) / most : 0;
}

std::vector<Box> VoxelMedium::occupied() const {
  std::vector<Box> boxes;
  if (cells_.empty()) return boxes;
  const Vec3 first = cells_.origin(), low = cells_.lower(), high = cells_.upper();
  const Mat3& linear = cells_.index_to_world().linear;
  for (double x = first.x; x < high.x; x += 8)
    for (double y = first.y; y < high.y; y += 8)
      for (double z = first.z; z < high.z; z += 8) {
        if (!cells_.occupied({x + 4, y + 4, z + 4})) continue;
        const Vec3 a{std::max(x, low.x), std::max(y, low.y), std::max(z, low.z)};
        const Vec3 b{std::min(x + 8, high.x), std::min(y + 8, high.y), std::min(z + 8, high.z)};
        const Vec3 half = 0.5 * (b - a);
        Vec3 reach;
        double* const out[] = {&reach.x, &reach.y, &reach.z};
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3 row = linear.rows[i];
          // A little more, for the rounding of rays that are moved to index coordinates.
          *out[i] = (1 + 1e-9) * (std::fabs(row.x) * half.x + std::fabs(row.y) * half.y +
                                  std::fabs(row.z) * half.z);
        }
        const Vec3 centre = cells_.index_to_world().point(0.5 * (a + b));
        boxes.push_back({centre - reach, centre + reach});
      }
  return boxes;
}

template <class Real>
void VoxelMedium::integrate_batch(const RayBatch<Real>& rays, const Tables<Real>& tables,
                                  const MediumOptions& options, RadianceBatch<Real> out,
                                  MediumCounters& counters) const {
  if (cells_.empty()) {
    for (int c = 0; c < channel_count(); ++c)
      std::fill_n(out.radiance + static_cast<std::ptrdiff_t>(c) * out.stride, rays.size, Real(0));
    for (int c = 0; c < (out.transmittance_stride ? channel_count() : 1); ++c)
      std::fill_n(out.transmittance + static_cast<std::ptrdiff_t>(c) * out.transmittance_stride,
                  rays.size, Real(1));
    return;
  }
  voxel::MediumView<Real> medium{};
  voxel::LatticeView temperature{};
  medium.cells = cells_.view();
  if (temperature_) {
    temperature = temperature_->view();
    medium.temperature = &temperature;
  }
  medium.constant_absorption = tables.constant_absorption.data();
  medium.constant_source = tables.constant_source.data();
  medium.constants = static_cast<int>(tables.constant_absorption.size());
  medium.sources = tables.sources.data();
  medium.channels = channel_count();
  medium.hottest = static_cast<Real>(temperature_range()[1]);
  medium.factors = tables.factors.empty() ? nullptr : tables.factors.data();
  medium.share_fields = share_fields_;
  medium.line_weights = tables.line_weights.data();
  medium.constant_lines = tables.constant_lines.empty() ? nullptr : tables.constant_lines.data();

  voxel::Call<Real> call{};
  call.medium = &medium;
  call.to_cells = cell_map(cells_, rays.anchor);
  if (temperature_) call.to_temperature = cell_map(*temperature_, rays.anchor);
  call.x = rays.x;
  call.y = rays.y;
  call.z = rays.z;
  call.dx = rays.dx;
  call.dy = rays.dy;
  call.dz = rays.dz;
  call.t_near = rays.t_near;
  call.t_far = rays.t_far;
  call.size = rays.size;
  call.skip = options.skip ? 1 : 0;
  call.radiance = out.radiance;
  call.stride = out.stride;
  call.transmittance = out.transmittance;
  call.transmittance_stride = out.transmittance_stride;

  voxel::Counters counted{};
  PLENOFLAME_DISPATCH(options.isa, kernels::integrate_voxels(call, counted);)
  counters.rays += counted.rays;
  counters.cells += counted.cells;
  counters.skipped_empty += counted.skipped_empty;
  counters.skipped_constant += counted.skipped_constant;
  counters.opaque_tails += counted.opaque_tails;
}

void VoxelMedium::coefficients_between(const Ray& ray, std::span<const double> t, int channels,
                                       const CoefficientBatch& out) const {
  const auto& [emission, absorption, temperature] = out;
  const int count = static_cast<int>(t.size());
  std::array<Vec3, kMostAtOnce> index;
  std::array<double, kMostAtOnce> extinction{};
  const auto find = [&](const voxel::Lattice& lattice) {
    for (std::size_t i = 0; i < t.size(); ++i)
      index[i] = lattice.world_to_index().point(ray.at(t[i]));
  };
  if (temperature_) {
    find(*temperature_);
    temperature_->sample_cell(index.data(), count, temperature, nullptr);
  }
  find(cells_);
  cells_.sample_cell(index.data(), count, temperature_ ? nullptr : temperature, extinction.data());
  const std::size_t fields = line_weights_.size() / channels_.size();
  for (std::size_t i = 0; i < t.size(); ++i) {
    const Vec3 at = index[i];
    const double share = share_fields_ > 0 ? 1 - albedo(ray.at(t[i])) : 1.0;
    for (int channel = 0; channel < channels; ++channel) {
      const auto c = static_cast<std::size_t>(channel);
      const std::size_t to = i * static_cast<std::size_t>(channels) + c;
      absorption[to] = extinction[i] * (factors_.empty() ? 1 : factors_[c]);
      emission[to] =
          absorption[to] > 0 ? share * absorption[to] * channels_[c](temperature[i]) : 0.0;
      if (fields > 0) emission[to] += cells_.sum_extras(at, &line_weights_[c * fields]);
    }
  }
}

// Appends where origin + t * direction is a whole number, between t = begin and end.
void append_crossings(double origin, double direction, double begin, double end, double spacing,
                      std::vector<double>& t) {
  if (direction == 0) return;
  const double first = (origin + begin * direction) / spacing;
  const double last = (origin + end * direction) / spacing;
  const double low = std::ceil(std::min(first, last)), high = std::floor(std::max(first, last));
  for (double plane = low; plane <= high; ++plane)
    t.push_back((plane * spacing - origin) / direction);
}

void VoxelMedium::append_breakpoints(const Ray& ray, std::vector<double>& t) const {
  if (cells_.empty()) return;
  const AffineTransform& to_index = cells_.world_to_index();
  const Vec3 o = to_index.linear * (ray.origin - cells_.index_to_world().translation);
  const Vec3 d = to_index.linear * ray.direction;
  const double origin[3] = {o.x, o.y, o.z}, direction[3] = {d.x, d.y, d.z};
  const Vec3 low = cells_.lower(), high = cells_.upper();
  const double lower[3] = {low.x, low.y, low.z}, upper[3] = {high.x, high.y, high.z};
  double begin = -std::numeric_limits<double>::infinity(), end = -begin;
  for (int a = 0; a < 3; ++a) {
    if (direction[a] == 0) {
      if (origin[a] < lower[a] || origin[a] > upper[a]) return;
      continue;
    }
    const double t0 = (lower[a] - origin[a]) / direction[a];
    const double t1 = (upper[a] - origin[a]) / direction[a];
    begin = std::max(begin, std::min(t0, t1));
    end = std::min(end, std::max(t0, t1));
  }
  if (!(end > begin) || !std::isfinite(end - begin)) return;

  std::vector<double> faces{begin, end};
  for (int a = 0; a < 3; ++a) append_crossings(origin[a], direction[a], begin, end, 8, faces);
  std::sort(faces.begin(), faces.end());
  for (std::size_t f = 0; f + 1 < faces.size(); ++f) {
    const double t0 = faces[f], t1 = faces[f + 1];
    if (!(t1 > t0) || !cells_.occupied(o + (0.5 * (t0 + t1)) * d)) continue;
    t.push_back(t0);
    t.push_back(t1);
    for (int a = 0; a < 3; ++a) append_crossings(origin[a], direction[a], t0, t1, 1, t);
    if (!temperature_) continue;
    const AffineTransform& map = temperature_->world_to_index();
    const Vec3 ot = map.linear * (ray.origin - temperature_->index_to_world().translation);
    const Vec3 dt = map.linear * ray.direction;
    append_crossings(ot.x, dt.x, t0, t1, 1, t);
    append_crossings(ot.y, dt.y, t0, t1, 1, t);
    append_crossings(ot.z, dt.z, t0, t1, 1, t);
  }
}

}  // namespace

std::unique_ptr<Medium> make_voxel_medium(VoxelField temperature, VoxelField absorption,
                                          VoxelInterpolation interpolation,
                                          std::vector<SourceFunction> channels,
                                          const VoxelMediumOptions& options) {
  if (!(options.tolerance >= 0 && options.tolerance < 1))
    throw InputError("the voxel medium's tolerance must be at least 0 and below 1");
  if (channels.empty()) throw InputError("a voxel medium needs at least one channel");
  if (absorption.background != 0)
    throw InputError(fmt::format(
        "field '{}': absorption's background is {} 1/m; it must be 0, or the flame has no end",
        absorption.name, absorption.background));
  const Extras extras(options.extras, absorption, channels.size());
  extras.scatter(absorption);
  return std::make_unique<VoxelMedium>(voxel::FieldReader(temperature),
                                       voxel::FieldReader(absorption), interpolation,
                                       std::move(channels), options, extras);
}

}  // namespace plenoflame
