#include "plenoflame/calibration/white_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "calibration/lattice_model.h"
#include "calibration/micro_image_fit.h"
#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

using Places = std::map<std::pair<int, int>, MicroImageFit>;  ///< by j, then i

/// Mean of values, and its standard error.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
    ++count_;
  }
  std::size_t size() const { return count_; }
  double value() const { return sum_ / n(); }
  double error() const {
    return std::sqrt(std::max(squares_ / n() - value() * value(), 0.0) / n());
  }

 private:
  double n() const { return static_cast<double>(std::max<std::size_t>(count_, 1)); }
  double sum_ = 0, squares_ = 0;
  std::size_t count_ = 0;
};

double middle_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The lattice from the neighbours of the centre that is nearest to the middle of all.
LatticeGuess guess_of_centres(const std::vector<Vec2>& centres, int width, int height) {
  if (centres.size() < 12) throw InputError("a lattice takes 12 centres or more");
  Vec2 mean;
  for (const Vec2 centre : centres)
    mean = mean + (1.0 / static_cast<double>(centres.size())) * centre;
  for (const Vec2 centre : centres)
    if (!(centre.x >= 0 && centre.y >= 0 && centre.x <= width && centre.y <= height))
      throw InputError(
          fmt::format("a centre at {:g}, {:g} does not lie in the picture of {} x {} pixels",
                      centre.x, centre.y, width, height));
  const Vec2 origin = *std::min_element(centres.begin(), centres.end(), [&](Vec2 a, Vec2 b) {
    return length(a - mean) < length(b - mean);
  });
  std::vector<Vec2> around;
  for (const Vec2 centre : centres)
    if (length(centre - origin) > 0) around.push_back(centre - origin);
  std::sort(around.begin(), around.end(), [](Vec2 a, Vec2 b) { return length(a) < length(b); });
  // Six neighbours of a hexagonal lattice are about as near, of a square one four.
  const auto near = static_cast<std::size_t>(std::count_if(
      around.begin(), around.end(), [&](Vec2 d) { return length(d) < 1.2 * length(around[0]); }));
  if (near != 4 && near != 6)
    throw InputError(
        fmt::format("the centre at {:.1f}, {:.1f} has {} neighbours at about the same distance "
                    "({:.2f} pixels): "
                    "neither a square nor a hexagonal lattice",
                    origin.x, origin.y, near, length(around[0])));
  around.resize(near);
  LatticeGuess guess;
  guess.hexagonal = near == 6;
  guess.origin = origin;
  guess.contrast = 1;
  guess.radius = 0.4 * length(around[0]);
  const auto direction = [](Vec2 v) { return std::atan2(v.y, v.x); };
  const auto nearest_to = [&](double angle) {
    return *std::min_element(around.begin(), around.end(), [&](Vec2 a, Vec2 b) {
      const auto off = [&](Vec2 v) {
        return std::fabs(std::remainder(direction(v) - angle, 2 * std::numbers::pi));
      };
      return off(a) < off(b);
    });
  };
  guess.step_i = nearest_to(1e-9);
  guess.step_j =
      nearest_to(direction(guess.step_i) + (guess.hexagonal ? 60 : 90) * std::numbers::pi / 180);
  return guess;
}

/// Measures the micro-image that should be at a place.
using Measure = std::function<MicroImageFit(const MicroImageFit& start)>;

/// Measures from the middle outwards: the model of what is known says where the next ones are.
class LatticeMeasurer {
 public:
  LatticeMeasurer(const LatticeGuess& guess, int width, int height, Measure measure,
                  const Execution& execution)
      : width_(width), height_(height), measure_(std::move(measure)), execution_(execution) {
    result_.guess = guess;
  }

  WhiteLattice run() {
    result_.model = plain_model(result_.guess, width_, height_);
    radius_ = result_.guess.radius;
    blur_ = 0.2 * radius_;
    const double whole = std::hypot(width_, height_) / (2 * length(result_.guess.step_j)) * 1.3 + 2;
    for (double reach = 4;; reach *= 1.7) {
      measure_new(std::min(reach, whole));
      refit(reach >= whole);
      if (reach >= whole) break;
    }
    // Micro-images whose fit began far off, or beside a wrong start, are tried again from the
    // model.
    remeasure();
    refit(true);
    summarise();
    return std::move(result_);
  }

 private:
  MicroImageFit start_at(int i, int j) const {
    MicroImageFit start;
    start.i = i;
    start.j = j;
    start.centre = result_.model.point(i, j);
    start.radius = radius_;
    start.blur = blur_;
    return start;
  }

  bool inside(Vec2 centre) const {
    return centre.x > 0 && centre.y > 0 && centre.x < width_ && centre.y < height_;
  }

  void measure(std::vector<MicroImageFit>& starts) const {
    const bool done =
        parallel_for(execution_, (starts.size() + 63) / 64, [&](std::size_t block, int) {
          for (std::size_t k = 64 * block; k < std::min(starts.size(), 64 * block + 64); ++k)
            starts[k] = measure_(starts[k]);
        });
    if (!done) throw Cancelled();
  }

