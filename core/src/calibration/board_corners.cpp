#include "plenoflame/calibration/board_corners.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "calibration/board_marks.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/micro_images.h"

namespace plenoflame {
namespace {

constexpr double kNear = 0.3, kFar = 4;  ///< distances of boards, in units of that in focus
constexpr double kAlike = 0.5;           ///< least cosine of twice the angle between diagonals
constexpr double kMeeting = 1.2;   ///< [pixel] by which lines to one point may miss each other
constexpr double kBaseline = 2.2;  ///< [pitches] between microlenses whose lines are compared
constexpr double kSeldom = 0.35;   ///< of the usual number of marks, by which a point is left out
constexpr int kDistanceBins = 240;
constexpr std::size_t kFewestPairs = 20, kFewestPoints = 8;

/// The line that a mark is seen on: (x, y) = place + z slope; and the same of a point one pixel
/// beside it, as differences.
struct SeenMark {
  LensIndex lens;
  Vec2 at_lens;  ///< place of the microlens [m]
  BoardMark mark;
  Vec2 place, slope, place_beside, slope_beside;

  Vec2 at(double z) const { return place + z * slope; }
  /// [m] that a pixel is wide at a distance
  double pixel_at(double z) const { return length(place_beside + z * slope_beside); }
};

/// A plane in front of the camera: 1/z = near + along x/z + across y/z, linear in directions.
struct BoardPlane {
  double near = 0, along = 0, across = 0;

  double distance(Vec2 place, Vec2 slope) const {
    return (1 - along * place.x - across * place.y) / (near + along * slope.x + across * slope.y);
  }
};

/// The place where two lines come nearest to each other: distance z, and by how many pixels they
/// miss.
struct Meeting {
  double z = 0, miss = 0;
  Vec2 direction;  ///< x/z, y/z

  Meeting(const SeenMark& a, const SeenMark& b) {
    const Vec2 apart = b.place - a.place, turned = b.slope - a.slope;
    z = -dot(apart, turned) / dot(turned, turned);
    const Vec2 p = a.at(z), q = b.at(z);
    miss = length(q - p) / a.pixel_at(z);
    direction = (0.5 / z) * (p + q);
  }
};

class BoardFinder {
 public:
  BoardFinder(const Image& light, const CameraSpec& spec, const BoardSpec& board,
              const Execution& execution)
      : board_(board), execution_(execution), camera_(spec) {
    const SensorSpec& sensor = spec.sensor;
    if (light.width != sensor.columns || light.height != sensor.rows)
      throw InputError(fmt::format("the picture has {} x {} pixels, the camera's sensor {} x {}",
                                   light.width, light.height, sensor.columns, sensor.rows));
    see(light);
  }

  BoardCorners find() {
    BoardCorners found;
    found.marks = marks_.size();
    fit_plane();
    for (int round = 0; round < 2; ++round) {
      gather();
      refit_plane();
    }
    gather();
    label();
    orient(found);
    found.distance = 1 / plane_.near;
    return found;
  }

 private:
  /// A point of the board: marks of several micro-images.
  struct Point {
    std::vector<std::size_t> marks;
    Vec2 place;  ///< on the plane [m]
    Vec2 diagonal;
    int column = 0, row = 0;
    bool labelled = false;
  };

  std::string seen_text() const {
    return fmt::format("{} {} were seen in micro-images", marks_.size(),
                       board_.dots ? "dots" : "corners");
  }

