#pragma once
#include <cstdint>
#include <optional>

#include "plenoflame/camera/camera.h"
#include "plenoflame/film/film.h"

namespace plenoflame {

/// Finds the pixels that record arrivals on the sensor.
class ForwardPixels {
 public:
  ForwardPixels(const Camera& camera, const PixelWindow& window, std::uint64_t seed)
      : camera_(camera), window_(window), seed_(seed) {}
  struct Place {
    int column, row;
  };
  /// @param bundle, number identify the arrival: each has random numbers of its own
  /// @param reached increases by one if a pixel of the sensor records the arrival
  /// @return none: no pixel of the window records it
  std::optional<Place> find(Vec2 sensor_point, std::int64_t bundle, std::uint64_t number,
                            double& reached) const;

 private:
  Vec2 blurred(std::int64_t bundle, std::uint64_t number) const;

  const Camera& camera_;
  PixelWindow window_;
  std::uint64_t seed_;
};

}  // namespace plenoflame
