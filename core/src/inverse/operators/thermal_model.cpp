#include "plenoflame/inverse/thermal_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "inverse/operators/followed_rows.h"
#include "inverse/operators/source_table.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/pupil_filters.h"
#include "plenoflame/inverse/measurement.h"
#include "plenoflame/scene/pupil_transmission.h"
#include "plenoflame/scene/spectral.h"

namespace plenoflame {
namespace {

/// The fields that x holds, one value for every unknown.
struct ThermalFields {
  /// The light that a ray brings.
  struct Light {
    SourceTable source;
    double absorption_ratio;
  };
  /// Light of a channel without filters, and else of the parts of each view's stop.
  struct Lights {
    Light plain;
    std::vector<std::vector<Light>> parts;
    const Light& of(int view, int part) const {
      if (parts.empty() || parts[static_cast<std::size_t>(view)].empty()) return plain;
      return parts[static_cast<std::size_t>(view)][static_cast<std::size_t>(part)];
    }
  };
  std::vector<double> temperature, absorption;
  std::vector<Lights> lights;  ///< of the channels

  ThermalFields(const ThermalModel& model, std::span<const double> x)
      : temperature(model.temperature), absorption(model.absorption) {
    for (const ThermalChannel& channel : model.channels) {
      Lights own{{SourceTable(channel.source), channel.absorption_ratio}, {}};
      for (const std::vector<ThermalPart>& view : channel.parts) {
        own.parts.emplace_back();
        for (const ThermalPart& part : view)
          own.parts.back().push_back(
              {SourceTable(part.source), channel.absorption_ratio * part.absorption_ratio});
      }
      lights.push_back(std::move(own));
    }
    const std::size_t n = model.unknowns->size();
    std::size_t next = 0;
    if (temperature.empty()) {
      temperature.assign(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(n));
      next = n;
    }
    if (!absorption.empty()) return;
    absorption.assign(n, 0.0);
    for (std::size_t j = 0; j < n; ++j)
      if (model.absorbs.empty() || model.absorbs[j]) absorption[j] = std::exp(x[next + j]);
  }
};

void check(const ThermalModel& model, std::span<const double> x) {
  const std::size_t n = model.unknowns->size();
  for (const auto* known : {&model.temperature, &model.absorption})
    if (!known->empty() && known->size() != n)
      throw UsageError("a known field has " + std::to_string(known->size()) + " values for " +
                       std::to_string(n) + " unknowns");
  if (!model.absorbs.empty() && model.absorbs.size() != n)
    throw UsageError("what absorbs is said of " + std::to_string(model.absorbs.size()) + " of " +
                     std::to_string(n) + " unknowns");
  if (x.size() != model.columns())
    throw UsageError("the model has " + std::to_string(model.columns()) + " variables, not " +
                     std::to_string(x.size()));
}

/// An interval of a ray in the light of one channel.
struct LitInterval {
  std::array<SourceTable::Value, 2> source{};
  double passed = 1;    ///< transmittance of what is in front
  double radiance = 0;  ///< what it adds to the ray's
  bool empty = false;   ///< nothing absorbs there
};

/// Follows the rays of rows; one for each thread.
class ThermalWalk {
 public:
  ThermalWalk(const ThermalModel& model, const ThermalFields& fields)
      : model_(model), fields_(fields) {
    for (const ThermalChannel& channel : model.channels) rays_.emplace_back(*channel.rays);
  }

  /// The row's flux [W].
  double flux(std::size_t row) {
    const auto [c, own] = place_of(row);
    const int view = model_.channels[c].rays->rows[own].view;
    double sum = 0;
    for (const CameraRay& ray : rays_[c].of(own))
      sum += ray.weight * radiance(fields_.lights[c].of(view, ray.part), ray);
    return sum;
  }

  /// Derivatives of the row's flux.
  template <class Use>
  void follow(std::size_t row, const Use& use) {
    const auto [c, own] = place_of(row);
    const int view = model_.channels[c].rays->rows[own].view;
    for (const CameraRay& ray : rays_[c].of(own)) {
      const Light& light = fields_.lights[c].of(view, ray.part);
      radiance(light, ray);
      derivatives(light, ray.weight, use);
    }
  }

 private:
  using Light = ThermalFields::Light;
  /// The channel of a row of the model, and the row's number there.
  std::pair<std::size_t, std::size_t> place_of(std::size_t row) const {
    for (std::size_t c = 0; c < model_.channels.size(); ++c) {
      const std::size_t own = model_.channels[c].rays->rows.size();
      if (row < own) return {c, row};
      row -= own;
    }
    throw UsageError("the model has no such row");
  }

  double radiance(const Light& light, const CameraRay& ray) {
    intervals_.clear();
    model_.unknowns->append({ray.origin, ray.direction}, 0, ray.end, intervals_);
    transfers_.set(intervals_, fields_.absorption, light.absorption_ratio, RowModel::source);
    lit_.resize(intervals_.size());
    double passed = 1, sum = 0;
    for (std::size_t i = 0; i < intervals_.size(); ++i) {
      LitInterval& lit = lit_[i];
      lit = {};
      lit.passed = passed;
      // Nothing is emitted where nothing absorbs: exponentials are saved.
      lit.empty = !(transfers_.near_depth[i] + transfers_.far_depth[i] > 0);
      if (lit.empty) continue;
      for (std::size_t n = 0; n < 2; ++n)
        lit.source[n] = light.source.at(value_at(intervals_[i], n, fields_.temperature));
      lit.radiance = passed * (transfers_.near[i] * lit.source[0].source +
                               transfers_.far[i] * lit.source[1].source);
      passed *= transfers_.transmittance[i];
      sum += lit.radiance;
    }
    return sum;
  }

