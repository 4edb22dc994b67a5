#include "model/flame_glow.h"

#include <numeric>
#include <vector>

namespace plenoflame::desktop {

double glow(const Medium& medium, Vec3 place) {
  std::vector<double> emission(static_cast<std::size_t>(medium.channel_count()));
  medium.coefficients(place, emission.data());
  return std::accumulate(emission.begin(), emission.end(), 0.0);
}

}  // namespace plenoflame::desktop
