#include "camera/pupil/aperture_sides.h"

#include <algorithm>
#include <cmath>

#include "camera/pupil/aperture_discs.h"
#include "camera/pupil/passing_edge.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr double kRounding = 1e-5;        ///< of the half width, for sides that are known exactly
constexpr double kMeasuredSafety = 2e-3;  ///< the same for measured sides
constexpr int kDistances = 5;             ///< number of distances of sensor points
constexpr int kTurns = 16;                ///< number of azimuths around the axis
constexpr double kOfTurn = 0.618034;      ///< share of an azimuth step between successive distances

}  // namespace

ApertureSides fit_sides(const Camera& camera, int type, const PupilTable& table) {
  const MicrolensAperture& aperture = camera.aperture();
  const ApertureDiscs& discs = table.discs;
  ApertureSides sides;
  sides.pairs = aperture.pairs();
  double widest = 0;
  for (int k = 0; k < sides.pairs; ++k) {
    const auto pair = static_cast<std::size_t>(k);
    sides.normals[pair] = aperture.normal(k);
    sides.near_half[pair] = sides.far_half[pair] = aperture.half_width(k) * (1 + kRounding);
    widest = std::max(widest, aperture.half_width(k));
  }
  if (camera.ideal_array()) {
    for (double& half : sides.near_half) half += discs.room;
    for (double& half : sides.far_half) half += discs.room;
    return sides;
  }
  double s_max = 0;
  for (const PupilNode& node : table.nodes)
    if (!node.dark()) s_max = std::max(s_max, std::fabs(node.centre) + 1.02 * node.outer_radius);
  const Camera alone = alone_on_axis(camera, type);
  const int far_face = alone.surface_count() - 2;
  std::array<double, MicrolensAperture::kMostPairs> near{}, far{};
  for (int distance = 0; distance <= kDistances; ++distance)
    for (int turn = 0; turn < (distance == 0 ? 1 : kTurns); ++turn) {
      const double angle = 2 * constants::pi * (turn + kOfTurn * distance) / kTurns;
      const Vec2 s = (s_max * distance / kDistances) * Vec2{std::cos(angle), std::sin(angle)};
      const Passes passes = [&](Vec2 u) {
        const TraceStatus status = alone.trace(s, LensIndex{}, u).status;
        return status.status == RayStatus::reached || status.surface < far_face;
      };
      Vec2 inside{0, 0};
      if (!find_inside(passes, widest, inside)) continue;
      for (const Vec2 u : find_edge(passes, inside, 2.2 * aperture.radius(), 16))
        for (int k = 0; k < sides.pairs; ++k) {
          const auto pair = static_cast<std::size_t>(k);
          const Vec2 n = sides.normals[pair];
          near[pair] = std::max(near[pair], std::fabs(dot(n, u - discs.near_shift * s)));
          far[pair] = std::max(far[pair], std::fabs(dot(n, u - discs.far_centre(s))));
        }
    }
  for (int k = 0; k < sides.pairs; ++k) {
    const auto pair = static_cast<std::size_t>(k);
    sides.near_half[pair] = near[pair] * (1 + kMeasuredSafety) + discs.room;
    sides.far_half[pair] = far[pair] * (1 + kMeasuredSafety) + discs.room;
  }
  return sides;
}

}  // namespace plenoflame
