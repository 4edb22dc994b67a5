#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "media/transfer.h"
#include "plenoflame/base/error.h"
#include "plenoflame/math/ray_span.h"
#include "plenoflame/media/medium.h"

namespace plenoflame {
namespace {

class CompositeMedium final : public Medium {
 public:
  explicit CompositeMedium(std::vector<std::shared_ptr<const Medium>> media)
      : media_(std::move(media)) {
    for (const auto& medium : media_)
      if (medium->channel_count() != media_.front()->channel_count())
        throw InputError("media that are combined must have the same channels");
  }

  int channel_count() const override { return media_.front()->channel_count(); }
  Box bounds() const override;
  std::vector<Box> occupied() const override {
    std::vector<Box> boxes;
    for (const auto& medium : media_)
      for (const Box& box : medium->occupied()) boxes.push_back(box);
    return boxes;
  }
  bool is_grey() const override {
    return std::all_of(media_.begin(), media_.end(), [](const auto& m) { return m->is_grey(); });
  }
  void absorptions(Vec3 world, double* each) const override;
  double largest_absorption(int channel) const override {
    double sum = 0;
    for (const auto& medium : media_) sum += medium->largest_absorption(channel);
    return sum;
  }
  double largest_share(const Box& box) const override;
  double feature_size() const override;
  bool is_costly() const override {
    return std::any_of(media_.begin(), media_.end(), [](const auto& m) { return m->is_costly(); });
  }
  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    run(rays, options, out, counters);
  }
  /// Absorptions add; the temperature is their mean weighted by absorption. Exact where one medium
  /// absorbs; see coefficients() for what several emit.
  MediumSample sample(Vec3 world) const override;
  double source(int channel, double temperature) const override {
    return media_.front()->source(channel, temperature);
  }
  double coefficients(Vec3 world, double* emission) const override;
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override {
    for (const auto& medium : media_) medium->append_breakpoints(ray, t);
  }
  std::string description() const override;

 private:
  /// The span in which a ray can meet one medium.
  struct Extent {
    RaySpan span;
    std::size_t medium;
  };

  template <class Real>
  void run(const RayBatch<Real>& rays, const MediumOptions& options, RadianceBatch<Real> out,
           MediumCounters& counters) const;
  void tighten(const Ray& ray, std::vector<Extent>& extents) const;
  TransferResult merge(const Ray& ray, const Extent* first, const Extent* last,
                       double tolerance) const;
  /// The same where channels differ in absorption: optical thickness per channel, too.
  void merge_each(const Ray& ray, const Extent* first, const Extent* last, double tolerance,
                  std::vector<double>& radiance, std::vector<double>& thickness) const;
  std::vector<double> limits_of(const Ray& ray, const Extent* first, const Extent* last) const;

