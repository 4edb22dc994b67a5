#include "plenoflame/optics/window_set.h"
#include "plenoflame/base/constants.h"

#include <algorithm>
#include <cmath>

#include "optics/window_body.h"

namespace plenoflame {
namespace {

/// Light that no body could send to and fro so often.
constexpr int kMostFaces = 1000;

/// Refraction at a face (Snell's law as vectors). @param normal unit, against the direction
/// @return false: total reflection
bool refract(double before, double behind, Vec3 normal, Vec3& direction) {
  const double ratio = before / behind;
  const double cos_in = -dot(direction, normal);
  const Vec3 across = ratio * (direction + cos_in * normal);
  const double sine_square = dot(across, across);
  if (!(sine_square < 1)) return false;
  direction = normalize(across - std::sqrt(1 - sine_square) * normal);
  return true;
}

/// Shares reflected from air to glass, polarised across and along the plane of incidence.
std::array<double, 2> reflected(double index, double cos_in) {
  const double sine = std::sqrt(std::max(0.0, (1 - cos_in) * (1 + cos_in))) / index;
  const double cos_glass = std::sqrt((1 - sine) * (1 + sine));
  const double across = (cos_in - index * cos_glass) / (cos_in + index * cos_glass);
  const double along = (index * cos_in - cos_glass) / (index * cos_in + cos_glass);
  return {across * across, along * along};
}

}  // namespace

double wall_transmission(double index, const std::array<double, 2>& cos_in, double clear,
                         bool fresnel) {
  if (!fresnel) return clear;
  const std::array<double, 2> first = reflected(index, cos_in[0]);
  const std::array<double, 2> second = reflected(index, cos_in[1]);
  double passed = 0;
  for (std::size_t p = 0; p < 2; ++p)
    passed +=
        0.5 * (1 - first[p]) * (1 - second[p]) * clear / (1 - first[p] * second[p] * clear * clear);
  return passed;
}

WindowSet::WindowSet(const std::vector<WindowSpec>& specs) {
  for (const WindowSpec& spec : specs) bodies_.emplace_back(spec);
}

WindowSet::~WindowSet() = default;

int WindowSet::size() const {
  return static_cast<int>(bodies_.size());
}

double WindowSet::index(int window) const {
  return bodies_[static_cast<std::size_t>(window)].index();
}

void WindowSet::trace(const Ray& from, WindowPath& path) const {
  path.segments.clear();
  path.stopped = false;
  AirSegment segment{from, kInfinity, 1, -1};
  int left = -1, left_face = kNoFace;  // the window and face that the ray comes from
  const auto stop_at = [&](Vec3 place) {
    path.stopped = true;
    path.stop = place;
  };
  for (int faces = 0; faces < kMostFaces; ++faces) {
    int face = kNoFace;
    for (int w = 0; w < size(); ++w) {
      const Body& body = bodies_[static_cast<std::size_t>(w)];
      if (w != left && !body.may_meet(segment.ray)) continue;
      const Body::Hit hit =
          body.intersect(segment.ray, w == left ? left_face : kNoFace, segment.far);
      if (hit.face == kNoFace) continue;
      segment.far = hit.t;
      segment.window = w;
      face = hit.face;
    }
    path.segments.push_back(segment);
    if (segment.window < 0) return;
    const Body& body = bodies_[static_cast<std::size_t>(segment.window)];
    const Vec3 entry = segment.ray.at(segment.far);
    if (!body.is_polished(face)) return stop_at(entry);
    Ray inside{entry, segment.ray.direction};
    const Vec3 in = body.normal(face, entry);
    const double cos_in = -dot(inside.direction, in);
    // A ray that only touches the edge may come out on the wrong side of the normal.
    if (!(cos_in > 0) || !refract(1, body.index(), in, inside.direction)) return stop_at(entry);
    const Body::Hit exit = body.intersect(inside, face, kInfinity);
    if (exit.face == kNoFace) return stop_at(entry);
    const Vec3 place = inside.at(exit.t);
    if (!body.is_polished(exit.face)) return stop_at(place);
    const Vec3 out = -body.normal(exit.face, place);
    Ray behind{place, inside.direction};
    if (!refract(body.index(), 1, out, behind.direction)) return stop_at(place);
    const double cos_out = -dot(behind.direction, out);
    const double clear = std::exp(-body.absorption() * exit.t);
    left = segment.window;
    left_face = exit.face;
    segment = {behind, kInfinity,
               segment.throughput *
                   wall_transmission(body.index(), {cos_in, cos_out}, clear, body.fresnel()),
               -1};
  }
  stop_at(segment.ray.origin);
}

int WindowSet::glass_at(Vec3 world) const {
  for (int w = 0; w < size(); ++w)
    if (bodies_[static_cast<std::size_t>(w)].contains(world)) return w;
  return -1;
}

std::vector<Vec3> WindowSet::points_of(int window) const {
  return bodies_[static_cast<std::size_t>(window)].points();
}

std::vector<std::vector<Vec3>> WindowSet::outline(int window) const {
  return bodies_[static_cast<std::size_t>(window)].outline();
}

std::string window_name(const std::vector<WindowSpec>& windows, std::size_t index) {
  const std::string& name = windows[index].name;
  return name.empty() ? "window " + std::to_string(index) : "window \"" + name + "\"";
}

}  // namespace plenoflame
