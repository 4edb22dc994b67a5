#include "plenoflame/camera/pupil_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kNodes = 25;         ///< of a table over the field
constexpr int kDirections = 16;    ///< in which an edge is searched
constexpr int kBisections = 18;    ///< halvings of the first bracket: edges to 4e-6 of it
constexpr double kSafety = 0.001;  ///< of a radius, over the measured margin

using Passes = std::function<bool(Vec2)>;

/// Some point that passes, near `guess`; searched on ever finer grids within `range`.
bool find_inside(const Passes& passes, double range, Vec2& guess) {
  if (passes(guess)) return true;
  for (const int n : {9, 41}) {
    Vec2 sum;
    int count = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec2 p{guess.x + range * (2.0 * i / (n - 1) - 1), guess.y + range * (2.0 * j / (n - 1) - 1)};
        if (!passes(p)) continue;
        sum = sum + p;
        ++count;
      }
    if (count == 0) continue;
    const Vec2 mean = (1.0 / count) * sum;  // inside, as what passes is nearly convex
    if (passes(mean)) {
      guess = mean;
      return true;
    }
  }
  return false;
}

/// The outermost passing points around `inside`, up to `range` away.
std::vector<Vec2> find_edge(const Passes& passes, Vec2 inside, double range) {
  std::vector<Vec2> edge;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * constants::pi * k / kDirections;
    const Vec2 direction{std::cos(angle), std::sin(angle)};
    double lo = 0, hi = range;
    if (passes(inside + hi * direction)) {
      lo = hi;
    } else {
      for (int i = 0; i < kBisections; ++i) {
        const double mid = 0.5 * (lo + hi);
        (passes(inside + mid * direction) ? lo : hi) = mid;
      }
    }
    edge.push_back(inside + lo * direction);
  }
  return edge;
}

/// Centre of the points' extent: for an outline cut by two circles the mean would be off.
Vec2 middle(const std::vector<Vec2>& points) {
  Vec2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
  for (const Vec2 p : points) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
  }
  return 0.5 * (lower + upper);
}

constexpr std::array<double, 3> kRings{0.5, 0.8, 1.0};  ///< of the aperture radius
constexpr int kRingPoints = 8;

/// Points of the aim plane from which the stop's outline is traced: the centre, then the rings.
std::vector<Vec2> aim_points(double radius) {
  std::vector<Vec2> points{{0, 0}};
  for (const double ring : kRings)
    for (int k = 0; k < kRingPoints; ++k) {
      const double angle = 2 * constants::pi * k / kRingPoints;
      points.push_back({ring * radius * std::cos(angle), ring * radius * std::sin(angle)});
    }
  return points;
}

/// Coefficients of the parabola (1, t, t^2) through three values at t = ring^2.
std::array<double, 3> through_rings(const std::array<double, 3>& value) {
  const double t0 = kRings[0] * kRings[0], t1 = kRings[1] * kRings[1], t2 = kRings[2] * kRings[2];
  const double d01 = (value[1] - value[0]) / (t1 - t0), d12 = (value[2] - value[1]) / (t2 - t1);
  const double c2 = (d12 - d01) / (t2 - t0);
  const double c1 = d01 - c2 * (t0 + t1);
  return {value[0] - t0 * (c1 + c2 * t0), c1, c2};
}

/// The lens at lattice place (h, 0), as if one stood there: tables cover the field continuously.
class MicrolensTracer {
 public:
  MicrolensTracer(const Camera& camera, int type) {
    CameraSpec spec = camera.spec();
    // One type, centred at h by the array's offset; the clear aperture opened so that only the
    // main lens decides (the microlens' own apertures are a disc of their own).
    spec.array.types = {spec.array.types[static_cast<std::size_t>(type)]};
    spec.array.rotation = 0;
    spec.focus.mode = FocusMode::distance;
    spec.focus.lens_distance = camera.lens_distance();
    spec.array.sensor_distance = camera.array_back() - camera.sensor();
    spec.array.measured_from = ArrayReference::vertex;
    own_ = spec;
    open_ = spec;
    double limit = 1e3 * spec.array.diameter;
    for (const double radius : {spec.array.types[0].radius_front, spec.array.types[0].radius_back})
      limit = std::min(limit, 1.9 * std::fabs(radius));
    open_.array.diameter = std::max(limit, spec.array.diameter);
  }
  Camera open_at(double h) const { return at(open_, h); }
  Camera own_at(double h) const { return at(own_, h); }
  double aperture_radius() const { return 0.5 * own_.array.diameter; }

