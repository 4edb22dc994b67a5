#include "plenoflame/media/layered_medium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "base/isa_dispatch.h"
#include "media/absorption_factors.h"
#include "media/layered_kernel.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kStackLayers = 8;  ///< scratch for this number of layers fits on the stack

/// Tells whether ellipsoid `inner` lies inside `outer`; both have their axes along x, y, z. The
/// criterion is the largest value over the inner surface of |outer^-1(p)|^2 = sum (e_i + r_i
/// u_i)^2, |u| = 1. It equals the minimum over s > max r_i^2 of the dual s + sum e_i^2 + sum (e_i
/// r_i)^2 / (s - r_i^2) (trust region problem; Stern and Wolkowicz, SIAM J. Optim. 5 (1995) 286).
/// Every s bounds it from above, so "inside" is never claimed wrongly.
bool lies_inside(const EllipsoidLayer& inner, const EllipsoidLayer& outer) {
  const Vec3 d = inner.centre - outer.centre;
  const double e[3] = {d.x / outer.semi_axes.x, d.y / outer.semi_axes.y, d.z / outer.semi_axes.z};
  const double r[3] = {inner.semi_axes.x / outer.semi_axes.x, inner.semi_axes.y / outer.semi_axes.y,
                       inner.semi_axes.z / outer.semi_axes.z};
  const double lowest = std::max({r[0] * r[0], r[1] * r[1], r[2] * r[2]});
  const auto dual = [&](double s) {
    double sum = s;
    for (int i = 0; i < 3; ++i) {
      const double product = e[i] * r[i];
      sum += e[i] * e[i];
      if (product != 0) sum += product * product / (s - r[i] * r[i]);
    }
    return sum;
  };
  if (!(lowest < 1)) return false;
  // The dual is convex: golden section over (lowest, 1]; above 1 it exceeds 1 anyway.
  double a = lowest, b = 1;
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 80; ++i) {
    const double left = b - golden * (b - a), right = a + golden * (b - a);
    (dual(left) < dual(right) ? b : a) = dual(left) < dual(right) ? right : left;
  }
  return dual(b) <= 1;
}

template <class Real>
struct CompiledLayers {
  std::vector<Real> geometry, absorption, sources;
};

class LayeredMedium final : public Medium {
 public:
  LayeredMedium(std::vector<EllipsoidLayer> layers, const RigidTransform& to_world,
                std::vector<SourceFunction> channels, std::vector<double> absorption_factors);

  int channel_count() const override { return static_cast<int>(channels_.size()); }
  bool is_grey() const override { return factors_.empty(); }
  double largest_absorption(int channel) const override {
    double most = 0;
    for (const EllipsoidLayer& layer : layers_) most = std::max(most, layer.absorption);
    return most * (factors_.empty() ? 1 : factors_[static_cast<std::size_t>(channel)]);
  }
  double largest_share(const Box& box) const override;
  Box bounds() const override { return bounds_; }
  std::vector<Box> occupied() const override;
  double feature_size() const override;

  void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                 RadianceBatch<float> out, MediumCounters& counters) const override {
    run(single_, rays, options, out, counters);
  }
  void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                 RadianceBatch<double> out, MediumCounters& counters) const override {
    run(double_, rays, options, out, counters);
  }

  MediumSample sample(Vec3 world) const override;
  double source(int channel, double temperature) const override {
    return channels_[static_cast<std::size_t>(channel)](temperature);
  }
  void absorptions(Vec3 world, double* each) const override {
    const double absorption = sample(world).absorption;
    for (std::size_t c = 0; c < channels_.size(); ++c)
      each[c] = absorption * (factors_.empty() ? 1 : factors_[c]);
  }
  void append_breakpoints(const Ray& ray, std::vector<double>& t) const override;
  std::string description() const override;

 private:
  template <class Real>
  CompiledLayers<Real> compile() const;
  template <class Real>
  void run(const CompiledLayers<Real>& compiled, const RayBatch<Real>& rays,
           const MediumOptions& options, RadianceBatch<Real> out, MediumCounters& counters) const;

  std::vector<EllipsoidLayer> layers_;
  RigidTransform to_world_, to_local_;
  std::vector<SourceFunction> channels_;
  std::vector<double> factors_;  ///< on the absorption, per channel; empty: grey
  Vec3 middle_;                  ///< local; the kernel's origin
  Box bounds_;
  bool nested_ = false;
  CompiledLayers<float> single_;
  CompiledLayers<double> double_;
};