  void see(const Image& light) {
    const MicroImages micro(camera_, false, execution_);
    const MarkFinder finder(light, board_.dots);
    const Vec2 corner = camera_.sensor_point(0, 0);
    const std::vector<LensIndex> lenses = camera_.lattice().within(-1.0 * corner, corner);
    std::vector<std::vector<SeenMark>> of_lens(lenses.size());
    const Vec2 pixel = camera_.spec().sensor.pixel();
    const double most = 0.5 * micro.spacing();
    const bool all = parallel_for(execution_, lenses.size(), [&](std::size_t k, int) {
      const MicroImages::Place place = micro.place(lenses[k]);
      if (place.dark) return;
      const auto [x, y] = camera_.image_point(place.centre);
      const double radius = std::min(place.radius, most) / std::max(pixel.x, pixel.y);
      for (const BoardMark& mark : finder.marks_in({x, y}, radius)) {
        SeenMark seen;
        seen.lens = lenses[k];
        const Vec3 middle = camera_.lens_place(lenses[k]);
        seen.at_lens = {middle.x, middle.y};
        seen.mark = mark;
        const Vec2 s = camera_.sensor_point(mark.pixel.x, mark.pixel.y);
        const MicroImages::Line line = micro.chief_ray(place, s),
                                beside = micro.chief_ray(place, s + Vec2{pixel.x, 0});
        seen.place = line.position;
        seen.slope = line.slope;
        seen.place_beside = beside.position - line.position;
        seen.slope_beside = beside.slope - line.slope;
        of_lens[k].push_back(seen);
      }
    });
    if (!all) throw Cancelled();
    for (const auto& some : of_lens)
      for (const SeenMark& mark : some) {
        by_lens_[{mark.lens.q, mark.lens.r}].push_back(marks_.size());
        marks_.push_back(mark);
      }
  }

  double in_focus() const {
    const double f = camera_.lens_first_order().focal_length;
    const double z = 1 / (1 / f - 1 / camera_.lens_distance());
    return z > 0 && std::isfinite(z) ? z : 1e3 * f;
  }

  bool alike(const SeenMark& a, const SeenMark& b) const {
    return dot(a.mark.diagonal, b.mark.diagonal) > kAlike;
  }

  /// Calls for each pair of marks that may be one point seen through neighbouring microlenses.
  template <class Use>
  void for_pairs(const Use& use) const {
    const double reach = kBaseline * camera_.spec().array.pitch;
    const double focus = in_focus();
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const SeenMark& a = marks_[i];
      const Vec2 room{reach, reach};
      for (const LensIndex lens : camera_.lattice().within(a.at_lens - room, a.at_lens + room)) {
        const auto found = by_lens_.find({lens.q, lens.r});
        if (found == by_lens_.end()) continue;
        for (const std::size_t k : found->second) {
          const SeenMark& b = marks_[k];
          if (k <= i || (b.lens.q == a.lens.q && b.lens.r == a.lens.r) || !alike(a, b)) continue;
          const Meeting meeting(a, b);
          if (meeting.z > kNear * focus && meeting.z < kFar * focus && meeting.miss < kMeeting)
            use(meeting);
        }
      }
    }
  }

  /// The distance at which most lines meet, then the plane near it.
  void fit_plane() {
    std::vector<Meeting> meetings;
    for_pairs([&](const Meeting& meeting) { meetings.push_back(meeting); });
    if (meetings.size() < kFewestPairs)
      throw InputError(
          "no board is seen: " + seen_text() +
          ", of which hardly two lie on lines that "
          "meet in front of the camera; does it stand away from the plane that is sharp "
          "on the array (where a microlens sees a point of it), is it sharp in "
          "micro-images, and is the camera that of the picture (calibrate white)?");
    const double low = 1 / (kFar * in_focus()), high = 1 / (kNear * in_focus());
    std::array<double, kDistanceBins> bins{};
    for (const Meeting& meeting : meetings) {
      const double at = (1 / meeting.z - low) / (high - low) * kDistanceBins;
      bins[static_cast<std::size_t>(std::clamp(at, 0.0, kDistanceBins - 1.0))] += 1;
    }
    constexpr int kSmooth = 3;
    double best = 0;
    int mode = 0;
    for (int k = kSmooth; k < kDistanceBins - kSmooth; ++k) {
      double sum = 0;
      for (int d = -kSmooth; d <= kSmooth; ++d) sum += bins[static_cast<std::size_t>(k + d)];
      if (sum > best) best = sum, mode = k;
    }
    plane_ = {low + (mode + 0.5) * (high - low) / kDistanceBins, 0, 0};
    fit_to(meetings, 0.25 * plane_.near);
  }