  void measure_new(double reach) {
    const LatticeGuess& guess = result_.guess;
    const double limit = reach * guess.pitch();
    const int most = static_cast<int>(1.6 * reach) + 2;
    std::vector<MicroImageFit> starts;
    for (int j = -most; j <= most; ++j)
      for (int i = -most; i <= most; ++i) {
        const Vec2 about =
            static_cast<double>(i) * guess.step_i + static_cast<double>(j) * guess.step_j;
        if (length(about) > limit || places_.count({j, i}) != 0) continue;
        const MicroImageFit start = start_at(i, j);
        if (inside(start.centre)) starts.push_back(start);
      }
    measure(starts);
    for (const MicroImageFit& fit : starts) places_[{fit.j, fit.i}] = fit;
  }

  void remeasure() {
    std::vector<MicroImageFit> starts;
    for (auto& [place, fit] : places_)
      if (!fit.good || length(fit.centre - result_.model.point(fit.i, fit.j)) > 0.5)
        starts.push_back(start_at(fit.i, fit.j));
    measure(starts);
    for (const MicroImageFit& fit : starts) places_[{fit.j, fit.i}] = fit;
  }

  void refit(bool all) {
    result_.images.clear();
    std::vector<double> radii, blurs, residuals;
    for (const auto& [place, fit] : places_) {
      result_.images.push_back(fit);
      if (!fit.good) continue;
      radii.push_back(fit.radius);
      blurs.push_back(fit.blur);
      residuals.push_back(fit.rms);
    }
    if (radii.size() < 12)
      throw InputError(
          fmt::format("the picture repeats every {:.2f} pixels ({}), but only {} of {} places in "
                      "its middle hold "
                      "something like a bright disc: micro-images of a white picture are wanted",
                      result_.guess.pitch(), result_.guess.hexagonal ? "hexagonal" : "square",
                      radii.size(), places_.size()));
    radius_ = middle_of(radii);
    blur_ = middle_of(blurs);
    // Vignetted micro-images are no discs: their residuals are large, and their radii small.
    const double usual = middle_of(residuals);
    for (MicroImageFit& image : result_.images)
      if (image.good)
        image.good = image.rms < 2.5 * usual + 0.01 && image.radius > 0.85 * radius_ &&
                     image.radius < 1.15 * radius_;
    const auto good =
        static_cast<std::size_t>(std::count_if(result_.images.begin(), result_.images.end(),
                                               [](const auto& image) { return image.good; }));
    fit_lattice_model(result_.images, all && good > 60, result_.model);
  }

