#include "plenoflame/camera/pupil_sampling.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "camera/pupil/aperture_discs.h"
#include "camera/pupil/aperture_sides.h"
#include "camera/pupil/bare_pupil.h"
#include "camera/pupil/explored_pupil.h"
#include "camera/pupil/passing_edge.h"
#include "camera/pupil/pupil_field.h"
#include "camera/pupil/pupil_outline.h"
#include "camera/pupil/stop_landing.h"
#include "camera/pupil/widen_cuts.h"
#include "plenoflame/base/constants.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kSafety = 0.001;    ///< share of a radius, in addition to the measured margin
constexpr double kReach = 1.02;      ///< margin for later growth of micro-images
constexpr double kRimRoom = 0.5;     ///< share of the largest excess of traced rays over a rim
constexpr double kRimSafety = 2e-4;  ///< share of the rim's radius, in addition
constexpr double kMostReach = 1.01;  ///< a series with a larger reach is not used

/// A lens at lattice place (h, 0), which need not exist: tables cover the field continuously.
class MicrolensTracer {
 public:
  MicrolensTracer(const Camera& camera, int type) {
    CameraSpec spec = camera.spec();
    // The array has one type, centred at h by its offset. The clear aperture is opened so that only
    // the main lens blocks rays. The microlens' own apertures have a disc of their own.
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

/// The micro-image seen from the middle of the microlens, limited by the main lens alone.
constexpr double kRangeRoom =
    1.3;  ///< the search begins this factor farther out than the paraxial image
struct ChiefImage {
  double centre = 0, radius = 0;  ///< [m] on the axis away from the optical one; radius 0: dark
  double range = 0;               ///< [m] estimated reach of the whole micro-image from `centre`
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
  // The sides may still see light if vignetting leaves the middle dark.
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

/// Fills in the reach of the whole micro-image from its cuts.
void summarise(const PupilCuts& cuts, PupilNode& node) {
  node.outer_radius = 0;
  for (std::size_t j = 0; j < PupilCuts::kAzimuths; ++j)
    node.outer_radius = std::max(node.outer_radius, static_cast<double>(cuts.columns[j].closes));
}

/// Widens the table of the aligned camera until it contains the rays of the misaligned one.
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

/// Makes the table of a type of microlens in stages. Several threads may do the parts of a stage,
/// in any order.
class TableMaker {
 public:
  TableMaker(const Camera& camera, int type)
      : given_(camera),
        camera_(camera.misaligned() ? camera.aligned() : camera),
        type_(type),
        tracer_(camera_, type) {
    // Micro-images are displaced outwards from their lenses, so lenses a little beyond the sensor
    // do not matter.
    const double h_max =
        field_radius(camera_) + 2 * longest_pitch(camera_.spec().array) + field_shift(given_);
    const std::size_t nodes = field_nodes(camera_, h_max);
    table_.field_step = h_max / static_cast<double>(nodes - 1);
    table_.nodes.resize(nodes);
    table_.edges.resize(nodes);
    images_.resize(nodes);
    cuts_.resize(nodes);
    crossed_.resize(nodes);
  }

  std::size_t nodes() const { return table_.nodes.size(); }

  void find_image(std::size_t i) { images_[i] = find_chief_image(tracer_, place(i)); }

  void fit_discs() {
    for (const ChiefImage& image : images_)
      if (image.radius > 0)
        s_max_ = std::max(s_max_, std::fabs(image.centre) + image.range / kRangeRoom);
    fit_discs_to(s_max_);
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
    node.opened_radius = node.outer_radius;
    for (std::size_t k = 0; k < node.opened.size(); ++k)
      node.opened[k] = outline.opened(node.opened_radius * static_cast<double>(k) /
                                      static_cast<double>(node.opened.size() - 1));
    table_.edges[i] = outline.beam_rays();
  }

  /// Fits the discs again for micro-images that became larger.
  void fit_discs_again() {
    double s_max = 0;
    for (const PupilNode& node : table_.nodes)
      if (!node.dark())
        s_max = std::max(s_max, std::fabs(node.centre) + kReach * node.outer_radius);
    if (s_max > s_max_) fit_discs_to(s_max);
    if (given_.misaligned()) return;
    const RayCrossings crossings =
        fit_crossings(camera_, type_, std::max(s_max, s_max_), place(table_.nodes.size() - 1));
    table_.at_pupil = crossings.pupil;
    table_.at_far_face = crossings.far_face;
  }

  void fit_stop_map_of(std::size_t i) {
    if (given_.misaligned()) return;  // no two microlenses see the same stop
    table_.nodes[i].stop = fit_stop_map(tracer_.open_at(place(i)), place(i), table_.at_pupil);
  }

  void fill_shadow() { extend_into_shadow(table_.nodes, cuts_); }

  /// Neighbours must not run at the same time.
  void widen(std::size_t i) {
    PupilTracer own(camera_, type_, false);
    const Crossed crossed = widen_pair(own, table_, i, cuts_);
    for (const std::size_t k : {i, i + 1}) {
      crossed_[k].stop = std::max(crossed_[k].stop, crossed.stop);
      crossed_[k].far_face = std::max(crossed_[k].far_face, crossed.far_face);
    }
  }

  void finish() {
    add_margin(table_, cuts_);
    for (std::size_t i = 0; i < table_.nodes.size(); ++i) {
      PupilNode& node = table_.nodes[i];
      node.far_reach = reach_of(crossed_[i].far_face);
      node.stop.reach = node.stop.known() ? reach_of(crossed_[i].stop) : 0;
    }
    if (given_.misaligned()) widen_to_misaligned(given_, type_, table_, cuts_);
    add_edge_margin(cuts_);
    for (std::size_t i = 0; i < table_.nodes.size(); ++i) {
      summarise(cuts_[i], table_.nodes[i]);
      table_.nodes[i].cuts = PixelCuts(cuts_[i]);
    }
  }

  PupilTable take() { return std::move(table_); }

 private:
  void fit_discs_to(double s_max) {
    table_.discs = fit_aperture(tracer_.own_at(0), s_max);
    if (given_.misaligned()) widen_discs(given_, s_max, table_.discs);
  }
  /// @param farthest of the rays that passed; 0: none @return 0: unknown
  static double reach_of(double farthest) {
    const double reach = 1 + (1 + kRimRoom) * std::max(farthest - 1, 0.0) + kRimSafety;
    return farthest > 0 && reach < kMostReach ? reach : 0;
  }
  double place(std::size_t i) const { return static_cast<double>(i) * table_.field_step; }

  const Camera& given_;
  Camera camera_;
  int type_;
  MicrolensTracer tracer_;
  std::vector<ChiefImage> images_;
  double s_max_ = 0;              ///< [m] reach of the images
  std::vector<Crossed> crossed_;  ///< by the rays next to each node
  std::vector<PupilCuts> cuts_;
  PupilTable table_;
};

std::vector<PupilTable> microlens_tables(const Camera& camera, const Execution& execution) {
  if (!camera.lens_is_round()) return explored_tables(camera, execution);
  const Execution threads = execution.threads_only();
  std::vector<std::unique_ptr<TableMaker>> makers;
  for (std::size_t type = 0; type < camera.microlenses().size(); ++type)
    makers.push_back(std::make_unique<TableMaker>(camera, static_cast<int>(type)));
  const auto of_each = [&](std::size_t parts, const auto& stage) {
    parallel_for(threads, parts * makers.size(),
                 [&](std::size_t index, int) { stage(*makers[index / parts], index % parts); });
  };
  const std::size_t nodes = makers.front()->nodes();  // all types have the same field
  of_each(nodes, [](TableMaker& maker, std::size_t i) { maker.find_image(i); });
  of_each(1, [](TableMaker& maker, std::size_t) { maker.fit_discs(); });
  of_each(nodes, [](TableMaker& maker, std::size_t i) { maker.trace_outline(i); });
  of_each(1, [](TableMaker& maker, std::size_t) { maker.fit_discs_again(); });
  for (const auto& maker : makers) maker->fill_shadow();
  of_each(nodes, [](TableMaker& maker, std::size_t i) { maker.fit_stop_map_of(i); });
  for (const std::size_t first : {0, 1})  // pairs without a common node
    of_each((nodes - first) / 2,
            [first](TableMaker& maker, std::size_t k) { maker.widen(2 * k + first); });
  of_each(1, [](TableMaker& maker, std::size_t) { maker.finish(); });
  std::vector<PupilTable> tables;
  for (const auto& maker : makers) tables.push_back(maker->take());
  return tables;
}

}  // namespace

OpenShare::OpenShare(const PupilNode& node, double half)
    : opened_(node.opened), half_(half), steps_per_metre_(kLast / node.opened_radius) {}

double OpenShare::up_to(double distance) const {
  const double exact = distance * steps_per_metre_;
  const double place = exact < kLast ? exact : kLast;  // NaN is outside, too
  const auto i = std::min(static_cast<int>(place), static_cast<int>(kLast) - 1);
  const auto k = static_cast<std::size_t>(i);
  return opened_[k] + (place - i) * (opened_[k + 1] - opened_[k]);
}

double OpenShare::mean(double distance) const {
  const double from = std::max(distance - half_, 0.0), to = distance + half_;
  return (up_to(to) - up_to(from)) / (to - from);
}

PupilNode PupilTable::at(double h) const {
  PupilNode node;
  look_up(h, node);
  return node;
}

namespace {

/// Interpolates from x to y for t from 0 to 1; both may be infinite.
double mix(double x, double y, double t) {
  return x == y ? x : x + t * (y - x);
}

}  // namespace

PupilTable::MicroImage PupilTable::micro_image(double h) const {
  const double place = h / field_step;
  const auto last = nodes.size() - 1;
  if (!(place < static_cast<double>(last))) return {nodes[last].centre, nodes[last].outer_radius};
  const auto i = static_cast<std::size_t>(place);
  const PupilNode& a = nodes[i];
  const PupilNode& b = nodes[i + 1];
  return {mix(a.centre, b.centre, place - static_cast<double>(i)),
          std::max(a.outer_radius, b.outer_radius)};
}

void PupilTable::look_up(double h, PupilNode& node) const {
  const double place = h / field_step;
  const auto last = nodes.size() - 1;
  if (!(place < static_cast<double>(last))) {
    node = nodes[last];
    return;
  }
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i);
  const PupilNode& a = nodes[i];
  const PupilNode& b = nodes[i + 1];
  const MicroImage image = micro_image(h);
  node.centre = image.centre;
  node.outer_radius = image.outer_radius;
  node.image_radius = mix(a.image_radius, b.image_radius, t);
  node.aim_centre = mix(a.aim_centre, b.aim_centre, t);
  node.aim_radius = mix(a.aim_radius, b.aim_radius, t);
  for (std::size_t k = 0; k < node.opened.size(); ++k)
    node.opened[k] = mix(a.opened[k], b.opened[k], t);
  node.opened_radius = mix(a.opened_radius, b.opened_radius, t);
  node.cuts.set_mix(a.cuts, b.cuts, static_cast<float>(t));
  node.stop = StopMap::mix(a.stop, b.stop, t);
  node.far_reach = std::min(a.far_reach, b.far_reach) > 0 ? std::max(a.far_reach, b.far_reach) : 0;
}

PupilSampling::PupilSampling(const Camera& given, const Execution& execution) {
  // Distortion bends rays outside of the camera, where no aperture blocks them.
  const Camera camera = given.undistorted();
  if (!camera.has_array()) {
    tables_.push_back(bare_table(camera));
  } else {
    if (camera.aperture().pairs() == 0) {
      tables_ = microlens_tables(camera, execution);
    } else {
      tables_ = microlens_tables(camera.with_circles(), execution);
      parallel_for(execution.threads_only(), tables_.size(), [&](std::size_t type, int) {
        tables_[type].sides = fit_sides(camera, static_cast<int>(type), tables_[type]);
      });
    }
    if (!camera.spec().array.opaque_between) {
      CameraSpec spec = given.spec();
      spec.array.tilt = {};
      spec.array.focal_jitter = 0;
      spec.array.present = false;
      spec.focus.mode = FocusMode::distance;
      spec.focus.lens_distance = camera.rear_vertex() - camera.sensor();
      Camera bare(spec);
      PupilTable table = bare_table(bare.undistorted());
      between_ = Between{std::move(bare), std::move(table)};
    }
  }
  for (const PupilTable& table : tables_)
    for (const PupilNode& node : table.nodes)
      if (!node.dark()) return;
  throw InputError("no light gets through the camera: no ray from the sensor reaches the scene");
}

}  // namespace plenoflame
