#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "plenoflame/camera/camera.h"

namespace plenoflame::test {

/// The measurement equation by plain sampling: sensor points uniform over a region, aim points
/// uniform over a square that is surely larger than what can pass, every ray traced through
/// whichever microlens the aim point belongs to. Shares nothing with the pupil tables. Points are
/// those of a randomly shifted Kronecker sequence (Roberts' generalised golden ratio), the standard
/// error comes from kShifts independent shifts.
class PlainSampler {
 public:
  static constexpr int kShifts = 16;
  struct Estimate {
    double flux = 0, standard_error = 0;  ///< [W] at a radiance of 1 W/(m^2 sr)
    long reached = 0;
    long at_rim = 0;  ///< of these, aimed at the outermost twentieth of the square: must be 0
  };
  PlainSampler(const Camera& camera, std::uint64_t seed) : camera_(camera), state_(seed) {
    shift();
    const FirstOrder& lens = camera.lens_first_order();
    const double to_pupil = camera.exit_pupil() - camera.sensor();
    if (camera.has_array()) {
      double gap = 0;
      for (std::size_t type = 0; type < camera.microlenses().size(); ++type)
        gap = std::max(gap, camera.aim_plane(static_cast<int>(type)) - camera.sensor());
      // A lens' width, its blur by defocus, and the stop's image behind it, with room to spare.
      side_ = 3.6 * camera.aperture().radius() + 1.3 * gap * lens.exit_pupil_diameter / to_pupil;
    } else {
      side_ = 1.6 * lens.exit_pupil_diameter *
              std::max(1.0, (camera.aim_plane(0) - camera.sensor()) / to_pupil);
    }
    towards_axis_ = (camera.aim_plane(0) - camera.sensor()) / to_pupil;
  }

  /// A ray from a continuous place of the upright image, through one microlens.
  struct Sample {
    Vec2 sensor, aim;
    std::optional<LensIndex> lens;
    Camera::Path path;
    double weight = 0;  ///< cos(theta) dOmega over the density of aim points [sr]
    bool at_rim = false;
  };
  /// Hands `rays` rays from a region of the upright image to `use`, as below.
  template <class Use>
  void samples(double column, double row, double width, double height, long rays, const Use& use) {
    shift();
    for (long i = 0; i < rays; ++i) {
      step();
      sample(column + width * coordinate(0), row + height * coordinate(1), use);
    }
  }
  /// Aims one ray and hands it to `use` for every microlens through which it reaches the scene. An
  /// oblique ray may cross the aim plane, where the vertices are, beside the lens that it meets
  /// further on: all lenses near the aim point are tried.
  template <class Use>
  void sample(double column, double row, const Use& use) {
    Sample s;
    s.sensor = camera_.sensor_point(column, row);
    const double a = coordinate(2) - 0.5, b = coordinate(3) - 0.5;
    s.at_rim = std::max(std::fabs(a), std::fabs(b)) > 0.475;
    s.aim = (1 - towards_axis_) * s.sensor + Vec2{side_ * a, side_ * b};
    const auto through = [&](int type) {
      s.path = camera_.trace(s.sensor, s.lens, s.aim);
      if (s.path.status.status != RayStatus::reached) return;
      const double d = camera_.aim_plane(type) - camera_.sensor();
      const Vec2 across = s.aim - s.sensor;
      const double r2 = d * d + dot(across, across);
      s.weight = side_ * side_ * d * d / (r2 * r2);
      use(s);
    };
    if (!camera_.has_array()) return through(0);
    const double near = camera_.aperture().radius() + 0.2 * camera_.spec().array.pitch;
    const Vec2 reach{near, near};
    for (const LensIndex lens : camera_.lattice().within(s.aim - reach, s.aim + reach)) {
      s.lens = lens;
      through(camera_.lattice().type(lens));
    }
  }

  /// Flux on a region of the upright image from a source of radiance 1 that `sees` a leaving ray.
  template <class Sees>
  Estimate flux(double column, double row, double width, double height, long rays,
                const Sees& sees) {
    Estimate estimate;
    double sum = 0, squares = 0;
    const long each = rays / kShifts;
    for (int k = 0; k < kShifts; ++k) {
      shift();
      double part = 0;
      for (long i = 0; i < each; ++i) {
        step();
        sample(column + width * coordinate(0), row + height * coordinate(1), [&](const Sample& s) {
          ++estimate.reached;
          if (s.at_rim) ++estimate.at_rim;
          if (sees(s.path.exit)) part += s.weight;
        });
      }
      part /= static_cast<double>(each);
      sum += part;
      squares += part * part;
    }
    // Not by the camera's own functions: rows that are not as far apart as columns are tested, too.
    const SensorSpec& sensor = camera_.spec().sensor;
    const double pitch = sensor.pixel_pitch;
    const double pitch_y = sensor.pixel_pitch_y > 0 ? sensor.pixel_pitch_y : pitch;
    const double area = width * height * pitch * pitch_y;
    const double mean = sum / kShifts;
    estimate.flux = area * mean;
    estimate.standard_error =
        area * std::sqrt(std::max(0.0, squares / kShifts - mean * mean) / (kShifts - 1));
    return estimate;
  }
  Estimate flux(double column, double row, double width, double height, long rays) {
    return flux(column, row, width, height, rays, [](const Ray&) { return true; });
  }

 private:
  std::uint64_t bits() {  // a 64-bit linear congruential generator, its high bits stirred (PCG)
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t word = ((state_ >> ((state_ >> 59) + 5)) ^ state_) * 12605985483714917081u;
    return (word >> 43) ^ word;
  }
  void shift() {
    for (double& x : point_) x = static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  void step() {
    // Powers of 1/g with g^5 = g + 1.
    constexpr double kStep[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378087,
                                 0.5385972572236101};
    for (std::size_t d = 0; d < 4; ++d) {
      point_[d] += kStep[d];
      point_[d] -= point_[d] >= 1 ? 1.0 : 0.0;
    }
  }
  double coordinate(std::size_t dimension) const { return point_[dimension]; }

  const Camera& camera_;
  std::uint64_t state_;
  std::array<double, 4> point_{};
  double side_ = 0, towards_axis_ = 0;
};

}  // namespace plenoflame::test
