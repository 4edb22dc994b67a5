#include "plenoflame/calibration/array_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "math/levenberg_marquardt.h"
#include "plenoflame/base/error.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {
namespace {

/// The pixel where the ray through the middles of a microlens and of the stop arrives [pixel], by
/// Newton's method from a place nearby.
std::optional<Vec2> traced_centre(const Camera& camera, LensIndex lens, Vec2 start) {
  Vec2 at = camera.sensor_point(start.x, start.y);
  const double step = 0.1 * camera.spec().sensor.pixel_pitch;
  for (int round = 0; round < 8; ++round) {
    const auto here = camera.at_stop(at, lens), right = camera.at_stop({at.x + step, at.y}, lens),
               down = camera.at_stop({at.x, at.y + step}, lens);
    if (!here || !right || !down) return std::nullopt;
    const double a = (right->x - here->x) / step, b = (down->x - here->x) / step,
                 c = (right->y - here->y) / step, d = (down->y - here->y) / step;
    const double determinant = a * d - b * c;
    if (!(std::fabs(determinant) > 0)) return std::nullopt;
    const Vec2 change{(d * here->x - b * here->y) / determinant,
                      (a * here->y - c * here->x) / determinant};
    at = at - change;
    if (length(change) < 1e-6 * camera.spec().sensor.pixel_pitch) return camera.image_point(at);
  }
  return std::nullopt;
}

/// Lens (0, 0) becomes the nominal camera's. It is the micro-image of its type nearest to the
/// nominal place, if that is at most one pitch away.
void choose_origin(const CameraSpec& nominal, const WhiteLattice& lattice, Vec2 middle,
                   ArrayFit& fit) {
  const std::optional<Vec2> expected = traced_centre(Camera(nominal), {0, 0}, middle);
  if (!expected) return;
  const bool several = lattice.types.size() == nominal.array.types.size();
  const int types = several ? static_cast<int>(lattice.types.size()) : 1;
  const int shift = fit.origin_j - fit.origin_i;
  double nearest = lattice.guess.pitch();
  for (const MicroImageFit& image : lattice.images) {
    if ((image.j - image.i - shift) % types != 0) continue;
    const double distance = length(image.model - *expected);
    if (distance > nearest) continue;
    nearest = distance;
    fit.same_origin = true;
    fit.origin_i = image.i;
    fit.origin_j = image.j;
  }
}

CameraSpec with_array(const CameraSpec& nominal, const ArraySpec& array) {
  CameraSpec spec = nominal;
  spec.array = array;
  return spec;
}

}  // namespace

LensIndex lens_of(const ArrayFit& fit, int i, int j) {
  return {fit.origin_i - i, fit.origin_j - j};
}

ArraySpec plain_array(const WhiteLattice& lattice, Vec2 pixel, int width, int height) {
  ArraySpec array;
  array.present = true;
  array.lattice = lattice.guess.hexagonal ? Lattice::hexagonal : Lattice::square;
  // Steps in metres: pixels need not be square.
  const LatticeModel& model = lattice.model;
  const auto metres = [&](Vec2 v) { return Vec2{pixel.x * v.x, pixel.y * v.y}; };
  const Vec2 i = metres(0.5 * (model.point(1, 0) - model.point(-1, 0)));
  const Vec2 j = metres(0.5 * (model.point(0, 1) - model.point(0, -1)));
  array.pitch = lattice.guess.hexagonal ? 0.5 * (length(i) + length(j)) : length(i);
  if (!lattice.guess.hexagonal && std::fabs(length(j) / length(i) - 1) > 1e-3)
    array.pitch_y = length(j);
  array.rotation = std::atan2(i.y, i.x);
  const Vec2 origin = model.point(0, 0);
  array.offset = {(0.5 * width - origin.x) * pixel.x, (0.5 * height - origin.y) * pixel.y};
  return array;
}

std::vector<double> expected_blur(const CameraSpec& spec) {
  const Camera camera(spec);
  const double pupil = camera.exit_pupil() - camera.array_front();
  std::vector<double> blur;
  for (const Microlens& lens : camera.microlenses()) {
    const double b = lens.sensor_distance;
    blur.push_back(
        0.5 * spec.array.diameter *
        std::fabs(1 - b / lens.first_order.focal_length + (std::isfinite(pupil) ? b / pupil : 0)) /
        spec.sensor.pixel_pitch);
  }
  return blur;
}