 private:
  static Camera at(CameraSpec spec, double h) {
    spec.array.offset = {h, 0};
    return Camera(spec);
  }
  CameraSpec own_, open_;
};

struct Outline {
  PupilNode node;
  std::vector<std::pair<Vec2, Vec2>> edge;  ///< (s, u)
  std::vector<Ray> rays;
};

/// Largest amount by which a traced edge lies outside of the node's discs [m].
double excess(const PupilNode& node, const Outline& outline) {
  double worst = 0;
  for (const auto& [s, u] : outline.edge)
    worst = std::max(worst, length(s - node.centre_at(u)) - node.radius_at(u));
  return worst;
}

/// Fits radius(u) to the edges around centre(u).
void fit_radius(Outline& outline) {
  PupilNode& node = outline.node;
  const double a = node.aim_radius;
  // What is needed at the centre, on the rings along and across u, and to both sides of the field.
  double centre_radius = 0, outwards = 0, inwards = 0;
  std::array<double, 3> along{}, across{};
  for (const auto& [s, u] : outline.edge) {
    const Vec2 v = s - node.centre_at(u);
    const double needed = length(v), part = length(u) / a;
    if (part < 0.25) {
      centre_radius = std::max(centre_radius, needed);
      continue;
    }
    const std::size_t ring = part < 0.65 ? 0 : part < 0.9 ? 1 : 2;
    along[ring] = std::max(along[ring], needed);
    if (std::fabs(dot(u, v)) < 0.4 * length(u) * needed)
      across[ring] = std::max(across[ring], needed);
    if (ring == 2 && u.x > 0.9 * length(u)) outwards = std::max(outwards, needed);
    if (ring == 2 && u.x < -0.9 * length(u)) inwards = std::max(inwards, needed);
  }
  // Only where the two sides are those of largest need may one of them be left less.
  const double side = 0.5 * (outwards + inwards);
  node.radius_odd = 0.5 * (outwards - inwards);
  node.radius = through_rings({along[0], along[1], std::max(side, along[2] - std::fabs(node.radius_odd))});
  const double t1 = kRings[1] * kRings[1];
  const double f1 = 0.9 * std::max(0.0, along[1] - across[1]) / t1;
  const double f2 = 0.9 * std::max(0.0, along[2] - across[2]);
  const double second = (f2 - f1) / (1 - t1);
  node.flattening = {f2 - second, second};
  // Only along the axis through the field is the odd term known; elsewhere the excess decides.
  node.radius[0] += excess(node, outline);
}

/// Fits centre(u) to the middles of the outlines (one per aim point), then radius(u) around it.
void fit_discs(Outline& outline, const std::vector<Vec2>& aims, const std::vector<Vec2>& middles) {
  PupilNode& node = outline.node;
  node.centre = middles.front().x;
  std::array<double, 3> coupling{};
  for (std::size_t ring = 0; ring < kRings.size(); ++ring) {
    double uu = 0, cu = 0;
    for (int k = 0; k < kRingPoints; ++k) {
      const std::size_t i = 1 + ring * kRingPoints + static_cast<std::size_t>(k);
      uu += dot(aims[i], aims[i]);
      cu += dot(middles[i], aims[i]);
    }
    coupling[ring] = -cu / uu;
  }
  node.coupling = through_rings(coupling);
  // Coma moves the rim's images along the field, those from the field's direction and its opposite
  // more than those from across.
  const std::size_t rim = 1 + 2 * kRingPoints;
  const auto rim_mean = [&](std::size_t k) {
    return 0.5 * (middles[rim + k].x + middles[rim + k + kRingPoints / 2].x) - node.centre;
  };
  node.centre2 = rim_mean(kRingPoints / 4);
  node.coma = (rim_mean(0) - node.centre2) / (node.aim_radius * node.aim_radius);
  fit_radius(outline);
}