  std::vector<std::shared_ptr<const Medium>> media_;
};

Box CompositeMedium::bounds() const {
  Box all;
  for (const auto& medium : media_) {
    const Box box = medium->bounds();
    if (box.empty()) continue;
    if (all.empty()) {
      all = box;
      continue;
    }
    all.lower = {std::min(all.lower.x, box.lower.x), std::min(all.lower.y, box.lower.y),
                 std::min(all.lower.z, box.lower.z)};
    all.upper = {std::max(all.upper.x, box.upper.x), std::max(all.upper.y, box.upper.y),
                 std::max(all.upper.z, box.upper.z)};
  }
  return all;
}

double CompositeMedium::feature_size() const {
  double least = media_.front()->feature_size();
  for (const auto& medium : media_) least = std::min(least, medium->feature_size());
  return least;
}

MediumSample CompositeMedium::sample(Vec3 world) const {
  MediumSample sum;
  double weighted = 0;
  for (const auto& medium : media_) {
    const MediumSample here = medium->sample(world);
    sum.absorption += here.absorption;
    weighted += here.absorption * here.temperature;
    sum.temperature = std::max(sum.temperature, here.temperature);
  }
  if (sum.absorption > 0) sum.temperature = weighted / sum.absorption;
  return sum;
}

double CompositeMedium::coefficients(Vec3 world, double* emission) const {
  const auto channels = static_cast<std::size_t>(channel_count());
  std::vector<double> one(channels);
  std::fill_n(emission, channels, 0.0);
  double absorption = 0;
  for (const auto& medium : media_) {
    absorption += medium->coefficients(world, one.data());
    for (std::size_t c = 0; c < channels; ++c) emission[c] += one[c];
  }
  return absorption;
}

std::string CompositeMedium::description() const {
  std::string text = std::to_string(media_.size()) + " media: ";
  for (std::size_t i = 0; i < media_.size(); ++i)
    text += (i ? "; " : "") + media_[i]->description();
  return text;
}

/// Tells whether neighbours in a list sorted by `near` overlap.
bool overlap(const RaySpan& before, const RaySpan& after) {
  return after.near < before.far;
}

/// Boxes overlap long before what is in them does: look at where the fields really begin and end.
void CompositeMedium::tighten(const Ray& ray, std::vector<Extent>& extents) const {
  std::vector<double> t;
  for (Extent& extent : extents) {
    t.clear();
    media_[extent.medium]->append_breakpoints(ray, t);
    if (t.empty()) continue;  // smooth throughout: the box stands
    const auto [low, high] = std::minmax_element(t.begin(), t.end());
    extent.span.near = std::max(extent.span.near, *low);
    extent.span.far = std::min(extent.span.far, *high);
  }
}

void CompositeMedium::absorptions(Vec3 world, double* each) const {
  const auto channels = static_cast<std::size_t>(channel_count());
  std::vector<double> one(channels);
  std::fill_n(each, channels, 0.0);
  for (const auto& medium : media_) {
    medium->absorptions(world, one.data());
    for (std::size_t c = 0; c < channels; ++c) each[c] += one[c];
  }
}

std::vector<double> CompositeMedium::limits_of(const Ray& ray, const Extent* first,
                                               const Extent* last) const {
  RaySpan span = first->span;
  std::vector<double> all;
  for (const Extent* e = first; e != last; ++e) {
    span.far = std::max(span.far, e->span.far);
    media_[e->medium]->append_breakpoints(ray, all);
    all.push_back(e->span.near);
    all.push_back(e->span.far);
  }
  std::sort(all.begin(), all.end());
  std::vector<double> limits{span.near};
  for (const double t : all)
    if (t > limits.back() && t < span.far) limits.push_back(t);
  limits.push_back(span.far);
  return limits;
}

void CompositeMedium::merge_each(const Ray& ray, const Extent* first, const Extent* last,
                                 double tolerance, std::vector<double>& radiance,
                                 std::vector<double>& thickness) const {
  const std::vector<double> limits = limits_of(ray, first, last);
  const auto channels = static_cast<std::size_t>(channel_count());
  std::vector<double> one(channels);
  for (std::size_t c = 0; c < channels; ++c) {
    const TransferResult result = integrate_transfer(
        [&](double t, double* emission) {
          double absorption = 0;
          *emission = 0;
          for (const Extent* e = first; e != last; ++e) {
            if (t < e->span.near || t > e->span.far) continue;
            media_[e->medium]->coefficients(ray.at(t), one.data());
            *emission += one[c];
            media_[e->medium]->absorptions(ray.at(t), one.data());
            absorption += one[c];
          }
          return absorption;
        },
        1, limits, tolerance);
    radiance[c] = result.radiance[0];
    thickness[c] = result.optical_thickness;
  }
}

/// Media that overlap on this ray, integrated together.
TransferResult CompositeMedium::merge(const Ray& ray, const Extent* first, const Extent* last,
                                      double tolerance) const {
  const std::vector<double> limits = limits_of(ray, first, last);
  const auto channels = static_cast<std::size_t>(channel_count());
  std::vector<double> one(channels);
  return integrate_transfer(
      [&](double t, double* emission) {
        std::fill_n(emission, channels, 0.0);
        double absorption = 0;
        for (const Extent* e = first; e != last; ++e) {
          if (t < e->span.near || t > e->span.far) continue;
          absorption += media_[e->medium]->coefficients(ray.at(t), one.data());
          for (std::size_t c = 0; c < channels; ++c) emission[c] += one[c];
        }
        return absorption;
      },
      channel_count(), limits, tolerance);
}

double CompositeMedium::largest_share(const Box& box) const {
  double share = 0;
  for (int c = 0; c < channel_count(); ++c) {
    double here = 0;
    for (const auto& medium : media_)
      here += medium->largest_share(box) * medium->largest_absorption(c);
    if (const double most = largest_absorption(c); most > 0) share = std::max(share, here / most);
  }
  return share;
}

template <class Real>
void CompositeMedium::run(const RayBatch<Real>& rays, const MediumOptions& options,
                          RadianceBatch<Real> out, MediumCounters& counters) const {
  const auto size = static_cast<std::size_t>(rays.size);
  const auto channels = static_cast<std::size_t>(channel_count());
  const auto stride = static_cast<std::size_t>(out.stride);
  const double infinity = std::numeric_limits<double>::infinity();
  const double tolerance = std::is_same_v<Real, float> ? 1e-8 : 1e-12;

  // Every medium alone, as vector code; then per ray their combination. Rows are padded like the
  // batch and aligned like its arrays.
  const std::size_t row = (size + 15) / 16 * 16;
  const bool grey = is_grey();
  const std::size_t passes = grey ? 1 : channels, rows = channels + passes;
  std::vector<Real> storage(media_.size() * rows * row + 16);
  void* start = storage.data();
  std::size_t space = storage.size() * sizeof(Real);
  Real* alone = static_cast<Real*>(std::align(64, space - 15 * sizeof(Real), start, space));
  const auto radiance_of = [&](std::size_t medium, std::size_t channel) {
    return alone + (medium * rows + channel) * row;
  };
  MediumCounters parts;
  for (std::size_t m = 0; m < media_.size(); ++m)
    media_[m]->integrate(
        rays, options,
        RadianceBatch<Real>{radiance_of(m, 0), static_cast<int>(row), radiance_of(m, channels),
                            grey ? 0 : static_cast<int>(row)},
        parts);
  parts.rays = 0;

  std::vector<Extent> extents;
  std::vector<double> radiance(channels), transmittance(passes);
  std::vector<double> merged_radiance(channels), merged_thickness(channels);
  for (std::size_t i = 0; i < size; ++i) {
    const Ray ray{rays.anchor + Vec3{rays.x[i], rays.y[i], rays.z[i]},
                  {rays.dx[i], rays.dy[i], rays.dz[i]}};
    const double near = rays.t_near ? static_cast<double>(rays.t_near[i]) : -infinity;
    const double far = rays.t_far ? static_cast<double>(rays.t_far[i]) : infinity;
    extents.clear();
    for (std::size_t m = 0; m < media_.size(); ++m) {
      bool dark = true;
      for (std::size_t p = 0; p < passes; ++p)
        dark = dark && radiance_of(m, channels + p)[i] == Real(1);
      for (std::size_t c = 0; c < channels; ++c) dark = dark && radiance_of(m, c)[i] == Real(0);
      const RaySpan span = clip_to_box(media_[m]->bounds(), ray, near, far);
      if (!dark && !span.empty()) extents.push_back({span, m});
    }
    parts.rays += extents.empty() ? 0 : 1;
    const auto nearer = [](const Extent& a, const Extent& b) { return a.span.near < b.span.near; };
    const auto disjoint = [&] {
      std::sort(extents.begin(), extents.end(), nearer);
      double reached = -infinity;
      for (const Extent& e : extents) {
        if (e.span.near < reached) return false;
        reached = std::max(reached, e.span.far);
      }
      return true;
    };
    if (!disjoint()) {
      tighten(ray, extents);
      disjoint();
    }

    std::fill(radiance.begin(), radiance.end(), 0.0);
    std::fill(transmittance.begin(), transmittance.end(), 1.0);
    for (std::size_t e = 0; e < extents.size();) {
      RaySpan reached = extents[e].span;
      std::size_t end = e + 1;
      for (; end < extents.size() && overlap(reached, extents[end].span); ++end)
        reached.far = std::max(reached.far, extents[end].span.far);
      if (end == e + 1) {
        const std::size_t m = extents[e].medium;
        for (std::size_t c = 0; c < channels; ++c)
          radiance[c] += transmittance[grey ? 0 : c] * static_cast<double>(radiance_of(m, c)[i]);
        for (std::size_t p = 0; p < passes; ++p)
          transmittance[p] *= static_cast<double>(radiance_of(m, channels + p)[i]);
      } else if (!grey) {
        merge_each(ray, &extents[e], &extents[e] + (end - e), tolerance, merged_radiance,
                   merged_thickness);
        for (std::size_t c = 0; c < channels; ++c) {
          radiance[c] += transmittance[c] * merged_radiance[c];
          transmittance[c] *= std::exp(-merged_thickness[c]);
        }
        parts.cells += 1;
      } else {
        const TransferResult merged = merge(ray, &extents[e], &extents[e] + (end - e), tolerance);
        for (std::size_t c = 0; c < channels; ++c)
          radiance[c] += transmittance[0] * merged.radiance[c];
        transmittance[0] *= std::exp(-merged.optical_thickness);
        parts.cells += 1;
      }
      e = end;
    }
    for (std::size_t c = 0; c < channels; ++c)
      out.radiance[c * stride + i] = static_cast<Real>(radiance[c]);
    for (std::size_t c = 0; c < (out.transmittance_stride ? channels : 1); ++c)
      out.transmittance[c * static_cast<std::size_t>(out.transmittance_stride) + i] =
          static_cast<Real>(transmittance[grey ? 0 : c]);
  }
  counters += parts;
}

}  // namespace

std::shared_ptr<const Medium> make_composite_medium(
    std::vector<std::shared_ptr<const Medium>> media) {
  if (media.empty()) throw InputError("a scene needs at least one flame");
  if (media.size() == 1) return std::move(media.front());
  return std::make_shared<CompositeMedium>(std::move(media));
}

}  // namespace plenoflame
