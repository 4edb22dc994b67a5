#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "plenoflame/math/ray_span.h"
#include "plenoflame/media/voxel_medium.h"
#include "support/approx.h"
#include "support/isas.h"

/// Voxel fields, rays and an integrator that shares nothing with the medium under test: fields are
/// looked up in a std::map of samples, every lattice plane along the ray ends a panel, and panels
/// are halved until an 8-point Gauss rule settles.
namespace plenoflame::test {

using SampleFunction = std::function<float(int, int, int)>;

/// Samples i in [low, high) per axis, in whole bricks; outside of them the field is background.
inline VoxelField make_field(std::array<int, 3> low, std::array<int, 3> high,
                             const SampleFunction& value, const AffineTransform& transform,
                             float background = 0) {
  VoxelField field;
  field.name = "test";
  field.background = background;
  field.index_to_world = transform;
  const auto brick = [](int i) { return static_cast<int>(std::floor(i / 8.0)); };
  for (int bi = brick(low[0]); bi <= brick(high[0] - 1); ++bi)
    for (int bj = brick(low[1]); bj <= brick(high[1] - 1); ++bj)
      for (int bk = brick(low[2]); bk <= brick(high[2] - 1); ++bk) {
        std::vector<float> values;
        bool any = false;
        for (int v = 0; v < 512; ++v) {
          const int i = 8 * bi + v / 64, j = 8 * bj + v / 8 % 8, k = 8 * bk + v % 8;
          const bool in = i >= low[0] && i < high[0] && j >= low[1] && j < high[1] && k >= low[2] &&
                          k < high[2];
          values.push_back(in ? value(i, j, k) : background);
          any = any || values.back() != background;
        }
        if (!any) continue;
        field.brick_origins.push_back({8 * bi, 8 * bj, 8 * bk});
        field.values.insert(field.values.end(), values.begin(), values.end());
      }
  return field;
}

inline AffineTransform scaled(double spacing, Vec3 translation = {}) {
  AffineTransform t;
  t.linear = {{{{spacing, 0, 0}, {0, spacing, 0}, {0, 0, spacing}}}};
  t.translation = translation;
  return t;
}

/// Inverse by Cramer's rule in long double.
struct InverseMap {
  std::array<std::array<long double, 3>, 3> m{};
  std::array<long double, 3> translation{};

  explicit InverseMap(const AffineTransform& map) {
    const auto& r = map.linear.rows;
    const long double a[3][3] = {
        {r[0].x, r[0].y, r[0].z}, {r[1].x, r[1].y, r[1].z}, {r[2].x, r[2].y, r[2].z}};
    long double det = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int p = (i + 1) % 3, q = (i + 2) % 3, s = (j + 1) % 3, t = (j + 2) % 3;
        m[j][i] = a[p][s] * a[q][t] - a[p][t] * a[q][s];
        if (j == 0) det += a[i][0] * m[0][i];
      }
    for (auto& row : m)
      for (auto& v : row) v /= det;
    translation = {map.translation.x, map.translation.y, map.translation.z};
  }
  std::array<long double, 3> vector(std::array<long double, 3> v) const {
    std::array<long double, 3> out{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out[i] += m[i][j] * v[j];
    return out;
  }
  std::array<long double, 3> point(Vec3 p) const {
    return vector({p.x - translation[0], p.y - translation[1], p.z - translation[2]});
  }
};

/// A field along a ray, from a map of samples.
class FieldOnRay {
 public:
  FieldOnRay(const VoxelField& field, VoxelInterpolation mode, const Ray& ray)
      : mode_(mode), background_(field.background) {
    for (std::size_t b = 0; b < field.brick_origins.size(); ++b)
      for (int v = 0; v < 512; ++v) {
        const auto& o = field.brick_origins[b];
        samples_[{o[0] + v / 64, o[1] + v / 8 % 8, o[2] + v % 8}] = field.values[b * 512 + v];
        const std::array<int, 3> at{o[0] + v / 64, o[1] + v / 8 % 8, o[2] + v % 8};
        for (int a = 0; a < 3; ++a) {
          low_[a] = std::min(low_[a], at[a] - 1);
          high_[a] = std::max(high_[a], at[a] + 1);
        }
      }
    const InverseMap map(field.index_to_world);
    origin_ = map.point(ray.origin);
    direction_ = map.vector({ray.direction.x, ray.direction.y, ray.direction.z});
  }