  /// Least squares of those within a window that closes.
  void fit_to(const std::vector<Meeting>& meetings, double window) {
    for (int step = 0; step < 12; ++step) {
      Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      std::vector<double> off;
      for (const Meeting& meeting : meetings) {
        const Eigen::Vector3d row(1, meeting.direction.x, meeting.direction.y);
        const double rest =
            1 / meeting.z - row.dot(Eigen::Vector3d(plane_.near, plane_.along, plane_.across));
        if (std::fabs(rest) > window) continue;
        off.push_back(std::fabs(rest));
        square += row * row.transpose();
        right += row * rest;
      }
      if (off.size() < kFewestPairs) return;
      const Eigen::Vector3d change = square.ldlt().solve(right);
      plane_.near += change(0);
      plane_.along += change(1);
      plane_.across += change(2);
      std::nth_element(off.begin(), off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2),
                       off.end());
      window = std::max(0.7 * window, std::min(window, 4 * off[off.size() / 2]));
    }
  }

  void set_axes() {
    normal_ = normalize(Vec3{plane_.along, plane_.across, plane_.near});
    right_ = normalize(cross(Vec3{0, 1, 0}, normal_));
    down_ = cross(normal_, right_);
  }

  Vec3 point_of(const SeenMark& mark) const {
    const double z = plane_.distance(mark.place, mark.slope);
    const Vec2 p = mark.at(z);
    return {p.x, p.y, z};
  }