/// Outline of the stop seen through a microlens at field h, from points of its aperture.
Outline trace_outline(const MicrolensTracer& tracer, double h, double aperture) {
  Outline outline;
  outline.node.aim_radius = aperture;
  const Camera camera = tracer.open_at(h);
  const Microlens& lens = camera.microlenses().front();
  const FirstOrder& main = camera.lens_first_order();
  const bool telecentric = !std::isfinite(camera.exit_pupil());
  const double b = lens.sensor_distance, f = lens.first_order.focal_length;
  const double z = camera.exit_pupil() - lens.rear_principal;
  const double shift = telecentric ? 0 : b * h / z;
  const double coupling = b / f - 1 - (telecentric ? 0 : b / z);
  const double guess_radius = telecentric ? 0.5 * b * main.entrance_pupil_diameter / main.focal_length
                                          : 0.5 * b * main.exit_pupil_diameter / std::fabs(z);
  const std::vector<Vec2> aims = aim_points(aperture);
  std::vector<Vec2> middles;
  for (const Vec2 u : aims) {
    const Vec2 aim{u.x + h, u.y};
    const Passes passes = [&](Vec2 s) {
      return camera.trace({s.x + h, s.y}, LensIndex{}, aim).status.status == RayStatus::reached;
    };
    // The paraxial place first; then around what the aim points before have shown.
    Vec2 inside{shift - coupling * u.x, -coupling * u.y};
    if (!find_inside(passes, 2.5 * guess_radius, inside)) {
      middles.push_back(Vec2{shift - coupling * u.x, -coupling * u.y});
      continue;
    }
    const std::vector<Vec2> edge = find_edge(passes, inside, 5 * guess_radius);
    middles.push_back(middle(edge));
    for (const Vec2 s : edge) {
      outline.edge.emplace_back(s, u);
      outline.rays.push_back(camera.trace({s.x + h, s.y}, LensIndex{}, aim).exit);
    }
  }
  if (!outline.edge.empty()) fit_discs(outline, aims, middles);
  return outline;
}

/// The disc of aim points that get through the microlens itself, as seen from sensor points out to
/// `s_max`; independent of the field.
void fit_aperture(const Camera& camera, double s_max, PupilTable& table) {
  const double own = 0.5 * camera.spec().array.diameter;
  if (camera.ideal_array()) {
    table.aperture_radius = own * (1 + kSafety);
    table.bound_radius = table.aperture_radius;
    return;
  }
  const int lens_surfaces = camera.surface_count() - 2;
  std::vector<std::pair<double, std::vector<Vec2>>> edges;
  double ss = 0, us = 0, on_axis = 0;
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double s = part * s_max;
    const Passes passes = [&](Vec2 u) {
      const TraceStatus status = camera.trace({s, 0}, LensIndex{}, u).status;
      return status.status == RayStatus::reached || status.surface < lens_surfaces;
    };
    Vec2 inside{0, 0};
    if (!find_inside(passes, own, inside)) continue;
    edges.emplace_back(s, find_edge(passes, inside, 2.2 * own));
    // Seen from the side, the edge turned away from s is the far face's, the other one the near
    // face's, which hardly moves. Light that only just passes the stop comes over the former.
    double turned_away = kInfinity;
    for (const Vec2 u : edges.back().second) turned_away = std::min(turned_away, u.x);
    if (s == 0) on_axis = turned_away;
    ss += s * s;
    us += s * (turned_away - on_axis);
  }
  table.aperture_shift = ss > 0 ? us / ss : 0;
  for (const auto& [s, edge] : edges)
    for (const Vec2 u : edge) {
      table.aperture_radius =
          std::max(table.aperture_radius, length(u - Vec2{table.aperture_shift * s, 0}));
      table.bound_radius = std::max(table.bound_radius, length(u));
    }
  table.aperture_radius *= (1 + kSafety);
  table.bound_radius *= 1 + 4 * kSafety;
}

/// A node where nothing passes next to one where something does must not cut the light between.
void extend_into_shadow(std::vector<PupilNode>& nodes) {
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i].dark() && !nodes[i - 1].dark()) {
      nodes[i] = nodes[i - 1];
      break;
    }
}

double field_radius(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  return 0.5 * sensor.pixel_pitch * std::hypot(sensor.columns, sensor.rows);
}

/// Largest distance from the micro-image's centre at which both discs still share a point.
double outer_radius(const PupilNode& node, double aperture_shift) {
  const auto lit = [&](Vec2 s, Vec2 direction) {
    for (int i = -16; i <= 16; ++i) {
      const Vec2 u = aperture_shift * s + (node.aim_radius * i / 16) * direction;
      if (length(s - node.centre_at(u)) <= node.radius_at(u)) return true;
    }
    return false;
  };
  double outer = 0;
  for (int k = 0; k < 8; ++k) {
    const double angle = 2 * constants::pi * k / 8;
    const Vec2 direction{std::cos(angle), std::sin(angle)};
    double lo = 0, hi = node.radius[0];
    const auto at = [&](double distance) { return Vec2{node.centre, 0} + distance * direction; };
    while (lit(at(hi), direction) && hi < 1e3 * node.radius[0]) hi *= 1.5;
    for (int i = 0; i < 20; ++i) {
      const double mid = 0.5 * (lo + hi);
      (lit(at(mid), direction) ? lo : hi) = mid;
    }
    outer = std::max(outer, lo);
  }
  return outer * (1 + kSafety);
}