  long double at(long double t) const {
    std::array<int, 3> whole;
    std::array<long double, 3> part;
    for (int a = 0; a < 3; ++a) {
      const long double p = origin_[a] + t * direction_[a];
      if (mode_ == VoxelInterpolation::constant) {
        whole[a] = static_cast<int>(std::floor(p + 0.5L));
        part[a] = 0;
      } else {
        whole[a] = static_cast<int>(std::floor(p));
        part[a] = p - whole[a];
      }
    }
    long double sum = 0;
    for (int m = 0; m < 8; ++m) {
      long double w = 1;
      std::array<int, 3> at{};
      for (int a = 0; a < 3; ++a) {
        const bool up = m >> a & 1;
        w *= up ? part[a] : 1 - part[a];
        at[a] = whole[a] + up;
      }
      if (w != 0) sum += w * sample(at);
    }
    return sum;
  }

  /// All t between which the field is smooth.
  void append_planes(double t0, double t1, std::vector<long double>& t) const {
    const long double shift = mode_ == VoxelInterpolation::constant ? 0.5L : 0.0L;
    for (int a = 0; a < 3; ++a) {
      if (direction_[a] == 0) continue;
      for (int p = low_[a] - 1; p <= high_[a] + 1; ++p) {
        const long double at = (p - shift - origin_[a]) / direction_[a];
        if (at > t0 && at < t1) t.push_back(at);
      }
    }
  }

 private:
  long double sample(const std::array<int, 3>& at) const {
    const auto found = samples_.find(at);
    return found == samples_.end() ? background_ : found->second;
  }
  VoxelInterpolation mode_;
  long double background_;
  std::map<std::array<int, 3>, float> samples_;
  std::array<int, 3> low_{1 << 28, 1 << 28, 1 << 28}, high_{-(1 << 28), -(1 << 28), -(1 << 28)};
  std::array<long double, 3> origin_{}, direction_{};
};

using Source = std::function<long double(long double)>;

inline long double total_source(long double t) {
  return 5.670374419184429453e-8L / 3.14159265358979323846264L * t * t * t * t;
}

/// Planck's law at one wavelength times a width [W/(m^2 sr)].
inline Source line_source(double wavelength, double width) {
  return [=](long double t) {
    if (t <= 0) return 0.0L;
    const long double c1 = 1.1910429723971884140794892e-16L, c2 = 1.438776877503933802146671e-2L;
    return width * c1 / std::pow(static_cast<long double>(wavelength), 5) /
           std::expm1(c2 / (wavelength * t));
  };
}

struct Reference {
  long double radiance = 0;
  long double optical_thickness = 0;
};

struct VoxelFlame {
  const VoxelField &temperature, &absorption;
  VoxelInterpolation mode;
  const VoxelField* line = nullptr;  ///< its emission, if any
};

/// dL/ds = kappa (S - L) + j along the ray, front to back.
inline Reference integrate_voxels(const VoxelFlame& flame, const Ray& ray, const RaySpan& span,
                                  const Source& source) {
  const auto& [temperature, absorption, mode, line] = flame;
  const FieldOnRay temp(temperature, mode, ray), kappa(absorption, mode, ray);
  const FieldOnRay glow(line ? *line : VoxelField{}, mode, ray);
  std::vector<long double> t{span.near, span.far};
  temp.append_planes(span.near, span.far, t);
  kappa.append_planes(span.near, span.far, t);
  if (line) glow.append_planes(span.near, span.far, t);
  std::sort(t.begin(), t.end());
  // 8-point Gauss-Legendre on [-1, 1].
  static const long double x[4] = {
      0.183434642495649804939476142360L, 0.525532409916328985817739049189L,
      0.796666477413626739591553936476L, 0.960289856497536231683560868569L};
  static const long double w[4] = {
      0.362683783378361982965150449277L, 0.313706645877887287337962201987L,
      0.222381034453374470544355994426L, 0.101228536290376259152531354310L};
  const auto gauss = [&](long double a, long double b, const auto& f) {
    long double sum = 0;
    for (int i = 0; i < 4; ++i) {
      const long double m = (a + b) / 2, h = (b - a) / 2;
      sum += w[i] * (f(m - h * x[i]) + f(m + h * x[i]));
    }
    return sum * (b - a) / 2;
  };
  const auto kappa_at = [&](long double s) { return kappa.at(s); };
  Reference result;
  // Emission of [a, b], seen from a.
  const auto emission = [&](long double a, long double b) {
    return gauss(a, b, [&](long double s) {
      const long double line_emission = line ? glow.at(s) : 0.0L;
      return (kappa.at(s) * source(temp.at(s)) + line_emission) * std::exp(-gauss(a, s, kappa_at));
    });
  };
  const std::function<long double(long double, long double, long double, int)> adapt =
      [&](long double a, long double b, long double whole, int depth) -> long double {
    const long double m = (a + b) / 2, first = emission(a, m), second = emission(m, b);
    const long double through = std::exp(-gauss(a, m, kappa_at));
    const long double sum = first + through * second;
    if (depth > 40 || std::fabs(sum - whole) <= 1e-14L * std::fabs(sum)) return sum;
    return adapt(a, m, first, depth + 1) + through * adapt(m, b, second, depth + 1);
  };
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const long double a = t[i], b = t[i + 1];
    if (!(b > a)) continue;
    const long double tau = gauss(a, b, kappa_at);
    if (tau == 0 && !line) continue;
    result.radiance += std::exp(-result.optical_thickness) * adapt(a, b, emission(a, b), 0);
    result.optical_thickness += tau;
  }
  return result;
}