void check(const std::vector<EllipsoidLayer>& layers, const std::vector<SourceFunction>& channels) {
  if (layers.empty()) throw InputError("a layered flame needs at least one layer");
  if (channels.empty()) throw InputError("a medium needs at least one channel");
  const auto positive = [](double v) { return v > 0 && std::isfinite(v); };
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const EllipsoidLayer& layer = layers[i];
    const std::string who = "layer " + std::to_string(i + 1) + ": ";
    if (!std::isfinite(layer.centre.x) || !std::isfinite(layer.centre.y) ||
        !std::isfinite(layer.centre.z))
      throw InputError(who + "the centre must be finite");
    if (!positive(layer.semi_axes.x) || !positive(layer.semi_axes.y) ||
        !positive(layer.semi_axes.z))
      throw InputError(who + "all three semi-axes must be above 0 and finite");
    if (!(layer.temperature >= 0) || !std::isfinite(layer.temperature))
      throw InputError(who + "the temperature must be 0 K or more and finite");
    if (!(layer.absorption >= 0) || layer.absorption > std::numeric_limits<float>::max())
      throw InputError(who + "the absorption must be 0 1/m or more and finite");
    for (const SourceFunction& channel : channels)
      if (!(channel(layer.temperature) <= 0.1 * std::numeric_limits<float>::max()))
        throw InputError(
            who + "so hot that its radiance exceeds single precision; lower the temperature");
  }
}

LayeredMedium::LayeredMedium(std::vector<EllipsoidLayer> layers, const RigidTransform& to_world,
                             std::vector<SourceFunction> channels,
                             std::vector<double> absorption_factors)
    : layers_(std::move(layers)),
      to_world_(to_world),
      to_local_(to_world.inverse()),
      channels_(std::move(channels)),
      factors_(grey_or_checked(std::move(absorption_factors), channels_.size())) {
  check(layers_, channels_);
  Box local;
  for (const EllipsoidLayer& layer : layers_) {
    const Vec3 low = layer.centre - layer.semi_axes, high = layer.centre + layer.semi_axes;
    const auto join = [](Box a, Vec3 lower, Vec3 upper) {
      if (a.empty()) return Box{lower, upper};
      return Box{{std::min(a.lower.x, lower.x), std::min(a.lower.y, lower.y),
                  std::min(a.lower.z, lower.z)},
                 {std::max(a.upper.x, upper.x), std::max(a.upper.y, upper.y),
                  std::max(a.upper.z, upper.z)}};
    };
    local = join(local, low, high);
    const auto reach = [&](Vec3 row) {
      return std::hypot(row.x * layer.semi_axes.x, row.y * layer.semi_axes.y,
                        row.z * layer.semi_axes.z);
    };
    const auto& rows = to_world_.rotation.rows;
    const Vec3 half{reach(rows[0]), reach(rows[1]), reach(rows[2])};
    const Vec3 centre = to_world_.point(layer.centre);
    bounds_ = join(bounds_, centre - half, centre + half);
  }
  middle_ = 0.5 * (local.lower + local.upper);
  nested_ = true;
  for (std::size_t i = 0; i + 1 < layers_.size(); ++i)
    nested_ = nested_ && lies_inside(layers_[i], layers_[i + 1]);
  single_ = compile<float>();
  double_ = compile<double>();
}