/// Fills node.open by counting aperture points in both discs, averaged over four directions.
void measure_open_share(PupilNode& node, const PupilTable& table) {
  constexpr int kSide = 12;
  constexpr int kSteps = static_cast<int>(std::tuple_size_v<decltype(node.open)>) - 1;
  for (int step = 0; step <= kSteps; ++step) {
    int seen = 0, all = 0;
    for (int k = 0; k < 4; ++k) {
      const double angle = 0.5 * constants::pi * k, distance = node.outer_radius * step / kSteps;
      const Vec2 s{node.centre + distance * std::cos(angle), distance * std::sin(angle)};
      for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
          const Vec2 v{(2.0 * i + 1) / kSide - 1, (2.0 * j + 1) / kSide - 1};
          if (dot(v, v) > 1) continue;
          const Vec2 u = table.aperture_shift * s + table.aperture_radius * v;
          if (length(u) > table.bound_radius) continue;
          ++all;
          if (length(s - node.centre_at(u)) < node.radius_at(u)) ++seen;
        }
    }
    node.open[static_cast<std::size_t>(step)] = all > 0 ? static_cast<double>(seen) / all : 0;
  }
  // Fully open up to the last step of an unbroken run; one step less, as points are sampled.
  int last = -1;
  while (last < kSteps && node.open[static_cast<std::size_t>(last + 1)] >= 0.999) ++last;
  node.open_radius = std::max(0, last - 1) * node.outer_radius / kSteps;
}

PupilTable microlens_table(const Camera& camera, int type) {
  PupilTable table;
  const MicrolensTracer tracer(camera, type);
  // Micro-images move outwards from their lens: lenses a little beyond the sensor do not matter.
  const double h_max = field_radius(camera) + 2 * camera.spec().array.pitch;
  table.field_step = h_max / (kNodes - 1);
  // First the outlines with the nominal aperture, which bound s; then the aperture itself. Towards
  // the edge of the field micro-images move out from under their lenses.
  double s_max = 0;
  for (const double h : {0.0, 0.5 * h_max, h_max}) {
    const Outline outline = trace_outline(tracer, h, tracer.aperture_radius());
    if (!outline.node.dark())
      s_max = std::max(s_max, std::fabs(outline.node.centre) + outer_radius(outline.node, 0));
  }
  fit_aperture(tracer.own_at(0), s_max, table);
  for (int i = 0; i < kNodes; ++i) {
    Outline outline = trace_outline(tracer, i * table.field_step, table.aperture_radius);
    table.nodes.push_back(outline.node);
    table.edges.push_back(std::move(outline.rays));
  }
  extend_into_shadow(table.nodes);
  // What the table interpolates is checked, and widened, half way between the nodes.
  double margin = 0;
  for (int i = 0; i + 1 < kNodes; ++i) {
    const double h = (i + 0.5) * table.field_step;
    margin = std::max(margin, excess(table.at(h), trace_outline(tracer, h, table.aperture_radius)));
  }
  for (PupilNode& node : table.nodes)
    if (!node.dark()) {
      node.radius[0] += 1.5 * margin + kSafety * node.radius[0];
      node.outer_radius = outer_radius(node, table.aperture_shift);
      measure_open_share(node, table);
    }
  const auto& k = table.nodes.front().coupling;
  table.cut_margin = 1.02 + 0.08 * (std::fabs(k[1]) + std::fabs(k[2])) /
                                (std::fabs(k[0]) + std::fabs(k[1]) + std::fabs(k[2]) + 1e-12);
  return table;
}