/// Results of the medium under test for some rays.
struct Seen {
  std::vector<std::vector<double>> radiance;  ///< [channel][ray]
  std::vector<double> transmittance;
  MediumCounters counters;
};

template <class Real>
Seen see(const Medium& medium, const std::vector<Ray>& rays, const MediumOptions& options,
         double t_near = -1e30, double t_far = 1e30, Vec3 anchor = {}) {
  const int count = static_cast<int>(rays.size());
  const int padded = (count + kRayPadding - 1) / kRayPadding * kRayPadding;
  std::array<std::vector<Real>, 8> columns;
  for (auto& c : columns) c.resize(padded);
  for (int i = 0; i < padded; ++i) {
    const Ray& ray = rays[std::min(i, count - 1)];
    // The point of the line nearest to the anchor, so that single precision suffices.
    const double back = dot(anchor - ray.origin, ray.direction);
    const Vec3 p = ray.at(back) - anchor;
    const double values[8] = {
        p.x,           p.y,         p.z, ray.direction.x, ray.direction.y, ray.direction.z,
        t_near - back, t_far - back};
    for (int c = 0; c < 8; ++c) columns[c][i] = static_cast<Real>(values[c]);
  }
  RayBatch<Real> batch;
  batch.anchor = anchor;
  batch.x = columns[0].data();
  batch.y = columns[1].data();
  batch.z = columns[2].data();
  batch.dx = columns[3].data();
  batch.dy = columns[4].data();
  batch.dz = columns[5].data();
  batch.t_near = columns[6].data();
  batch.t_far = columns[7].data();
  Seen seen;
  std::vector<Real> radiance(static_cast<std::size_t>(padded) * medium.channel_count());
  std::vector<Real> transmittance(padded);
  batch.size = padded;
  medium.integrate(batch, options, {radiance.data(), padded, transmittance.data()}, seen.counters);
  for (int c = 0; c < medium.channel_count(); ++c)
    seen.radiance.emplace_back(radiance.begin() + c * padded,
                               radiance.begin() + c * padded + count);
  seen.transmittance.assign(transmittance.begin(), transmittance.begin() + count);
  return seen;
}

inline MediumOptions with(Isa isa, bool skip = true) {
  MediumOptions options;
  options.isa = isa;
  options.skip = skip;
  return options;
}

}  // namespace plenoflame::test
