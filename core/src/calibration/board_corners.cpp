#include "plenoflame/calibration/board_corners.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "calibration/board_grid.h"
#include "calibration/board_plane.h"
#include "calibration/board_views.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr double kNear = 0.3, kFar = 4;  ///< distances of boards, in units of that in focus
constexpr double kAlike = 0.5;           ///< least cosine of twice the angle between diagonals
constexpr double kMeeting = 1.2;   ///< [pixel] by which lines to one point may miss each other
constexpr double kBaseline = 2.2;  ///< [pitches] between microlenses whose lines are compared
constexpr double kSeldom = 0.35;   ///< of the usual number of marks, by which a point is left out
constexpr int kRounds = 4;         ///< of fits of expected marks
constexpr double kDefocus = 0.1;   ///< deviation of MicroView::plane of a camera of nominal values
constexpr std::size_t kFewestPoints = 8;

class BoardFinder {
 public:
  BoardFinder(const Image& light, const Image& white, const CameraSpec& spec,
              const BoardSpec& board, const Execution& execution)
      : board_(board),
        execution_(execution),
        picture_(light, white, spec, board.dots, execution),
        views_(picture_.views()) {
    defocus_.resize(spec.array.types.size());
    see();
  }

  BoardCorners find() {
    BoardCorners found;
    found.marks = seen_;
    fit_plane();
    for (int round = 0; round < 2; ++round) {
      gather();
      refit_plane();
    }
    gather();
    label();
    begin_grid();
    GridBox box;
    for (const Point& point : points_) box.add(point.column, point.row);
    if (fits_board(box.columns(), box.rows()))
      for (int round = 0; round < kRounds; ++round) {
        if (round + 1 < kRounds) fill_grid();
        refine();
        trim_grid();
      }
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
    return fmt::format("{} {} were seen in micro-images", seen_, board_.dots ? "dots" : "corners");
  }

  void see() {
    std::vector<std::vector<SeenMark>> of_view(views_.size());
    const bool all = parallel_for(execution_, views_.size(), [&](std::size_t k, int) {
      for (const BoardMark& mark : picture_.finder().marks_in(views_[k].see))
        of_view[k].push_back(picture_.seen_at(k, mark));
    });
    if (!all) throw Cancelled();
    put_marks(of_view);
    seen_ = marks_.size();
  }

  void put_marks(const std::vector<std::vector<SeenMark>>& of_view) {
    marks_.clear();
    by_lens_.clear();
    for (const auto& some : of_view)
      for (const SeenMark& mark : some) {
        by_lens_[{mark.lens.q, mark.lens.r}].push_back(marks_.size());
        marks_.push_back(mark);
      }
  }

  bool alike(const SeenMark& a, const SeenMark& b) const {
    return dot(a.mark.diagonal, b.mark.diagonal) > kAlike;
  }

