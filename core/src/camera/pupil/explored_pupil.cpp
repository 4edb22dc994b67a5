#include "camera/pupil/explored_pupil.h"

#include <algorithm>
#include <cmath>

#include "camera/pupil/aperture_discs.h"
#include "camera/pupil/pupil_field.h"
#include "camera/pupil/pupil_tracer.h"
#include "camera/pupil/spread_points.h"
#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr int kAllBlocks = 128;         ///< of rays between two nodes, wherever light may arrive
constexpr int kRimBlocks = 64;          ///< the same in a round that searches for the edge
constexpr int kExploredTogether = 256;  ///< rays of one of these blocks; they share an azimuth
constexpr int kClimbs = 4;          ///< searches of a block in such a round, from its farthest ray
constexpr int kClimbing = 64;       ///< rays of each search
constexpr int kMostRounds = 30;     ///< largest number of rounds
constexpr double kStill = 1.002;    ///< a round with less growth than this is the last one
constexpr double kEdgeRoom = 1.04;  ///< margin for rays that were not traced
constexpr double kAngleRoom = 1.1;  ///< the same for directions
constexpr double kSteepest = 3;     ///< largest slope behind a microlens that is sampled
constexpr double kFarther = 1.3;    ///< factor on the paraxial reach

/// The camera as seen from the microlenses of one type.
class Explorer {
 public:
  Explorer(const Camera& camera, int type) : camera_(camera), type_(type) {
    const Microlens& lens = camera.microlenses()[static_cast<std::size_t>(type)];
    const double plane = camera.aim_plane(type), gap = plane - camera.sensor();
    const double h_max =
        field_radius(camera) + 2 * longest_pitch(camera.spec().array) + field_shift(camera);
    const std::size_t nodes = field_nodes(camera, h_max);
    table_.field_step = h_max / static_cast<double>(nodes - 1);
    table_.nodes.resize(nodes);
    table_.edges.resize(nodes);
    if (std::isfinite(camera.exit_pupil())) outwards_ = gap / (camera.exit_pupil() - plane);
    // Sensor points of rays that leave the microlens towards the last surface reach this far.
    const double aperture = camera.aperture().radius();
    const double last = camera.ideal_lens() ? camera.spec().lens.diameter
                                            : camera.spec().lens.surfaces.back().diameter;
    const double slope =
        std::min((0.5 * last + h_max + aperture) / camera.lens_distance(), kSteepest);
    farthest_ = kFarther * (aperture * (1 + gap / std::fabs(lens.first_order.focal_length)) +
                            gap * slope + std::fabs(outwards_) * h_max);
    fit_discs(farthest_ + std::fabs(outwards_) * h_max);
  }

  std::size_t nodes() const { return table_.nodes.size(); }

  /// Explores between node i and the next. Neighbours must not run at the same time.
  void explore(std::size_t i) {
    constexpr std::size_t kPoints =
        kAllBlocks * kExploredTogether +
        kMostRounds * kRimBlocks * (kExploredTogether + kClimbs * kClimbing);
    Search found(camera_, type_, i * kPoints);
    const auto height = [&](int block, int blocks) {
      return (static_cast<double>(i) + (block + 0.5) / blocks) * table_.field_step;
    };
    for (int block = 0; block < kAllBlocks; ++block)
      trace(found, height(block, kAllBlocks), 0, farthest_, block % 2 == 0);
    for (int round = 0; round < kMostRounds && found.reach > 0; ++round) {
      const double before = found.reach;
      for (int block = 0; block < kRimBlocks; ++block) {
        const double h = height(block, kRimBlocks);
        trace(found, h, 0.8 * before, 1.25 * before, false);
        climb(found, h);
      }
      if (found.reach <= kStill * before) break;
    }
    if (!(found.reach > 0)) return;
    for (const std::size_t k : {i, i + 1}) {
      PupilNode& node = table_.nodes[k];
      node.centre = outwards_ * static_cast<double>(k) * table_.field_step;
      node.outer_radius = std::max(node.outer_radius, kEdgeRoom * found.reach);
      auto& edges = table_.edges[k];
      edges.insert(edges.end(), found.steepest.begin(), found.steepest.end());
    }
  }

  PupilTable take() {
    double s_max = 0;
    for (PupilNode& node : table_.nodes) {
      if (!(node.outer_radius > 0)) continue;
      s_max = std::max(s_max, std::fabs(node.centre) + node.outer_radius);
      node.image_radius = node.opened_radius = node.outer_radius;
      for (std::size_t k = 0; k < node.opened.size(); ++k)
        node.opened[k] = node.opened_radius * static_cast<double>(k) /
                         static_cast<double>(node.opened.size() - 1);
    }
    if (s_max > 0) fit_discs(s_max);
    const auto bound = static_cast<float>(table_.discs.bound);
    for (PupilNode& node : table_.nodes) {
      PupilCuts cuts;
      for (PupilColumn& column : cuts.columns) {
        column.closes = static_cast<float>(node.outer_radius);
        column.cuts.fill({2 * bound, 2 * bound, 100 * bound, 100 * bound});
      }
      node.cuts = PixelCuts(cuts);
    }
    return std::move(table_);
  }

