#pragma once
#include <cstdint>

/// Defaults of a run as plain values (scene.h).
namespace plenoflame {

enum class Estimator { backward, forward };

/// Defaults of a run; the command line overrides them.
struct RenderSpec {
  Estimator estimator = Estimator::backward;
  int samples = 64;  ///< rays per pixel and microlens that covers it (forward: bundles)
  std::uint64_t seed = 1;
  int reflections = 1;      ///< at most, on surfaces on the light's way to the camera
  bool flame_light = true;  ///< whether flames light the surfaces
  friend bool operator==(const RenderSpec&, const RenderSpec&) = default;
};

enum class ToneCurve { linear, display };

/// Settings by which `develop` turns flux into digital numbers.
struct DevelopSpec {
  double saturation = 0;  ///< [W] per pixel; 0: automatic exposure
  int bits = 14;
  ToneCurve curve = ToneCurve::display;
  friend bool operator==(const DevelopSpec&, const DevelopSpec&) = default;
};

}  // namespace plenoflame