ArrayFit fit_array(const CameraSpec& nominal, const WhiteLattice& lattice, int width, int height,
                   bool tilt) {
  if (!nominal.array.present)
    throw InputError("the camera has no microlens array to be fitted (camera.array)");
  const bool hexagonal = nominal.array.lattice == Lattice::hexagonal;
  if (hexagonal != lattice.guess.hexagonal)
    throw InputError(fmt::format("the camera's lattice is {}, that of the white picture {}",
                                 hexagonal ? "hexagonal" : "square",
                                 hexagonal ? "square" : "hexagonal"));
  if (nominal.sensor.columns != width || nominal.sensor.rows != height)
    throw InputError(
        fmt::format("the camera's sensor has {} x {} pixels, the white picture {} x {}: where a "
                    "part in its middle was read out, set camera.sensor.columns={} and "
                    "camera.sensor.rows={}",
                    nominal.sensor.columns, nominal.sensor.rows, width, height, width, height));
  ArrayFit fit;
  // Lens (0, 0) has the first type: of the neighbours of the middle the one that looks like it.
  const auto types = static_cast<int>(nominal.array.types.size());
  if (types > 1 && lattice.types.size() == nominal.array.types.size()) {
    const std::vector<double> expected = expected_blur(nominal);
    double best = -2;
    for (int shift = 0; shift < types; ++shift) {
      double mean_e = 0, mean_s = 0, es = 0, ee = 0, ss = 0;
      const auto seen = [&](int t) {
        return lattice.types[static_cast<std::size_t>((t + shift) % types)].blur;
      };
      for (int t = 0; t < types; ++t) {
        mean_e += expected[static_cast<std::size_t>(t)] / types;
        mean_s += seen(t) / types;
      }
      for (int t = 0; t < types; ++t) {
        const double e = expected[static_cast<std::size_t>(t)] - mean_e, s = seen(t) - mean_s;
        es += e * s;
        ee += e * e;
        ss += s * s;
      }
      const double match = es / std::max(std::sqrt(ee * ss), 1e-300);
      if (match <= best) continue;
      best = match;
      // Type by lattice point is (j - i) mod n; lens (0, 0) stands at a point of type `shift`.
      // Types of lenses count the other way: lens (q, r) = (i0 - i, j0 - j) has (q - r) = (j - i) -
      // shift.
      fit.origin_i = 0;
      fit.origin_j = shift;
      if (shift == 2) {
        fit.origin_i = 1;
        fit.origin_j = 0;
      }
    }
    fit.type_match = best;
  }
  choose_origin(nominal, lattice, {0.5 * width, 0.5 * height}, fit);

  std::vector<const MicroImageFit*> used;
  constexpr std::size_t kEnough = 1500;
  const std::size_t stride = std::max<std::size_t>(1, lattice.good / kEnough);
  std::size_t k = 0;
  for (const MicroImageFit& image : lattice.images)
    if (image.good && k++ % stride == 0) used.push_back(&image);
  if (used.size() < 6) throw InputError("too few micro-images for a fit of the array");

  ArraySpec array = nominal.array;
  const ArraySpec plain = plain_array(lattice, nominal.sensor.pixel(), width, height);
  array.rotation = plain.rotation;
  // Micro-images lie further apart than microlenses, by the distance of both from the exit pupil.
  const Camera first(nominal);
  const double pupil = first.exit_pupil();
  const double grow =
      std::isfinite(pupil) ? (pupil - first.sensor()) / (pupil - first.array_front()) : 1;
  array.pitch = plain.pitch / grow;
  if (plain.pitch_y > 0)
    array.pitch_y = plain.pitch_y / grow;
  else
    array.pitch_y = 0;
  const Vec2 origin = lattice.model.point(fit.origin_i, fit.origin_j);
  array.offset = (1 / grow) * first.sensor_point(origin.x, origin.y);
  array.diameter = std::min(array.diameter, array.pitch);
  fit.tilted = tilt;
  const bool two = array.pitch_y > 0;
  const int count = 4 + (tilt ? 2 : 0) + (two ? 1 : 0);
  if (tilt) array.tilt = {};
  Eigen::VectorXd steps(count);
  steps[0] = 1e-5 * array.pitch;
  steps[1] = 1e-5;
  steps[2] = steps[3] = 1e-2 * array.pitch;
  if (tilt) steps[4] = steps[5] = 1e-4;
  if (two) steps[count - 1] = steps[0];
  const auto changed = [&](const ArraySpec& from, const Eigen::VectorXd& in_steps) {
    const Eigen::VectorXd by = in_steps.cwiseProduct(steps);
    ArraySpec to = from;
    to.pitch += by[0];
    to.rotation += by[1];
    to.offset.x += by[2];
    to.offset.y += by[3];
    if (tilt) {
      to.tilt.x += by[4];
      to.tilt.y += by[5];
    }
    if (two) to.pitch_y += by[count - 1];
    to.diameter = std::min(to.diameter, to.pitch);
    return to;
  };
  const auto centres = [&](const ArraySpec& spec) {
    const Camera camera(with_array(nominal, spec));
    std::vector<std::optional<Vec2>> places;
    for (const MicroImageFit* image : used)
      places.push_back(traced_centre(camera, lens_of(fit, image->i, image->j), image->model));
    return places;
  };
  // A camera that cannot be as the lattice is differs from it alike over a region of the sensor.
  constexpr int kRegionsAcross = 3, kRegions = kRegionsAcross * kRegionsAcross;
  const auto region_of = [&](Vec2 place) {
    const auto cell = [](double at, int size) {
      return std::clamp(static_cast<int>(kRegionsAcross * at / size), 0, kRegionsAcross - 1);
    };
    return cell(place.y, height) * kRegionsAcross + cell(place.x, width);
  };
  // Calls use(image, centre by the camera, its derivatives) where rays reach the micro-image.
  const auto for_images = [&](const ArraySpec& from, const auto& use) {
    const auto here = centres(from);
    std::vector<std::vector<std::optional<Vec2>>> moved;
    for (int a = 0; a < count; ++a)
      moved.push_back(centres(changed(from, Eigen::VectorXd::Unit(count, a))));
    for (std::size_t n = 0; n < used.size(); ++n) {
      Eigen::Matrix<double, 2, Eigen::Dynamic> slope(2, count);
      bool whole = here[n].has_value();
      for (std::size_t a = 0; whole && a < moved.size(); ++a) {
        whole = moved[a][n].has_value();
        if (!whole) break;
        const Vec2 d = *moved[a][n] - *here[n];
        slope.col(static_cast<Eigen::Index>(a)) << d.x, d.y;
      }
      if (whole) use(*used[n], *here[n], slope);
    }
  };
  using Equations = NormalEquations<Eigen::Dynamic>;
  Equations equations;
  minimise(array, equations,
           [&](const ArraySpec& from) -> std::optional<Equations> {
             Equations sums{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count)};
             // The lattice's model has the noise of all micro-images, of which these are some.
             for_images(from, [&](const MicroImageFit& image, Vec2 here, const auto& slope) {
               const Eigen::Vector2d off(image.model.x - here.x, image.model.y - here.y);
               sums.square += slope.transpose() * slope;
               sums.right += slope.transpose() * off;
               sums.sum += off.squaredNorm();
             });
             return sums;
           },
           changed, {5, 1e-9});
  Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(count, kRegions);
  double squares = 0;
  for_images(array, [&](const MicroImageFit& image, Vec2 here, const auto& slope) {
    const Vec2 off = image.centre - here, smooth = image.model - here;
    squares += dot(off, off);
    fit.worst = std::max(fit.worst, length(off));
    ++fit.used;
    pulls.col(region_of(image.model)) += slope.transpose() * Eigen::Vector2d(smooth.x, smooth.y);
  });
  if (fit.used < 6)
    throw InputError(
        "no ray of the nominal camera reaches the micro-images: check its lens, focus and "
        "sensor");
  fit.rms = std::sqrt(squares / static_cast<double>(fit.used));
  // The variance has two parts. The first is the noise of all good micro-images, whose model has at
  // most ten numbers. The second is the scatter between regions, each of which counts once (Liang
  // and Zeger 1986, Biometrika 73, 13). An error common to the whole sensor is known by its order
  // of magnitude at best.
  const Eigen::MatrixXd inverse = equations.square.inverse();
  if (!inverse.allFinite()) throw InputError("the array's numbers cannot be told from each other");
  const auto all = static_cast<double>(lattice.good);
  const double variance = lattice.rms * lattice.rms * all / (2 * all - 10);
  const Eigen::MatrixXd covariance = variance * (static_cast<double>(used.size()) / all) * inverse +
                                     inverse * pulls * pulls.transpose() * inverse;
  const auto error = [&](int a) { return std::sqrt(covariance(a, a)) * steps[a]; };
  // The middle of a soft disc differs from the ray through the middle of the stop by some
  // thousandths of a pixel. It is largest at the edge, and more centres do not help.
  constexpr double kTrueCentres = 0.01;  // [pixel] in the corners
  fit.pitch_error =
      std::hypot(error(0), array.pitch * kTrueCentres / (0.5 * std::hypot(width, height)));
  fit.rotation_error = error(1);
  fit.offset_error = {error(2), error(3)};
  if (tilt) fit.tilt_error = {error(4), error(5)};
  fit.array = array;
  return fit;
}

}  // namespace plenoflame