 private:
  /// The exploration between two nodes, and its findings.
  struct Search {
    Search(const Camera& camera, int type, std::size_t first_point)
        : tracer(camera, type), spread(first_point) {}
    MisalignedPupilTracer tracer;
    SpreadPoints spread;
    double reach = 0;    ///< [m] distance of the farthest ray from the micro-image's centre
    double tangent = 0;  ///< tangent of the steepest ray's angle with the axis
    std::vector<Ray> steepest;
    double block_reach = 0;  ///< reach in the last block alone, and its farthest ray
    PupilTracer::Request farthest;
  };

  /// @param h distance from the axis @param inner, outer radii about the micro-image's centre
  /// @param dense most rays are near the inner radius
  void trace(Search& found, double h, double inner, double outer, bool dense) {
    SpreadPoints& spread = found.spread;
    const Vec2 centre{outwards_ * h, 0};
    requests_.resize(kExploredTogether);
    for (PupilTracer::Request& request : requests_) {
      spread.step();
      const double part = dense ? spread[0] * spread[0] : std::sqrt(spread[0]);
      const double r = inner + (outer - inner) * part, a = 2 * constants::pi * spread[1];
      const double d = table_.discs.bound * std::sqrt(spread[2]), b = 2 * constants::pi * spread[3];
      request = {centre + r * Vec2{std::cos(a), std::sin(a)}, d * Vec2{std::cos(b), std::sin(b)}};
    }
    found.block_reach = 0;
    found.tracer.trace(h, requests_, [&](std::size_t index, bool passes, const Ray& ray) {
      if (!passes) return;
      note(requests_[index], centre, found);
      const double tangent = std::hypot(ray.direction.x, ray.direction.y) / ray.direction.z;
      if (tangent <= found.tangent) return;
      found.tangent = tangent;
      const Vec3 wider{kAngleRoom * ray.direction.x, kAngleRoom * ray.direction.y, ray.direction.z};
      found.steepest = {{ray.origin, normalize(wider)}};
    });
  }

  /// Continues from the farthest ray of the last block with ever smaller steps. The farthest rays
  /// of all pass through corners, which evenly spread rays rarely hit.
  void climb(Search& found, double h) {
    SpreadPoints& spread = found.spread;
    const Vec2 centre{outwards_ * h, 0};
    double size = 0.3;
    for (int round = 0; round < kClimbs && found.block_reach > 0; ++round, size *= 0.5) {
      const Vec2 from = found.farthest.s - centre, aim = found.farthest.u;
      requests_.resize(kClimbing);
      for (PupilTracer::Request& request : requests_) {
        spread.step();
        const double outward = 1 + 0.3 * size * spread[0], across = size * (2 * spread[1] - 1);
        const double d = size * table_.discs.bound * std::sqrt(spread[2]),
                     b = 2 * constants::pi * spread[3];
        request = {centre + outward * Vec2{from.x * std::cos(across) - from.y * std::sin(across),
                                           from.x * std::sin(across) + from.y * std::cos(across)},
                   aim + d * Vec2{std::cos(b), std::sin(b)}};
      }
      found.tracer.trace_again(h, requests_, [&](std::size_t index, bool passes, const Ray&) {
        if (passes) note(requests_[index], centre, found);
      });
    }
  }

  static void note(const PupilTracer::Request& request, Vec2 centre, Search& found) {
    const double reach = length(request.s - centre);
    found.reach = std::max(found.reach, reach);
    if (reach <= found.block_reach) return;
    found.block_reach = reach;
    found.farthest = request;
  }

  void fit_discs(double s_max) {
    table_.discs = fit_aperture(alone_on_axis(camera_, type_), s_max);
    widen_discs(camera_, s_max, table_.discs);
  }

  const Camera& camera_;
  int type_;
  double outwards_ = 0;  ///< shift of the micro-image's centre per distance from the axis
  double farthest_ = 0;  ///< [m] from that centre; no light arrives beyond
  std::vector<PupilTracer::Request> requests_;
  PupilTable table_;
};

}  // namespace

std::vector<PupilTable> explored_tables(const Camera& camera, const Execution& execution) {
  std::vector<PupilTable> tables(camera.microlenses().size());
  parallel_for(execution.threads_only(), tables.size(), [&](std::size_t type, int) {
    Explorer explorer(camera, static_cast<int>(type));
    for (std::size_t i = 0; i + 1 < explorer.nodes(); ++i) explorer.explore(i);
    tables[type] = explorer.take();
  });
  return tables;
}

}  // namespace plenoflame