template <class Real>
CompiledLayers<Real> LayeredMedium::compile() const {
  CompiledLayers<Real> c;
  for (const EllipsoidLayer& layer : layers_) {
    const Vec3 p = layer.centre - middle_, a = layer.semi_axes;
    for (const double v : {p.x / a.x, p.y / a.y, p.z / a.z, 1 / a.x, 1 / a.y, 1 / a.z})
      c.geometry.push_back(static_cast<Real>(v));
  }
  for (std::size_t i = 0; i < (factors_.empty() ? 1 : channels_.size()); ++i)
    for (const EllipsoidLayer& layer : layers_)
      c.absorption.push_back(
          static_cast<Real>(factors_.empty() ? layer.absorption : factors_[i] * layer.absorption));
  for (const SourceFunction& channel : channels_)
    for (const EllipsoidLayer& layer : layers_)
      c.sources.push_back(static_cast<Real>(channel(layer.temperature)));
  return c;
}

std::vector<Box> LayeredMedium::occupied() const {
  constexpr int kParts = 24;  // of each axis
  std::vector<Box> boxes;
  const auto& rows = to_world_.rotation.rows;
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const EllipsoidLayer& layer = layers_[l];
    // The last of nested layers holds the others.
    if (!(layer.absorption > 0) ||
        (nested_ && l + 1 < layers_.size() && layers_.back().absorption > 0))
      continue;
    // In units of the semi-axes: how far from the centre a part's nearest point is.
    const auto nearest = [](int part) {
      const double low = 2.0 * part / kParts - 1, high = 2.0 * (part + 1) / kParts - 1;
      return low > 0 ? low : high < 0 ? -high : 0.0;
    };
    const Vec3 a = layer.semi_axes, half = (1.0 / kParts) * a;
    const Vec3 reach{std::fabs(rows[0].x) * half.x + std::fabs(rows[0].y) * half.y +
                         std::fabs(rows[0].z) * half.z,
                     std::fabs(rows[1].x) * half.x + std::fabs(rows[1].y) * half.y +
                         std::fabs(rows[1].z) * half.z,
                     std::fabs(rows[2].x) * half.x + std::fabs(rows[2].y) * half.y +
                         std::fabs(rows[2].z) * half.z};
    for (int i = 0; i < kParts; ++i)
      for (int j = 0; j < kParts; ++j)
        for (int k = 0; k < kParts; ++k) {
          const double x = nearest(i), y = nearest(j), z = nearest(k);
          if (x * x + y * y + z * z > 1) continue;
          const auto middle = [](int part, double axis) {
            return axis * ((2.0 * part + 1) / kParts - 1);
          };
          const Vec3 centre =
              to_world_.point(layer.centre + Vec3{middle(i, a.x), middle(j, a.y), middle(k, a.z)});
          boxes.push_back({centre - reach, centre + reach});
        }
  }
  return boxes;
}

double LayeredMedium::largest_share(const Box& box) const {
  // Layers that may be in the box are those that reach into its circumscribed sphere, seen in units
  // of their semi-axes.
  const Vec3 centre = to_local_.point(0.5 * (box.lower + box.upper));
  const double radius = 0.5 * length(box.upper - box.lower);
  double most = 0, here = 0;
  for (const EllipsoidLayer& layer : layers_) {
    most = std::max(most, layer.absorption);
    const Vec3 p = centre - layer.centre, a = layer.semi_axes;
    const double least = std::min({a.x, a.y, a.z});
    if (length(Vec3{p.x / a.x, p.y / a.y, p.z / a.z}) <= 1 + radius / least)
      here = std::max(here, layer.absorption);
  }
  return most > 0 ? here / most : 0;
}

double LayeredMedium::feature_size() const {
  double least = std::numeric_limits<double>::infinity();
  for (const EllipsoidLayer& layer : layers_)
    least = std::min({least, layer.semi_axes.x, layer.semi_axes.y, layer.semi_axes.z});
  return least;
}

void dispatch(LayeredTask<double>& task, Isa) {
  baseline::integrate_layers(task);
}
void dispatch(LayeredTask<float>& task, Isa isa) {
  PLENOFLAME_DISPATCH(isa, kernels::integrate_layers(task);)
}