  /// Marks whose lines meet the plane at one place become points.
  void gather() {
    set_axes();
    points_.clear();
    const double cell = board_.cell;
    std::vector<Vec2> places;
    std::map<std::pair<int, int>, std::vector<std::size_t>> squares;
    std::vector<double> room;
    const double side = 0.3 * cell;
    const auto square_of = [&](Vec2 p) {
      return std::pair{static_cast<int>(std::floor(p.x / side)),
                       static_cast<int>(std::floor(p.y / side))};
    };
    for (std::size_t k = 0; k < marks_.size(); ++k) {
      const Vec3 p = point_of(marks_[k]);
      places.push_back({dot(p, right_), dot(p, down_)});
      room.push_back(std::min(2.0 * marks_[k].pixel_at(p.z), side));
      if (p.z > 0 && std::fabs(places[k].x) < 1e5 * side && std::fabs(places[k].y) < 1e5 * side)
        squares[square_of(places[k])].push_back(k);
    }
    std::vector<bool> taken(marks_.size());
    for (const auto& [at, inside] : squares)
      for (const std::size_t first : inside) {
        if (taken[first]) continue;
        // From the middle of what lies near, twice: a point's marks scatter about it.
        Vec2 middle = places[first];
        std::vector<std::size_t> members;
        for (int round = 0; round < 3; ++round) {
          members.clear();
          const auto [cx, cy] = square_of(middle);
          Vec2 sum;
          for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy) {
              const auto found = squares.find({cx + dx, cy + dy});
              if (found == squares.end()) continue;
              for (const std::size_t k : found->second)
                if (!taken[k] && length(places[k] - middle) < room[k] &&
                    alike(marks_[first], marks_[k])) {
                  members.push_back(k);
                  sum = sum + places[k];
                }
            }
          if (members.empty()) break;
          middle = (1 / static_cast<double>(members.size())) * sum;
        }
        // A micro-image shows a point once: the better mark counts.
        std::map<std::pair<int, int>, std::size_t> best;
        for (const std::size_t k : members) {
          const auto [other, added] =
              best.emplace(std::pair{marks_[k].lens.q, marks_[k].lens.r}, k);
          if (!added && marks_[k].mark.error < marks_[other->second].mark.error) other->second = k;
        }
        if (best.size() < 2) continue;
        Point point;
        point.place = middle;
        for (const auto& [lens, k] : best) {
          point.marks.push_back(k);
          point.diagonal = point.diagonal + marks_[k].mark.diagonal;
          taken[k] = true;
        }
        points_.push_back(point);
      }
    // Most points are seen equally often; false crossings of two edges are seen about once.
    std::vector<std::size_t> counts;
    for (const Point& point : points_) counts.push_back(point.marks.size());
    const auto half = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
    if (!counts.empty()) std::nth_element(counts.begin(), half, counts.end());
    std::erase_if(points_, [&](const Point& point) {
      return static_cast<double>(point.marks.size()) < kSeldom * static_cast<double>(*half);
    });
    if (points_.size() < kFewestPoints)
      throw InputError(
          fmt::format("no board is seen: {}, of which {} points of a plane about "
                      "{:.3g} m away show through two microlenses or more",
                      seen_text(), points_.size(), 1 / plane_.near));
  }

  /// Fits the plane to all pairs of marks that are one point.
  void refit_plane() {
    std::vector<Meeting> meetings;
    for (const Point& point : points_)
      for (std::size_t i = 0; i < point.marks.size(); ++i)
        for (std::size_t k = i + 1; k < point.marks.size(); ++k) {
          const Meeting meeting(marks_[point.marks[i]], marks_[point.marks[k]]);
          if (meeting.z > 0 && std::isfinite(meeting.z)) meetings.push_back(meeting);
        }
    fit_to(meetings, 0.15 * plane_.near);
  }

  /// The point nearest to a place, within a distance.
  std::optional<std::size_t> nearest(Vec2 place, double within) const {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < points_.size(); ++k)
      if (const double d = length(points_[k].place - place); d < within) {
        within = d;
        best = k;
      }
    return best;
  }

  /// Counts columns and rows of the points, from neighbour to neighbour.
  void label() {
    std::vector<double> nearest_distance;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < points_.size(); ++k)
        if (k != i) least = std::min(least, length(points_[k].place - points_[i].place));
      nearest_distance.push_back(least);
    }
    const auto middle =
        nearest_distance.begin() + static_cast<std::ptrdiff_t>(nearest_distance.size() / 2);
    std::nth_element(nearest_distance.begin(), middle, nearest_distance.end());
    const double spacing = *middle;
    if (!(spacing > 0.6 * board_.cell && spacing < 1.6 * board_.cell))
      throw InputError(fmt::format(
          "the points that are seen lie {:.3g} mm apart, as the camera has it, and those of the "
          "board {:.3g} mm: is the board another one, or the camera's focal length or distance?",
          1e3 * spacing, 1e3 * board_.cell));
    double c4 = 0, s4 = 0;
    for (std::size_t i = 0; i < points_.size(); ++i)
      for (std::size_t k = 0; k < points_.size(); ++k) {
        const Vec2 d = points_[k].place - points_[i].place;
        if (k == i || std::fabs(length(d) - spacing) > 0.25 * spacing) continue;
        const double angle = std::atan2(d.y, d.x);
        c4 += std::cos(4 * angle);
        s4 += std::sin(4 * angle);
      }
    turn_ = 0.25 * std::atan2(s4, c4);
    const Vec2 e1{spacing * std::cos(turn_), spacing * std::sin(turn_)}, e2{-e1.y, e1.x};
    std::size_t most = 0;
    std::vector<Point> best;
    std::vector<bool> tried(points_.size());
    for (std::size_t start = 0; start < points_.size(); ++start) {
      if (tried[start]) continue;
      for (Point& point : points_) point.labelled = false;
      std::vector<std::size_t> queue{start};
      points_[start].labelled = true;
      points_[start].column = points_[start].row = 0;
      std::set<std::pair<int, int>> used{{0, 0}};
      for (std::size_t next = 0; next < queue.size(); ++next) {
        const Point from = points_[queue[next]];
        tried[queue[next]] = true;
        for (int way = 0; way < 4; ++way) {
          const int dc = way == 0 ? 1 : way == 1 ? -1 : 0, dr = way == 2 ? 1 : way == 3 ? -1 : 0;
          const Vec2 step = static_cast<double>(dc) * e1 + static_cast<double>(dr) * e2;
          const auto k = nearest(from.place + step, 0.3 * spacing);
          if (!k || points_[*k].labelled || used.contains({from.column + dc, from.row + dr}))
            continue;
          // Neighbouring corners of a checkerboard have their bright squares across.
          if (!board_.dots && dot(points_[*k].diagonal, from.diagonal) > 0) continue;
          points_[*k].labelled = true;
          points_[*k].column = from.column + dc;
          points_[*k].row = from.row + dr;
          used.insert({from.column + dc, from.row + dr});
          queue.push_back(*k);
        }
      }
      if (queue.size() > most) {
        most = queue.size();
        best = points_;
      }
    }
    points_ = best;
    if (most < kFewestPoints)
      throw InputError(
          fmt::format("no grid is seen: {}, and no more than {} of {} points are "
                      "neighbours on a square grid",
                      seen_text(), most, points_.size()));
  }

  /// Columns to the right and rows down in the picture, as far as the board allows, from its first
  /// point on.
  void orient(BoardCorners& found) {
    struct Box {
      int left = std::numeric_limits<int>::max(), right = std::numeric_limits<int>::min(),
          top = left, bottom = right;
    };
    const auto turned = [](const Point& p, int quarter) {
      switch (quarter) {
        case 0:
          return std::pair{p.column, p.row};
        case 1:
          return std::pair{p.row, -p.column};
        case 2:
          return std::pair{-p.column, -p.row};
        default:
          return std::pair{-p.row, p.column};
      }
    };
    int best = -1;
    double best_worth = -std::numeric_limits<double>::infinity();
    Box best_box;
    int widest = 0, highest = 0;
    for (int quarter = 0; quarter < 4; ++quarter) {
      Box box;
      for (const Point& point : points_) {
        if (!point.labelled) continue;
        const auto [c, r] = turned(point, quarter);
        box = {std::min(box.left, c), std::max(box.right, c), std::min(box.top, r),
               std::max(box.bottom, r)};
      }
      const int columns = box.right - box.left + 1, rows = box.bottom - box.top + 1;
      if (quarter == 0) widest = columns, highest = rows;
      if (columns > board_.columns || rows > board_.rows) continue;
      // New first axis: the old one turned by this number of quarters.
      const double angle = turn_ + 0.5 * std::numbers::pi * quarter;
      double worth = std::cos(angle);
      // The first corner of a whole checkerboard has its bright squares along (1, 1).
      if (!board_.dots && columns == board_.columns && rows == board_.rows &&
          (columns + rows) % 2 == 1)
        for (const Point& point : points_) {
          if (!point.labelled) continue;
          const auto [c, r] = turned(point, quarter);
          const int parity = (c - box.left + r - box.top) % 2 == 0 ? 1 : -1;
          worth += 1e3 * parity * bright_along(point, angle);
        }
      if (worth > best_worth) {
        best_worth = worth;
        best = quarter;
        best_box = box;
      }
    }
    if (best < 0)
      throw InputError(
          fmt::format("a grid of {} x {} points is seen, more than the board's {} x {}", widest,
                      highest, board_.columns, board_.rows));
    for (const Point& point : points_) {
      if (!point.labelled) continue;
      ++found.points;
      const auto [c, r] = turned(point, best);
      for (const std::size_t k : point.marks)
        found.corners.push_back({marks_[k].lens, marks_[k].mark.pixel, c - best_box.left,
                                 r - best_box.top, marks_[k].mark.error});
    }
    found.whole = best_box.right - best_box.left + 1 == board_.columns &&
                  best_box.bottom - best_box.top + 1 == board_.rows;
  }

  /// Tells how well bright squares lie along (1, 1) of two axes on the plane: -1 to 1. `angle` is
  /// that of the first axis. Angles in pixels are those in the camera's x and y, up to half a turn.
  double bright_along(const Point& point, double angle) const {
    const Vec3 axis = std::cos(angle) * right_ + std::sin(angle) * down_;
    const double along = std::atan2(axis.y, axis.x) + 0.25 * std::numbers::pi;
    const Vec2 d = (1 / std::max(length(point.diagonal), 1e-12)) * point.diagonal;
    return d.x * std::cos(2 * along) + d.y * std::sin(2 * along);
  }

  const BoardSpec& board_;
  const Execution& execution_;
  Camera camera_;
  std::vector<SeenMark> marks_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> by_lens_;
  BoardPlane plane_;
  Vec3 normal_, right_, down_;
  std::vector<Point> points_;
  double turn_ = 0;  ///< [rad] of the columns on the plane
};

}  // namespace

BoardCorners find_board(const Image& light, const CameraSpec& camera, const BoardSpec& board,
                        const Execution& execution) {
  if (board.columns < 2 || board.rows < 2 || !(board.cell > 0))
    throw InputError("a board has at least 2 x 2 points, and a distance between them");
  if (!camera.array.present)
    throw InputError("boards are looked for in micro-images, and the camera has no array");
  return BoardFinder(light, camera, board, execution).find();
}

}  // namespace plenoflame
