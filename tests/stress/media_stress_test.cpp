// Layered flames, the reference integrator and composites where they are hardest.
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "core/media/field_medium.h"
#include "core/media/layered_reference.h"
#include "core/media/ray_list.h"
#include "plenoflame/base/isa.h"
#include "plenoflame/media/layered_medium.h"
#include "stress/stress_table.h"

namespace plenoflame::media_stress_test {
namespace {

using test::Generator;
using test::RayList;
using test::StressCase;
using test::text;

constexpr const char* kArea = "Layered flames and the reference integrator";
constexpr double kInf = std::numeric_limits<double>::infinity();
const SourceFunction kTotal = SourceFunction::total();

std::vector<MediumOptions> all_options() {
  std::vector<MediumOptions> list;
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (is_supported(isa)) list.push_back({isa, true});
  return list;
}

template <class Real>
void one_layer(const std::string& precision, double bound) {
  StressCase radiance(kArea, "one layer, tau 1e-12 to 1e6, radiance, " + precision + " [relative]",
                      "closed form", bound);
  for (double tau = 1e-12; tau < 1.01e6; tau *= 1.3) {
    const auto medium = make_layered_medium({{{}, {0.5, 0.5, 0.5}, 1700, tau}}, {}, {kTotal});
    RayList<Real> rays;
    rays.add({}, {0, 1, 0});
    for (const MediumOptions& options : all_options())
      radiance.add(
          static_cast<double>(
              rays.integrate(*medium, options).radiance[0][0] / (-expm1l(-tau) * kTotal(1700)) - 1),
          text("tau =", tau));
  }
}

TEST(MediaStress, OneLayer) {
  one_layer<float>("single", 5e-7);
  one_layer<double>("double", 2e-15);
}

// 60 concentric spheres of the same substance are one sphere.
template <class Real>
void many_layers(const std::string& precision, double bound) {
  StressCase radiance(
      kArea, "60 nested layers of one substance, tau 1e-9 to 1e4, " + precision + " [relative]",
      "closed form", bound);
  for (double tau = 1e-9; tau < 1.01e4; tau *= 10) {
    std::vector<EllipsoidLayer> layers;
    for (int k = 1; k <= 60; ++k) layers.push_back({{}, {k / 120., k / 120., k / 120.}, 1700, tau});
    const auto medium = make_layered_medium(layers, {}, {kTotal});
    RayList<Real> rays;
    for (double b = 0; b < 0.45; b += 0.03125) rays.add({b, 0, 0}, {0, 0, 1});
    for (const MediumOptions& options : all_options()) {
      const auto r = rays.integrate(*medium, options);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const double b = 0.03125 * static_cast<double>(i);
        const long double chord = 2 * sqrtl(0.25L - b * b);
        radiance.add(
            static_cast<double>(r.radiance[0][i] / (-expm1l(-tau * chord) * kTotal(1700)) - 1),
            text("tau =", tau) + text(", b/R =", 2 * b));
      }
    }
  }
}

TEST(MediaStress, ManyLayers) {
  many_layers<float>("single", 3e-6);
  many_layers<double>("double", 1e-14);
}

// Offsets within 1e-1 to 1e-12 of the radius: what counts is the error of the chord, squared, over
// the radius, squared.
template <class Real>
void tangents(const std::string& precision, double bound) {
  StressCase chord(kArea,
                   "rays tangent to an ellipsoid to 1e-12 of its radius, " + precision +
                       " [chord^2 over axis^2]",
                   "closed form", bound);
  const auto medium = make_layered_medium({{{}, {0.01, 0.02, 0.04}, 1700, 1e-3}}, {}, {kTotal});
  RayList<Real> rays;
  for (double d = 1e-1; d > 1e-12; d *= 0.8)
    for (const double side : {-1.0, 1.0}) rays.add({0, 0.02 * (1 + side * d), 0}, {1, 0, 0});
  for (const MediumOptions& options : all_options()) {
    const auto r = rays.integrate(*medium, options);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const long double u = static_cast<long double>(rays.ray(i).origin.y) / 0.02L;
      const long double exact = u < 1 ? 4 * (1 - u) * (1 + u) : 0;
      const long double tau = r.radiance[0][i] / static_cast<long double>(kTotal(1700));
      const long double found = -log1pl(-tau) / 1e-3L / 0.01L;
      chord.add(static_cast<double>(found * found - exact),
                text("offset - 1 =", static_cast<double>(u - 1)));
    }
  }
}