  void summarise() {
    double squares = 0;
    result_.good = 0;
    std::vector<MicroImageFit> kept;
    for (MicroImageFit& image : result_.images) {
      image.model = result_.model.point(image.i, image.j);
      if (!inside(image.model)) continue;
      if (image.good) {
        const double off = length(image.centre - image.model);
        squares += off * off;
        result_.worst = std::max(result_.worst, off);
        ++result_.good;
      }
      kept.push_back(image);
    }
    result_.images = std::move(kept);
    result_.rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(result_.good, 1)));
    const Vec2 i = 0.5 * (result_.model.point(1, 0) - result_.model.point(-1, 0));
    const Vec2 j = 0.5 * (result_.model.point(0, 1) - result_.model.point(0, -1));
    result_.pitch_i = length(i);
    result_.pitch_j = length(j);
    result_.rotation = std::atan2(i.y, i.x);
    find_types();
  }

  /// The excess of a micro-image over its neighbours, which are of other types: what changes
  /// slowly over the picture drops out.
  std::vector<double> against_neighbours(double MicroImageFit::*looks) const {
    std::map<std::pair<int, int>, const MicroImageFit*> at;
    for (const MicroImageFit& image : result_.images)
      if (image.good) at[{image.j, image.i}] = &image;
    std::vector<std::pair<int, int>> steps{{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    if (result_.guess.hexagonal) steps.insert(steps.end(), {{1, -1}, {-1, 1}});
    std::vector<double> values;
    for (const MicroImageFit& image : result_.images) {
      double sum = 0;
      std::size_t count = 0;
      for (const auto& [di, dj] : steps) {
        const auto found = at.find({image.j + dj, image.i + di});
        if (found == at.end()) continue;
        sum += found->second->*looks;
        ++count;
      }
      values.push_back(image.good && count == steps.size()
                           ? image.*looks - sum / static_cast<double>(count)
                           : std::numeric_limits<double>::quiet_NaN());
    }
    return values;
  }

  static int type_of(const MicroImageFit& image, int types) {
    return ((image.j - image.i) % types + types) % types;  // lens (q, r) = (-i, -j): q - r
  }

  /// Largest difference of the types' means, in standard errors and in pixels.
  std::pair<double, double> difference(int types) const {
    std::pair<double, double> best{0, 0};
    for (double MicroImageFit::*looks : {&MicroImageFit::radius, &MicroImageFit::blur}) {
      const std::vector<double> values = against_neighbours(looks);
      std::vector<double> sum(static_cast<std::size_t>(types)), square = sum, count = sum;
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (!std::isfinite(values[k])) continue;
        const auto t = static_cast<std::size_t>(type_of(result_.images[k], types));
        sum[t] += values[k];
        square[t] += values[k] * values[k];
        count[t] += 1;
      }
      double low = 1e300, high = -1e300, error = 0;
      for (std::size_t t = 0; t < sum.size(); ++t) {
        if (count[t] < 4) return {0, 0};
        const double mean = sum[t] / count[t];
        error = std::max(error,
                         std::sqrt(std::max(square[t] / count[t] - mean * mean, 0.0) / count[t]));
        low = std::min(low, mean);
        high = std::max(high, mean);
      }
      if (high - low > best.second) best = {(high - low) / std::max(error, 1e-12), high - low};
    }
    return best;
  }

  void find_types() {
    // Less is what the places of pixels do to a fit.
    constexpr double kLeastDifference = 0.08, kLeastScore = 8;
    int types = 1;
    double most = 0;
    for (const int candidate : {3, 2}) {
      const auto [score, size] = difference(candidate);
      if (score < kLeastScore || size < kLeastDifference || size < 1.2 * most) continue;
      most = size;
      types = candidate;
    }
    for (MicroImageFit& image : result_.images) image.type = type_of(image, types);
    result_.types = looks_of(result_.images, types);
  }

 public:
  static std::vector<TypeLooks> looks_of(const std::vector<MicroImageFit>& images, int types) {
    Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
    for (const MicroImageFit& image : images) {
      low = {std::min(low.x, image.model.x), std::min(low.y, image.model.y)};
      high = {std::max(high.x, image.model.x), std::max(high.y, image.model.y)};
    }
    const Vec2 middle = 0.5 * (low + high);
    const double reach = 0.25 * length(high - low);  // farther out the lens' barrel cuts light off
    std::vector<TypeLooks> looks(static_cast<std::size_t>(types));
    for (int t = 0; t < types; ++t) {
      Mean radius, blur, even;
      for (const MicroImageFit& image : images) {
        if (!image.good || image.type != t) continue;
        radius.add(image.radius);
        blur.add(image.blur);
        if (length(image.model - middle) <= reach) even.add(image.even_radius);
      }
      looks[static_cast<std::size_t>(t)] = {radius.value(), blur.value(), radius.error(),
                                            blur.error(),   even.value(), even.error(),
                                            radius.size()};
    }
    return looks;
  }

 private:
  int width_, height_;
  Measure measure_;
  const Execution& execution_;
  WhiteLattice result_;
  Places places_;
  double radius_ = 0, blur_ = 0;
};

}  // namespace

WhiteLattice measure_white(const Image& white, const Execution& execution) {
  const LatticeGuess guess = find_lattice(white);
  const LatticeCell cell(guess, white);
  return LatticeMeasurer(
             guess, white.width, white.height,
             [&](const MicroImageFit& start) { return fit_micro_image(white, cell, start); },
             execution)
      .run();
}

WhiteLattice lattice_of_centres(const std::vector<Vec2>& centres, int width, int height) {
  const LatticeGuess guess = guess_of_centres(centres, width, height);
  // Buckets as wide as a pitch.
  const double pitch = guess.pitch();
  std::map<std::pair<int, int>, std::vector<Vec2>> buckets;
  const auto bucket = [pitch](double v) { return static_cast<int>(std::floor(v / pitch)); };
  for (const Vec2 centre : centres) buckets[{bucket(centre.y), bucket(centre.x)}].push_back(centre);
  return LatticeMeasurer(guess, width, height,
                         [&](const MicroImageFit& start) {
                           MicroImageFit fit = start;
                           fit.good = false;
                           double best = 0.35 * pitch;
                           for (int v = -1; v <= 1; ++v)
                             for (int u = -1; u <= 1; ++u) {
                               const auto found = buckets.find(
                                   {bucket(start.centre.y) + v, bucket(start.centre.x) + u});
                               if (found == buckets.end()) continue;
                               for (const Vec2 centre : found->second) {
                                 const double off = length(centre - start.centre);
                                 if (off >= best) continue;
                                 best = off;
                                 fit.centre = centre;
                                 fit.good = true;
                               }
                             }
                           return fit;
                         },
                         {})
      .run();
}

std::vector<TypeLooks> looks_at(const Image& white, const WhiteLattice& lattice,
                                const Execution& execution) {
  const LatticeCell cell(lattice.guess, white);
  // The stop's image is smaller or larger, so its size in the middle of the picture is found first.
  const double radius = find_lattice(white).radius;
  std::vector<MicroImageFit> images = lattice.images;
  const bool done = parallel_for(execution, images.size(), [&](std::size_t k, int) {
    if (!images[k].good) return;
    MicroImageFit start = images[k];
    start.centre = start.model;
    start.radius = radius;
    images[k] = fit_micro_image(white, cell, start);
    images[k].type = start.type;
  });
  if (!done) throw Cancelled();
  return LatticeMeasurer::looks_of(images, static_cast<int>(lattice.types.size()));
}

}  // namespace plenoflame
