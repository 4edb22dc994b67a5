#include "plenoflame/camera/pupil_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include "camera/pupil_outline.h"
#include "camera/widen_cuts.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr int kNodes = 25;            ///< of a table over the field
constexpr int kDirections = 32;       ///< in which an edge is searched
constexpr int kBisections = 24;       ///< halvings of the first bracket: edges to 6e-8 of it
constexpr double kSafety = 0.001;     ///< of a radius, over the measured margin
constexpr double kDiscSafety = 8e-4;  ///< the same for the microlens' own apertures
/// Without array the edge is seen directly: as sharp as 48 halvings make it. Rays that are drawn
/// beside it are rare, but a pixel whose pupil nothing cuts is otherwise nearly free of noise.
constexpr double kBareSafety = 1e-11;
constexpr int kBareBisections = 48;

using Passes = std::function<bool(Vec2)>;

/// Some point that passes, near `guess`; searched on ever finer grids within `range`.
bool find_inside(const Passes& passes, double range, Vec2& guess) {
  if (passes(guess)) return true;
  for (const int n : {9, 41}) {
    Vec2 sum;
    int count = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec2 p{guess.x + range * (2.0 * i / (n - 1) - 1),
                     guess.y + range * (2.0 * j / (n - 1) - 1)};
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
std::vector<Vec2> find_edge(const Passes& passes, Vec2 inside, double range,
                            int bisections = kBisections) {
  std::vector<Vec2> edge;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * constants::pi * k / kDirections;
    const Vec2 direction{std::cos(angle), std::sin(angle)};
    double lo = 0, hi = range;
    if (passes(inside + hi * direction)) {
      lo = hi;
    } else {
      for (int i = 0; i < bisections; ++i) {
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

/// The micro-image as the middle of the microlens sees it, by the main lens alone.
constexpr double kRangeRoom =
    1.3;  ///< the search begins so much farther out than the paraxial image
struct ChiefImage {
  double centre = 0, radius = 0;  ///< [m] along the axis away from the optical one; radius 0: dark
  double range = 0;  ///< guess of how far from `centre` the whole micro-image reaches [m]
};

ChiefImage find_chief_image(const MicrolensTracer& tracer, double h) {
  const Camera camera = tracer.open_at(h);
  const Microlens& lens = camera.microlenses().front();
  const FirstOrder& main = camera.lens_first_order();
  const bool telecentric = !std::isfinite(camera.exit_pupil());
  const double b = lens.sensor_distance, f = lens.first_order.focal_length;
  const double z = camera.exit_pupil() - lens.rear_principal;
  const double shift = telecentric ? 0 : b * h / z;
  const double coupling = b / f - 1 - (telecentric ? 0 : b / z);
  const double guess_radius = telecentric
                                  ? 0.5 * b * main.entrance_pupil_diameter / main.focal_length
                                  : 0.5 * b * main.exit_pupil_diameter / std::fabs(z);
  // Where vignetting leaves the middle dark, the sides may still see.
  const double a = tracer.aperture_radius();
  for (const Vec2 u : {Vec2{0, 0}, Vec2{0.7 * a, 0}, Vec2{-0.7 * a, 0}, Vec2{a, 0}, Vec2{-a, 0}}) {
    const Passes passes = [&](Vec2 s) {
      return camera.trace({s.x + h, s.y}, LensIndex{}, {u.x + h, u.y}).status.status ==
             RayStatus::reached;
    };
    Vec2 inside{shift - coupling * u.x, -coupling * u.y};
    if (!find_inside(passes, 2.5 * guess_radius, inside)) continue;
    const std::vector<Vec2> edge = find_edge(passes, inside, 5 * guess_radius);
    ChiefImage image{middle(edge).x + coupling * u.x, 0, 0};
    for (const Vec2 s : edge)
      image.radius = std::max(image.radius, length(s - Vec2{middle(edge).x, 0}));
    image.range = kRangeRoom * (image.radius + std::fabs(coupling) * a);
    return image;
  }
  return {};
}

/// The disc of aim points that get through the microlens itself, as seen from sensor points out to
/// `s_max`; independent of the field.
ApertureDiscs fit_aperture(const Camera& camera, double s_max) {
  ApertureDiscs discs;
  const double own = 0.5 * camera.spec().array.diameter;
  if (camera.ideal_array()) {
    discs.radius = discs.bound = own * (1 + kSafety);
    return discs;
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
  const double guess = ss > 0 ? us / ss : 0;
  // Of the shifts near this one, that with the smallest disc.
  discs.radius = kInfinity;
  for (int step = -20; step <= 20; ++step) {
    const double shift = guess * (1 + 0.005 * step);
    double radius = 0;
    for (const auto& [s, edge] : edges)
      for (const Vec2 u : edge) radius = std::max(radius, length(u - Vec2{shift * s, 0}));
    if (radius >= discs.radius) continue;
    discs.radius = radius;
    discs.shift = shift;
  }
  for (const auto& [s, edge] : edges)
    for (const Vec2 u : edge) discs.bound = std::max(discs.bound, length(u));
  discs.radius *= 1 + kDiscSafety;
  discs.bound *= 1 + 2 * kDiscSafety;
  return discs;
}

/// A node where nothing passes next to one where something does must not cut the light between.
void extend_into_shadow(std::vector<PupilNode>& nodes, std::vector<PupilCuts>& cuts) {
  for (std::size_t i = 1; i < nodes.size(); ++i)
    if (nodes[i].dark() && !nodes[i - 1].dark()) {
      nodes[i] = nodes[i - 1];
      cuts[i] = cuts[i - 1];
      break;
    }
}

double field_radius(const Camera& camera) {
  const SensorSpec& sensor = camera.spec().sensor;
  return 0.5 * sensor.pixel_pitch * std::hypot(sensor.columns, sensor.rows);
}

/// How far a main lens that is moved displaces its field over array and sensor, as the middle of
/// the stop sees it or along its own axis [m].
double field_shift(const Camera& camera) {
  if (!camera.lens_moved()) return 0;
  const Vec3 middle = camera.lens_pose().inverse().point({0, 0, camera.array_front()});
  return std::max(length(camera.foot()), length(Vec2{middle.x, middle.y}));
}

/// Fills in what the cuts say of a whole micro-image.
void summarise(const PupilCuts& cuts, PupilNode& node) {
  node.outer_radius = 0;
  for (std::size_t j = 0; j < PupilCuts::kAzimuths; ++j)
    node.outer_radius = std::max(node.outer_radius, static_cast<double>(cuts.columns[j].closes));
}

/// Makes room in the discs of the apertures for what a tilt of the array and another focal length
/// do to them: both move the far face's disc, as seen from s, like another s would.
void widen_discs(const Camera& camera, double s_max, ApertureDiscs& discs) {
  const ArraySpec& array = camera.spec().array;
  const double tilt = std::tan(length(array.tilt));
  const double gap = camera.aim_plane(0) - camera.sensor();
  const double room = 1.2 * (std::fabs(discs.shift) * (tilt * gap + array.focal_jitter * s_max) +
                             tilt * array.thickness) +
                      tilt * tilt * discs.bound;
  discs.radius += room;
  discs.bound += room;
}

/// Widens the table of the aligned camera to hold the rays of the misaligned one, until it does.
void widen_to_misaligned(const Camera& camera, int type, PupilTable& table,
                         std::vector<PupilCuts>& cuts) {
  constexpr int kRounds = 12;
  MisalignedPupilTracer tracer(camera, type);
  for (int round = 0; round < kRounds; ++round) {
    double before = 0, after = 0;
    for (const PupilNode& node : table.nodes) before = std::max(before, node.outer_radius);
    for (std::size_t i = 0; i + 1 < table.nodes.size(); ++i) widen_pair(tracer, table, i, cuts);
    add_margin(table, cuts);
    for (std::size_t i = 0; i < table.nodes.size(); ++i) {
      summarise(cuts[i], table.nodes[i]);
      after = std::max(after, table.nodes[i].outer_radius);
    }
    if (round >= 3 && after < 1.001 * before) break;
  }
}

/// Makes the table of a type of microlens, in stages of which the parts of each may be done by
/// several threads, in any order.
class TableMaker {
 public:
  TableMaker(const Camera& camera, int type)
      : given_(camera),
        camera_(camera.misaligned() ? camera.aligned() : camera),
        type_(type),
        tracer_(camera_, type),
        images_(kNodes),
        cuts_(kNodes) {
    // Micro-images move outwards from their lens: lenses a little beyond the sensor do not matter.
    const double h_max =
        field_radius(camera_) + 2 * camera_.spec().array.pitch + field_shift(given_);
    table_.field_step = h_max / (kNodes - 1);
    table_.nodes.resize(kNodes);
    table_.edges.resize(kNodes);
  }

  void find_image(std::size_t i) { images_[i] = find_chief_image(tracer_, place(i)); }

  void fit_discs() {
    double s_max = 0;
    for (const ChiefImage& image : images_)
      if (image.radius > 0)
        s_max = std::max(s_max, std::fabs(image.centre) + image.range / kRangeRoom);
    table_.discs = fit_aperture(tracer_.own_at(0), s_max);
    if (given_.misaligned()) widen_discs(given_, s_max, table_.discs);
  }

  void trace_outline(std::size_t i) {
    const ChiefImage& image = images_[i];
    if (image.radius <= 0) return;
    PupilTracer open(camera_, type_, true);
    PupilOutline outline(open, place(i), image.centre, image.range, table_.discs);
    if (outline.dark()) return;
    PupilNode& node = table_.nodes[i];
    PupilCuts& cuts = cuts_[i];
    node.centre = image.centre;
    node.image_radius = image.radius;
    for (std::size_t j = 0; j < PupilCuts::kAzimuths; ++j) {
      cuts.columns[j].opens = static_cast<float>((1 - kSafety) * outline.opens()[j]);
      cuts.columns[j].closes = static_cast<float>((1 + kSafety) * outline.closes()[j]);
    }
    outline.fill_cuts(cuts);
    summarise(cuts, node);
    for (std::size_t k = 0; k < node.open.size(); ++k)
      node.open[k] = outline.open_share(node.outer_radius * static_cast<double>(k) /
                                        static_cast<double>(node.open.size() - 1));
    table_.edges[i] = outline.edge_rays();
  }

  void fill_shadow() { extend_into_shadow(table_.nodes, cuts_); }

  /// Not for neighbours at the same time.
  void widen(std::size_t i) {
    PupilTracer own(camera_, type_, false);
    widen_pair(own, table_, i, cuts_);
  }

  void finish() {
    add_margin(table_, cuts_);
    if (given_.misaligned()) widen_to_misaligned(given_, type_, table_, cuts_);
    for (std::size_t i = 0; i < table_.nodes.size(); ++i) {
      summarise(cuts_[i], table_.nodes[i]);
      table_.nodes[i].cuts = PixelCuts(cuts_[i]);
    }
  }

  PupilTable take() { return std::move(table_); }

 private:
  double place(std::size_t i) const { return static_cast<double>(i) * table_.field_step; }

  const Camera& given_;
  Camera camera_;
  int type_;
  MicrolensTracer tracer_;
  std::vector<ChiefImage> images_;
  std::vector<PupilCuts> cuts_;
  PupilTable table_;
};

std::vector<PupilTable> microlens_tables(const Camera& camera, const Execution& execution) {
  Execution threads;
  threads.threads = execution.threads;
  std::vector<std::unique_ptr<TableMaker>> makers;
  for (std::size_t type = 0; type < camera.microlenses().size(); ++type)
    makers.push_back(std::make_unique<TableMaker>(camera, static_cast<int>(type)));
  const auto of_each = [&](std::size_t parts, const auto& stage) {
    parallel_for(threads, parts * makers.size(),
                 [&](std::size_t index, int) { stage(*makers[index / parts], index % parts); });
  };
  of_each(kNodes, [](TableMaker& maker, std::size_t i) { maker.find_image(i); });
  for (const auto& maker : makers) maker->fit_discs();
  of_each(kNodes, [](TableMaker& maker, std::size_t i) { maker.trace_outline(i); });
  for (const auto& maker : makers) maker->fill_shadow();
  for (const std::size_t first : {0, 1})  // pairs that share no node
    of_each((kNodes - first) / 2,
            [first](TableMaker& maker, std::size_t k) { maker.widen(2 * k + first); });
  of_each(1, [](TableMaker& maker, std::size_t) { maker.finish(); });
  std::vector<PupilTable> tables;
  for (const auto& maker : makers) tables.push_back(maker->take());
  return tables;
}

struct Outline {
  PupilNode node;
  std::vector<Vec2> edge;
  std::vector<Ray> rays;
};

/// @param turn the azimuth of the field, for a camera that is not alike all around
Outline trace_bare_outline(const Camera& camera, double h, Vec2 turn = {1, 0}) {
  Outline outline;
  const auto turned = [turn](Vec2 v) {
    return Vec2{turn.x * v.x - turn.y * v.y, turn.y * v.x + turn.x * v.y};
  };
  const double plane = camera.aim_plane(0);
  const FirstOrder& lens = camera.lens_first_order();
  const Passes passes = [&](Vec2 u) {
    return camera.trace(camera.foot() + turned({h, 0}), std::nullopt, camera.foot() + turned(u))
               .status.status == RayStatus::reached;
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
  std::vector<Vec2> edge = find_edge(passes, inside, 4 * radius, kBareBisections);
  outline.node.aim_centre = middle(edge).x;
  outline.node.image_radius = kInfinity;
  outline.node.open.fill(1);
  for (const Vec2 u : edge) {
    outline.node.aim_radius =
        std::max(outline.node.aim_radius, length(u - Vec2{outline.node.aim_centre, 0}));
    outline.edge.push_back(u);
    if (!camera.misaligned()) outline.rays.push_back(camera.trace({h, 0}, std::nullopt, u).exit);
  }
  return outline;
}

PupilTable bare_table(const Camera& given) {
  constexpr int kTurns = 12;
  const Camera camera = given.misaligned() ? given.aligned() : given;
  PupilTable table;
  table.field_step =
      (field_radius(camera) + camera.spec().sensor.pixel_pitch + field_shift(given)) / (kNodes - 1);
  for (int i = 0; i < kNodes; ++i) {
    Outline outline = trace_bare_outline(camera, i * table.field_step);
    table.nodes.push_back(outline.node);
    table.edges.push_back(std::move(outline.rays));
  }
  std::vector<PupilCuts> none(kNodes);
  extend_into_shadow(table.nodes, none);
  double margin = 0;
  for (int i = 0; i + 1 < kNodes; ++i) {
    const double h = (i + 0.5) * table.field_step;
    const PupilNode node = table.at(h);
    const auto hold = [&](const Outline& outline) {
      for (const Vec2 u : outline.edge)
        margin = std::max(margin, length(u - Vec2{node.aim_centre, 0}) - node.aim_radius);
    };
    hold(trace_bare_outline(camera, h));
    if (!given.misaligned()) continue;
    for (int k = 0; k < kTurns; ++k) {
      const double angle = 2 * constants::pi * (k + 0.5 * (i % 2)) / kTurns;
      hold(trace_bare_outline(given, h, {std::cos(angle), std::sin(angle)}));
    }
  }
  for (PupilNode& node : table.nodes)
    if (node.aim_radius > 0) node.aim_radius += 1.5 * margin + kBareSafety * node.aim_radius;
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
  PupilNode node;
  node.centre = mix(a.centre, b.centre);
  node.image_radius = mix(a.image_radius, b.image_radius);
  node.aim_centre = mix(a.aim_centre, b.aim_centre);
  node.aim_radius = mix(a.aim_radius, b.aim_radius);
  node.outer_radius = std::max(a.outer_radius, b.outer_radius);
  node.open = t < 0.5 ? a.open : b.open;
  node.cuts = PixelCuts::mix(a.cuts, b.cuts, static_cast<float>(t));
  return node;
}

PupilSampling::PupilSampling(const Camera& camera, const Execution& execution) {
  if (!camera.has_array()) {
    tables_.push_back(bare_table(camera));
  } else {
    tables_ = microlens_tables(camera, execution);
    if (!camera.spec().array.opaque_between) {
      CameraSpec spec = camera.spec();
      spec.array.tilt = {};
      spec.array.focal_jitter = 0;
      spec.array.present = false;
      spec.focus.mode = FocusMode::distance;
      spec.focus.lens_distance = camera.rear_vertex() - camera.sensor();
      Camera bare(spec);
      PupilTable table = bare_table(bare);
      between_ = Between{std::move(bare), std::move(table)};
    }
  }
  for (const PupilTable& table : tables_)
    for (const PupilNode& node : table.nodes)
      if (!node.dark()) return;
  throw InputError("no light gets through the camera: no ray from the sensor reaches the scene");
}

}  // namespace plenoflame