  /// Calls for each pair of marks that may be one point seen through neighbouring microlenses.
  template <class Use>
  void for_pairs(const Use& use) const {
    const double reach = kBaseline * picture_.camera().spec().array.pitch;
    const double focus = picture_.in_focus();
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const SeenMark& a = marks_[i];
      const Vec2 room{reach, reach};
      const Vec2 from = views_[a.view].at_lens;
      for (const LensIndex lens : picture_.camera().lattice().within(from - room, from + room)) {
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

  void fit_plane() {
    std::vector<Meeting> meetings;
    for_pairs([&](const Meeting& meeting) { meetings.push_back(meeting); });
    if (meetings.size() < kFewestPairs)
      throw InputError(fmt::format(
          "no board is seen: {}, of which hardly two lie on lines that meet in front of the "
          "camera; {}. Does it face the camera, is it sharp in micro-images, and is the camera "
          "that of the "
          "picture?",
          seen_text(), picture_.where_seen(board_.cell)));
    plane_ = BoardPlane::where_most_meet(meetings, kNear * picture_.in_focus(),
                                         kFar * picture_.in_focus());
  }

  void set_axes() {
    normal_ = normalize(Vec3{plane_.along, plane_.across, plane_.near});
    right_ = normalize(cross(Vec3{0, 1, 0}, normal_));
    down_ = cross(normal_, right_);
  }

  Vec3 point_of_mark(std::size_t k) const {
    const SeenMark& mark = marks_[k];
    const double z = plane_.distance(mark.line);
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
      const Vec3 p = point_of_mark(k);
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
    plane_.fit(meetings, 0.15 * plane_.near);
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

  bool fits_board(int columns, int rows) const {
    return std::max(columns, rows) <= std::max(board_.columns, board_.rows) &&
           std::min(columns, rows) <= std::min(board_.columns, board_.rows);
  }

  /// Adds the points between those that were found, and beside them as far as the board may reach.
  void fill_grid() {
    GridBox box;
    std::set<std::pair<int, int>> known;
    for (const Point& point : points_) {
      box.add(point.column, point.row);
      known.insert({point.column, point.row});
    }
    const int columns = fits_board(box.columns() + 1, box.rows()) ? 1 : 0,
              rows = fits_board(box.columns(), box.rows() + 1) ? 1 : 0;
    for (int c = box.left - columns; c <= box.right + columns; ++c)
      for (int r = box.top - rows; r <= box.bottom + rows; ++r) {
        if (known.contains({c, r})) continue;
        Point point;
        point.column = c;
        point.row = r;
        points_.push_back(point);
      }
  }

  /// Leaves out sides of the grid that are seen least, until it is no larger than the board.
  void trim_grid() {
    for (;;) {
      GridBox box;
      for (const Point& point : points_) box.add(point.column, point.row);
      if (fits_board(box.columns(), box.rows())) return;
      const auto sides = [&](const Point& point) {
        return std::array<bool, 4>{point.column == box.left, point.column == box.right,
                                   point.row == box.top, point.row == box.bottom};
      };
      std::array<std::size_t, 4> marks{};
      for (const Point& point : points_)
        for (std::size_t side = 0; side < 4; ++side)
          if (sides(point)[side]) marks[side] += point.marks.size();
      const auto least =
          static_cast<std::size_t>(std::min_element(marks.begin(), marks.end()) - marks.begin());
      std::erase_if(points_, [&](const Point& point) { return sides(point)[least]; });
    }
  }

  /// Bright squares of neighbouring corners lie across each other.
  double parity(const Point& point) const {
    return board_.dots || (point.column + point.row) % 2 == 0 ? 1 : -1;
  }

  /// Leaves the points of the grid alone.
  void begin_grid() {
    std::erase_if(points_, [](const Point& point) { return !point.labelled; });
    std::vector<double> sizes;
    for (const Point& point : points_)
      for (const std::size_t k : point.marks) sizes.push_back(std::fabs(marks_[k].mark.shape[0]));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    dot_radius_ = *middle;
    for (const Point& point : points_) diagonal_ = diagonal_ + parity(point) * point.diagonal;
    grid_ = GridToPlane::of(points_, board_.cell);
  }

  Vec3 on_plane(Vec2 place) const {
    // The plane: along x + across y + near z = 1.
    const Vec3 p = place.x * right_ + place.y * down_;
    return p + (1 / length(Vec3{plane_.along, plane_.across, plane_.near})) * normal_;
  }

  /// Fits each point of the grid in each micro-image that it should be seen in.
  void refine() {
    struct Expected {
      Vec3 at, next_column, next_row;
    };
    std::vector<Expected> expected;
    for (const Point& point : points_) {
      const auto place = [&](int dc, int dr) {
        return on_plane(grid_(point.column + dc, point.row + dr));
      };
      expected.push_back({place(0, 0), place(1, 0), place(0, 1)});
    }
    std::vector<std::vector<SeenMark>> of_view(views_.size());
    std::vector<std::vector<std::size_t>> point_of(views_.size());
    std::vector<BlurInformation> blur(views_.size());
    std::vector<std::vector<std::size_t>> tried(views_.size());
    const bool all = parallel_for(execution_, views_.size(), [&](std::size_t k, int) {
      const LensView& view = views_[k];
      for (std::size_t p = 0; p < points_.size(); ++p) {
        BoardMark mark;
        mark.pixel = picture_.pixel_of(view, expected[p].at);
        if (length(mark.pixel - view.see.centre) > view.see.visible - 1) continue;
        MicroView see = view.see;
        const double from_nominal = defocus_[static_cast<std::size_t>(view.place.type)];
        see.plane = view.blur_at(expected[p].at.z) + from_nominal;
        see.stop += from_nominal;
        const MarkFinder::Grid grid{picture_.pixel_of(view, expected[p].next_column) - mark.pixel,
                                    picture_.pixel_of(view, expected[p].next_row) - mark.pixel};
        if (board_.dots)
          mark.shape = {dot_radius_, 0};
        else
          mark.shape = {std::atan2(grid.column.y, grid.column.x),
                        std::atan2(grid.row.y, grid.row.x)};
        tried[k].push_back(p);
        BlurInformation own;
        if (!picture_.finder().fit_expected(see, grid, mark, own) ||
            parity(points_[p]) * dot(mark.diagonal, diagonal_) < 0)
          continue;
        blur[k].gradient += own.gradient;
        blur[k].curvature += own.curvature;
        of_view[k].push_back(picture_.seen_at(k, mark));
        point_of[k].push_back(p);
      }
    });
    if (!all) throw Cancelled();
    std::vector<std::size_t> tries(points_.size());
    for (const auto& points : tried)
      for (const std::size_t p : points) ++tries[p];
    take(of_view, point_of, tries, blur);
  }

  void take(const std::vector<std::vector<SeenMark>>& of_view,
            const std::vector<std::vector<std::size_t>>& point_of,
            const std::vector<std::size_t>& tries, const std::vector<BlurInformation>& blur) {
    put_marks(of_view);
    for (Point& point : points_) point.marks.clear(), point.diagonal = {};
    std::size_t mark = 0;
    for (const auto& points : point_of)
      for (const std::size_t p : points) {
        points_[p].marks.push_back(mark);
        points_[p].diagonal = points_[p].diagonal + marks_[mark].mark.diagonal;
        ++mark;
      }
    std::vector<Point> seen;
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (points_[p].marks.size() >= 2 && 2 * points_[p].marks.size() > tries[p])
        seen.push_back(points_[p]);
    points_ = seen;
    if (points_.size() < kFewestPoints)
      throw InputError(
          fmt::format("the board that is seen has {} points that show through two "
                      "microlenses or more; {}",
                      points_.size(), picture_.where_seen(board_.cell)));
    refit_plane();
    set_axes();
    for (Point& point : points_) {
      Vec2 sum;
      double weights = 0;
      for (const std::size_t k : point.marks) {
        const Vec3 p = point_of_mark(k);
        const double weight = 1 / (marks_[k].mark.error * marks_[k].mark.error);
        sum = sum + weight * Vec2{dot(p, right_), dot(p, down_)};
        weights += weight;
      }
      point.place = (1 / weights) * sum;
    }
    grid_ = GridToPlane::of(points_, board_.cell);
    for (std::size_t type = 0; type < defocus_.size(); ++type) {
      double gradient = -defocus_[type] / (kDefocus * kDefocus),
             curvature = 1 / (kDefocus * kDefocus);
      for (std::size_t k = 0; k < views_.size(); ++k)
        if (static_cast<std::size_t>(views_[k].place.type) == type) {
          gradient += blur[k].gradient;
          curvature += blur[k].curvature;
        }
      defocus_[type] += std::clamp(gradient / curvature, -kDefocus, kDefocus);
    }
  }

  /// Columns to the right and rows down in the picture, as far as the board allows, from its first
  /// point on.
  void orient(BoardCorners& found) {
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
    GridBox best_box;
    int widest = 0, highest = 0;
    for (int quarter = 0; quarter < 4; ++quarter) {
      GridBox box;
      for (const Point& point : points_) {
        const auto [c, r] = turned(point, quarter);
        box.add(c, r);
      }
      const int columns = box.columns(), rows = box.rows();
      if (quarter == 0) widest = columns, highest = rows;
      if (columns > board_.columns || rows > board_.rows) continue;
      // New first axis: the old one turned by this number of quarters.
      const double angle = turn_ + 0.5 * std::numbers::pi * quarter;
      double worth = std::cos(angle);
      // The first corner of a whole checkerboard has its bright squares along (1, 1).
      if (!board_.dots && columns == board_.columns && rows == board_.rows &&
          (columns + rows) % 2 == 1)
        for (const Point& point : points_) {
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
    const double whole = picture_.finder().lens_radius();
    for (const Point& point : points_) {
      ++found.points;
      const auto [c, r] = turned(point, best);
      for (const std::size_t k : point.marks)
        found.corners.push_back({marks_[k].lens, marks_[k].mark.pixel, c - best_box.left,
                                 r - best_box.top, marks_[k].mark.error,
                                 whole * marks_[k].mark.blur, whole * marks_[k].mark.blur_error});
    }
    found.whole = best_box.columns() == board_.columns && best_box.rows() == board_.rows;
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
  BoardViews picture_;
  const std::vector<LensView>& views_;
  /// By type: what corners tell of MicroView::plane and stop beyond the camera.
  std::vector<double> defocus_;
  double dot_radius_ = 0;  ///< [pixel]
  GridToPlane grid_;
  Vec2 diagonal_;         ///< of the bright squares, at corners of even column and row together
  std::size_t seen_ = 0;  ///< marks before the board was known
  std::vector<SeenMark> marks_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> by_lens_;
  BoardPlane plane_;
  Vec3 normal_, right_, down_;
  std::vector<Point> points_;
  double turn_ = 0;  ///< [rad] of the columns on the plane
};

}  // namespace

BoardCorners find_board(const Image& light, const CameraSpec& camera, const BoardSpec& board,
                        const Image& white, const Execution& execution) {
  if (board.columns < 2 || board.rows < 2 || !(board.cell > 0))
    throw InputError("a board has at least 2 x 2 points, and a distance between them");
  if (!camera.array.present)
    throw InputError("boards are looked for in micro-images, and the camera has no array");
  return BoardFinder(light, white, camera, board, execution).find();
}

}  // namespace plenoflame