  /// From the far end to the near one, with the light that arrives from behind.
  template <class Use>
  void derivatives(const Light& light, double weight, const Use& use) {
    const std::size_t unknowns = model_.unknowns->size();
    const bool hot = model_.temperature.empty(), thick = model_.absorption.empty();
    const std::size_t first_absorption = hot ? unknowns : 0;
    double behind = 0;  // that of the intervals behind, as it arrives at the camera
    for (std::size_t i = intervals_.size(); i-- > 0;) {
      const LitInterval& lit = lit_[i];
      if (lit.empty) continue;
      const RayInterval& interval = intervals_[i];
      std::array<double, 2> by_temperature{}, by_depth{};
      for (std::size_t n = 0; n < 2; ++n)
        by_temperature[n] = weight * lit.passed *
                            (n == 0 ? transfers_.near[i] : transfers_.far[i]) * lit.source[n].slope;
      for (int c = 0; c < interval.count && hot; ++c)
        use(interval.sample[c],
            by_temperature[0] * interval.weight[0][c] + by_temperature[1] * interval.weight[1][c]);
      if (thick) {
        const TransferSlopes slopes =
            transfer_slopes(transfers_.near_depth[i], transfers_.far_depth[i]);
        for (std::size_t n = 0; n < 2; ++n)
          by_depth[n] = (lit.passed * (slopes.near[n] * lit.source[0].source +
                                       slopes.far[n] * lit.source[1].source) -
                         behind) *
                        weight * 0.5 * interval.length * light.absorption_ratio;
        for (int c = 0; c < interval.count; ++c)
          use(first_absorption + interval.sample[c],
              (by_depth[0] * interval.weight[0][c] + by_depth[1] * interval.weight[1][c]) *
                  fields_.absorption[interval.sample[c]]);
      }
      behind += lit.radiance;
    }
  }

  const ThermalModel& model_;
  const ThermalFields& fields_;
  std::vector<RowRays> rays_;  ///< of the channels
  RayIntervals intervals_;
  IntervalTransfers transfers_;
  std::vector<LitInterval> lit_;
};

struct ThermalRows {
  const ThermalModel* model;
  std::shared_ptr<const ThermalFields> fields;
  std::size_t rows() const { return model->rows(); }
  std::size_t columns() const { return model->columns(); }
  bool are_drawn() const {
    return std::any_of(
        model->channels.begin(), model->channels.end(),
        [](const ThermalChannel& channel) { return channel.rays->source != nullptr; });
  }
  /// The pieces of all channels, one channel after the other.
  RowPieces pieces() const {
    RowPieces all;
    for (const ThermalChannel& channel : model->channels) {
      const RowPieces own = pieces_of(*channel.rays);
      const std::size_t first = all.rows.size();
      for (const std::size_t row : own.rows) all.rows.push_back(first + row);
      for (const std::size_t end : own.ends) all.ends.push_back(first + end);
    }
    return all;
  }
  ThermalWalk walk() const { return {*model, *fields}; }
};

ThermalRows rows_of(const ThermalModel& model, std::span<const double> x) {
  check(model, x);
  return {&model, std::make_shared<const ThermalFields>(model, x)};
}

}  // namespace

std::vector<ThermalPart> thermal_parts(const Scene& scene, std::size_t channel) {
  const PupilFilters filters(scene.camera.pupil_filters);
  if (filters.empty()) return {};
  const std::vector<double> shares = pupil_transmission(scene, channel);
  const SourceFunction open = channel_source(scene, channel);
  std::vector<ThermalPart> parts(shares.size(), {open, 1});
  for (std::size_t p = 0; p < filters.filters().size(); ++p) {
    const std::string& curve = filters.filters()[p].transmission;
    if (curve.empty() || !(shares[p] > 0)) continue;
    const auto response = camera_response(scene, scene.channels.at(channel), curve);
    if (!response) continue;
    const SourceFunction own = SourceFunction::of(*response);
    parts[p].source = own.scaled(1 / shares[p]);
    if (open.wavelength() > 0) parts[p].absorption_ratio = open.wavelength() / own.wavelength();
  }
  return parts;
}

std::size_t ThermalModel::rows() const {
  std::size_t count = 0;
  for (const ThermalChannel& channel : channels) count += channel.rays->rows.size();
  return count;
}

std::size_t ThermalModel::columns() const {
  return unknowns->size() * ((temperature.empty() ? 1U : 0U) + (absorption.empty() ? 1U : 0U));
}

std::vector<double> thermal_fluxes(const ThermalModel& model, std::span<const double> x,
                                   const Execution& execution) {
  const ThermalRows all = rows_of(model, x);
  std::vector<double> flux(all.rows());
  const RowPieces pieces = all.pieces();
  const auto task = [&](std::size_t piece, int) {
    ThermalWalk walk = all.walk();
    follow_piece(pieces, piece, execution, [&](std::size_t row) { flux[row] = walk.flux(row); });
  };
  for_pieces(execution, pieces.count(), task);
  return flux;
}

std::unique_ptr<LinearOperator> make_thermal_derivative(const ThermalModel& model,
                                                        std::span<const double> x,
                                                        const Execution& execution) {
  return std::make_unique<FollowedOperator<ThermalRows>>(rows_of(model, x), execution);
}

CsrMatrix<float> make_thermal_matrix(const ThermalModel& model, std::span<const double> x,
                                     const Execution& execution) {
  const ThermalRows rows = rows_of(model, x);
  return rows.are_drawn() ? store_pieces(rows, execution) : store_rows(rows, execution);
}

std::size_t estimated_entries(const ThermalModel& model, std::span<const double> x) {
  return estimate_entries(rows_of(model, x));
}

}  // namespace plenoflame