template <class Real>
void LayeredMedium::run(const CompiledLayers<Real>& compiled, const RayBatch<Real>& rays,
                        const MediumOptions& options, RadianceBatch<Real> out,
                        MediumCounters& counters) const {
  LayeredTask<Real> task;
  task.layers = static_cast<int>(layers_.size());
  task.channels = channel_count();
  task.nested = nested_;
  task.skip = options.skip;
  task.grey = factors_.empty();
  task.transmittance_stride = out.transmittance_stride;
  task.rotated = !(to_local_.rotation == Mat3{});
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 row = to_local_.rotation.rows[i];
    task.rotation[3 * i] = static_cast<Real>(row.x);
    task.rotation[3 * i + 1] = static_cast<Real>(row.y);
    task.rotation[3 * i + 2] = static_cast<Real>(row.z);
  }
  task.geometry = compiled.geometry.data();
  task.absorption = compiled.absorption.data();
  task.sources = compiled.sources.data();
  task.size = rays.size;
  const Vec3 anchor = to_local_.point(rays.anchor) - middle_;
  task.anchor[0] = static_cast<Real>(anchor.x);
  task.anchor[1] = static_cast<Real>(anchor.y);
  task.anchor[2] = static_cast<Real>(anchor.z);
  task.position[0] = rays.x, task.position[1] = rays.y, task.position[2] = rays.z;
  task.direction[0] = rays.dx, task.direction[1] = rays.dy, task.direction[2] = rays.dz;
  task.t_near = rays.t_near, task.t_far = rays.t_far;
  task.radiance = out.radiance, task.stride = out.stride, task.transmittance = out.transmittance;

  if (task.layers <= kStackLayers) {
    alignas(64) Real scratch[layered_scratch(kStackLayers)];
    task.scratch = scratch;
    dispatch(task, options.isa);
  } else {
    struct Free {
      void operator()(Real* p) const { ::operator delete[](p, std::align_val_t(64)); }
    };
    const auto size = static_cast<std::size_t>(layered_scratch(task.layers));
    const std::unique_ptr<Real[], Free> scratch(new (std::align_val_t(64)) Real[size]);
    task.scratch = scratch.get();
    dispatch(task, options.isa);
  }
  counters.rays += static_cast<double>(task.hits);
  counters.cells += static_cast<double>(task.intervals);
}

MediumSample LayeredMedium::sample(Vec3 world) const {
  const Vec3 p = to_local_.point(world);
  for (const EllipsoidLayer& layer : layers_) {
    const Vec3 q = p - layer.centre;
    const Vec3 u{q.x / layer.semi_axes.x, q.y / layer.semi_axes.y, q.z / layer.semi_axes.z};
    if (dot(u, u) <= 1) return {layer.temperature, layer.absorption};
  }
  return {};
}

void LayeredMedium::append_breakpoints(const Ray& ray, std::vector<double>& t) const {
  const Vec3 origin = to_local_.point(ray.origin), d = to_local_.direction(ray.direction);
  for (const EllipsoidLayer& layer : layers_) {
    const Vec3 a = layer.semi_axes;
    const double nearest = dot(layer.centre - origin, d);
    const Vec3 p = origin + nearest * d - layer.centre;
    const Vec3 u{p.x / a.x, p.y / a.y, p.z / a.z}, v{d.x / a.x, d.y / a.y, d.z / a.z};
    const double s = -dot(u, v) / dot(v, v);
    const Vec3 q = u + s * v;
    const double inside = 1 - dot(q, q);
    if (!(inside > 0)) continue;
    const double half = std::sqrt(inside / dot(v, v));
    t.push_back(nearest + s - half);
    t.push_back(nearest + s + half);
  }
}

std::string LayeredMedium::description() const {
  const std::string count = std::to_string(layers_.size());
  if (layers_.size() == 1) return "one homogeneous ellipsoid, integrated exactly";
  return count + (nested_ ? " nested" : " overlapping") +
         " homogeneous ellipsoids, integrated exactly";
}

}  // namespace

std::unique_ptr<Medium> make_layered_medium(std::vector<EllipsoidLayer> layers,
                                            const RigidTransform& to_world,
                                            std::vector<SourceFunction> channels,
                                            std::vector<double> absorption_factors) {
  return std::make_unique<LayeredMedium>(std::move(layers), to_world, std::move(channels),
                                         std::move(absorption_factors));
}

}  // namespace plenoflame