TEST(MediaStress, Tangents) {
  tangents<float>("single", 4e-6);
  tangents<double>("double", 1e-14);
}

// Flames of 1 um to 100 m at 1 mm to 10 km, the rays' points near the flame.
TEST(MediaStress, SizesAndDistances) {
  StressCase radiance(kArea, "flames of 1 um to 100 m at 1 mm to 10 km, single [source function]",
                      "definition, long double", 3e-6);
  Generator g(1);
  for (double size = 1e-6; size < 101; size *= 10)
    for (double distance = 1e-3; distance < 1.01e4; distance *= 10) {
      std::vector<EllipsoidLayer> layers;
      for (int k = 0; k < 3; ++k)
        layers.push_back({g.point(0.2 * size),
                          {0.5 * size, 0.3 * size, 0.4 * size},
                          1000 + 300. * k,
                          g.logarithmic(0.1, 3) / size});
      const RigidTransform place{rotation_xyz(g.point(3)), {distance, 0, 0}};
      const auto medium = make_layered_medium(layers, place, {kTotal});
      RayList<float> rays(place.translation);
      for (int i = 0; i < 64; ++i) {
        const Vec3 target = place.translation + g.point(0.2 * size);
        rays.add(target, normalize(target), -length(target));
      }
      for (const MediumOptions& options : all_options()) {
        const auto r = rays.integrate(*medium, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const auto exact =
              test::layered_reference(layers, place, kTotal, rays.ray(i), rays.near(i), kInf);
          radiance.add(static_cast<double>((r.radiance[0][i] - exact.radiance) / kTotal(1600)),
                       text("size", size) + text(" m, distance", distance) + " m");
        }
      }
    }
}

TEST(MediaStress, ReferenceIntegrator) {
  StressCase radiance(kArea,
                      "reference integrator, Gaussian absorption, tau 1e-10 to 1e5 [relative]",
                      "closed form (erf)", 1e-10);
  for (double peak = 1e-9; peak < 1e6; peak *= 3) {
    const test::FieldMedium medium([=](double x) { return peak * std::exp(-100 * x * x); },
                                   [](double) { return 2.0; }, {{-1, -1, -1}, {1, 1, 1}});
    const auto r = integrate_reference(medium, {{-5, 0, 0}, {1, 0, 0}}, 0, kInf);
    const double tau = peak * std::sqrt(std::acos(-1.0)) / 10 * std::erf(10);
    radiance.add(r[0] / (-2 * std::expm1(-tau)) - 1, text("tau =", tau));
  }
}

// Results that no input may bring about, counted.
TEST(MediaStress, RandomBits) {
  StressCase bad(kArea, "NaN, infinite or negative results of 1e5 random rays, any bits [count]",
                 "none", 0);
  Generator g(99);
  long wrong = 0;
  for (int f = 0; f < 34; ++f) {
    std::vector<EllipsoidLayer> layers;
    for (int k = 0; k <= f % 5; ++k)
      layers.push_back(
          {g.point(10),
           {g.logarithmic(1e-9, 1e9), g.logarithmic(1e-9, 1e9), g.logarithmic(1e-9, 1e9)},
           g.logarithmic(1, 1e6),
           g.logarithmic(1e-30, 1e30)});
    const auto medium = make_layered_medium(layers, {}, {kTotal});
    RayList<float> rays;
    const auto bits = [&] {
      return static_cast<double>(
          std::bit_cast<float>(static_cast<unsigned>(g.uniform(0, 4294967295.0))));
    };
    for (int i = 0; i < 1000; ++i)
      rays.add({bits(), bits(), bits()}, i % 2 ? g.direction() : Vec3{bits(), bits(), bits()},
               bits(), bits());
    for (const MediumOptions& options : all_options()) {
      const auto r = rays.integrate(*medium, options);
      for (std::size_t i = 0; i < rays.size(); ++i)
        wrong += !(r.radiance[0][i] >= 0 && std::isfinite(r.radiance[0][i]) &&
                   r.transmittance[i] >= 0 && r.transmittance[i] <= 1);
    }
  }
  bad.add(static_cast<double>(wrong), "-");
}

}  // namespace
}  // namespace plenoflame::media_stress_test