Outline trace_bare_outline(const Camera& camera, double h) {
  Outline outline;
  const double plane = camera.aim_plane(0);
  const FirstOrder& lens = camera.lens_first_order();
  const Passes passes = [&](Vec2 u) {
    return camera.trace({h, 0}, std::nullopt, u).status.status == RayStatus::reached;
  };
  double centre = h, radius = 0.5 * lens.entrance_pupil_diameter;
  if (std::isfinite(camera.exit_pupil())) {
    const double to_pupil = camera.exit_pupil() - camera.sensor();
    const double part = (plane - camera.sensor()) / to_pupil;
    centre = h * (1 - part);
    radius = 0.5 * lens.exit_pupil_diameter * std::fabs(part);
  }
  Vec2 inside{centre, 0};
  if (!find_inside(passes, 1.5 * radius, inside)) return outline;
  std::vector<Vec2> edge = find_edge(passes, inside, 4 * radius);
  outline.node.aim_centre = middle(edge).x;
  outline.node.radius = {kInfinity, 0, 0};
  outline.node.open.fill(1);
  for (const Vec2 u : edge) {
    outline.node.aim_radius = std::max(outline.node.aim_radius, length(u - Vec2{outline.node.aim_centre, 0}));
    outline.edge.emplace_back(Vec2{}, u);
    outline.rays.push_back(camera.trace({h, 0}, std::nullopt, u).exit);
  }
  return outline;
}

PupilTable bare_table(const Camera& camera) {
  PupilTable table;
  table.field_step = (field_radius(camera) + camera.spec().sensor.pixel_pitch) / (kNodes - 1);
  for (int i = 0; i < kNodes; ++i) {
    Outline outline = trace_bare_outline(camera, i * table.field_step);
    table.nodes.push_back(outline.node);
    table.edges.push_back(std::move(outline.rays));
  }
  extend_into_shadow(table.nodes);
  double margin = 0;
  for (int i = 0; i + 1 < kNodes; ++i) {
    const double h = (i + 0.5) * table.field_step;
    const PupilNode node = table.at(h);
    for (const auto& [s, u] : trace_bare_outline(camera, h).edge)
      margin = std::max(margin, length(u - Vec2{node.aim_centre, 0}) - node.aim_radius);
  }
  for (PupilNode& node : table.nodes)
    if (node.aim_radius > 0) node.aim_radius += 1.5 * margin + kSafety * node.aim_radius;
  return table;
}

}  // namespace

PupilNode PupilTable::at(double h) const {
  const double place = h / field_step;
  const auto last = nodes.size() - 1;
  if (!(place < static_cast<double>(last))) return nodes[last];
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  const PupilNode& a = nodes[i];
  const PupilNode& b = nodes[i + 1];
  const auto mix = [t](double x, double y) { return x == y ? x : x + t * (y - x); };
  PupilNode node{mix(a.centre, b.centre), mix(a.centre2, b.centre2), mix(a.coma, b.coma), {}, {},
                 mix(a.radius_odd, b.radius_odd),
                 {mix(a.flattening[0], b.flattening[0]), mix(a.flattening[1], b.flattening[1])},
                 mix(a.aim_centre, b.aim_centre), mix(a.aim_radius, b.aim_radius),
                 std::max(a.outer_radius, b.outer_radius), std::min(a.open_radius, b.open_radius), t < 0.5 ? a.open : b.open};
  for (std::size_t k = 0; k < 3; ++k) {
    node.coupling[k] = mix(a.coupling[k], b.coupling[k]);
    node.radius[k] = mix(a.radius[k], b.radius[k]);
  }
  return node;
}

Vec2 PupilNode::centre_at(Vec2 u) const {
  const double t = dot(u, u) / (aim_radius * aim_radius);
  const double k = coupling[0] + t * (coupling[1] + t * coupling[2]);
  const double along = k - coma * u.x;
  return {centre + centre2 * t - along * u.x, -along * u.y};
}

double PupilNode::radius_at(Vec2 u) const {
  const double t = dot(u, u) / (aim_radius * aim_radius);
  return radius[0] + t * (radius[1] + t * radius[2] + radius_odd * u.x / aim_radius);
}

PupilSampling::PupilSampling(const Camera& camera, const Execution& execution) {
  if (!camera.has_array()) {
    tables_.push_back(bare_table(camera));
  } else {
    tables_.resize(camera.microlenses().size());
    Execution quiet;
    quiet.threads = execution.threads;
    parallel_for(quiet, tables_.size(), [&](std::size_t type, int) {
      tables_[type] = microlens_table(camera, static_cast<int>(type));
    });
  }
  for (const PupilTable& table : tables_)
    for (const PupilNode& node : table.nodes)
      if (!node.dark()) return;
  throw InputError("no light gets through the camera: no ray from the sensor reaches the scene");
}

}  // namespace plenoflame
