#include "model/eye_view.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/colour.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/math/ray_span.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/volumes/load_medium.h"

namespace plenoflame::desktop {
namespace {

using Point = EyeFlame::Point;

constexpr double kFar = 1e300;         ///< [m] beyond all flames
constexpr double kBrightShare = 0.98;  ///< of the columns with light that are darker than `bright`
constexpr double kBrightOnScreen = 0.9;  ///< exposure of these, of white
constexpr double kGlare = 0.08;          ///< share of the light that is scattered in the eye
constexpr double kWhitening = 0.55;      ///< of the brightest light that loses its colour
constexpr double kFading = 0.15;         ///< share of a grid's height in which its axis fades

Vec3 least_of(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3 most_of(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// The scene's flames before an eye instead of its camera: no filters, no windows.
Scene seen_by_eye(const Scene& scene) {
  Scene eye;
  eye.channels.clear();
  eye.file = scene.file;
  eye.flames = scene.flames;
  for (const char* response : {"cie_x", "cie_y", "cie_z"}) {
    ChannelSpec channel;
    channel.name = response;
    channel.kind = ChannelKind::named;
    channel.response = response;
    eye.channels.push_back(channel);
  }
  return eye;
}

/// Calls work(row) for all rows. @throws Cancelled
template <class Work>
void for_rows(int rows, const Execution& execution, const Work& work) {
  if (!parallel_for(execution, static_cast<std::size_t>(rows),
                    [&](std::size_t row, int) { work(static_cast<int>(row)); }))
    throw Cancelled();
}

/// Source functions of the nodes, by straight lines between temperatures. Exact ones would take
/// longer than all else: each of them is a sum of exponentials.
class SourceTable {
 public:
  explicit SourceTable(const std::vector<SourceFunction>& sources) : sources_(sources) {
    values_.reserve(kKnots * sources.size());
    for (std::size_t knot = 0; knot < kKnots; ++knot)
      for (const SourceFunction& source : sources)
        values_.push_back(source(kStep * static_cast<double>(knot)));
  }
  void at(double temperature, double* each) const {
    const double place = std::max(0.0, temperature) / kStep;
    const std::size_t count = sources_.size();
    if (!(place < kKnots - 1)) {
      for (std::size_t n = 0; n < count; ++n) each[n] = sources_[n](temperature);
      return;
    }
    const auto knot = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(knot);
    const double* const value = &values_[knot * count];
    for (std::size_t n = 0; n < count; ++n)
      each[n] = value[n] + share * (value[count + n] - value[n]);
  }

 private:
  static constexpr double kStep = 2;  ///< [K]; an error of 2e-4 at 1500 K in the blue
  static constexpr std::size_t kKnots = 3001;
  const std::vector<SourceFunction>& sources_;
  std::vector<double> values_;
};

/// True if a medium emits nothing but its absorption times the source functions.
bool is_thermal(const FlameSpec& flame) {
  return flame.lines.empty() && flame.scattering.grid.empty();
}

/// True if the medium of any channels tells the eye all.
bool is_same_in_all_channels(const FlameSpec& flame) {
  return flame.spectrum.kind == SpectrumKind::grey && flame.lines.empty() &&
         !flame.scattering.present();
}

/// The share of its light and absorption that a place of a grid keeps. Soot and plumes may end at
/// full brightness where their grid does: a picture of them would end in a cut. The axis fades from
/// 0.85 of the height to its end. The middles of the sides fade from 0.70 to 0.85, the corners from
/// 0.55 to 0.70.
double kept_share(const Box& flame, const Vec3& place) {
  const Vec3 half = 0.5 * (flame.upper - flame.lower), from = place - flame.lower - half;
  const double dome = from.x * from.x / (half.x * half.x) + from.y * from.y / (half.y * half.y);
  const double t = std::clamp((half.z - from.z) / (2 * kFading * half.z) - dome, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Adds the light of one flame.
void add_flame(const Medium& medium, const SpectralNodes& nodes, const SourceTable& table,
               const FlameSpec& flame, const Execution& execution, EyeFlame& all) {
  const auto count = nodes.sources.size();
  const auto weight = [&](int channel, std::size_t node) {
    if (nodes.mix.empty()) return static_cast<std::size_t>(channel) == node ? 1.0 : 0.0;
    return nodes.mix.weight(channel, static_cast<int>(node));
  };
  const bool thermal = is_thermal(flame), grey = medium.is_grey();
  const bool is_grid = flame.kind == FlameKind::vdb;
  const Box box = medium.bounds();
  const auto [nx, ny, nz] = all.count;
  // Layers end within a step: a point has the mean of its surroundings.
  const std::vector<double> sides = is_grid ? std::vector{0.0} : std::vector{-0.25, 0.25};
  const double share = 1 / std::pow(static_cast<double>(sides.size()), 3);
  const auto add = [&](const Vec3& place, double kept, std::vector<double>& emission,
                       std::vector<double>& absorption, Point& point) {
    if (thermal) {
      const MediumSample here = medium.sample(place);
      if (here.absorption == 0) return;
      if (grey)
        std::fill(absorption.begin(), absorption.end(), here.absorption);
      else
        medium.absorptions(place, absorption.data());
      table.at(here.temperature, emission.data());
      for (std::size_t n = 0; n < count; ++n) emission[n] *= absorption[n];
    } else {
      medium.absorptions(place, absorption.data());
      // Light without absorption is that of lines.
      if (flame.lines.empty() && absorption.front() == 0 && absorption.back() == 0) return;
      medium.coefficients(place, emission.data());
    }
    std::array<double, 3> xyz{};
    double luminous = 0;
    for (std::size_t n = 0; n < count; ++n)
      for (int c = 0; c < 3; ++c) {
        const double light = flame.brightness * weight(c, n) * emission[n];
        xyz[static_cast<std::size_t>(c)] += light;
        if (c == 1) luminous += light * absorption[n];
      }
    point.x += static_cast<float>(kept * xyz[0]);
    point.y += static_cast<float>(kept * xyz[1]);
    point.z += static_cast<float>(kept * xyz[2]);
    point.absorption +=
        static_cast<float>(kept * (xyz[1] > 0 ? luminous / xyz[1] : absorption.front()));
  };
  for_rows(ny * nz, execution, [&, nx = nx, ny = ny](int row) {
    std::vector<double> emission(count), absorption(count);
    for (int i = 0; i < nx; ++i) {
      const auto place = [&](double a, double b, double c) {
        return Vec3{all.origin.x + (i + a) * all.step.x, all.origin.y + (row % ny + b) * all.step.y,
                    all.origin.z + (row / ny + c) * all.step.z};
      };
      const double kept = share * (is_grid ? kept_share(box, place(0, 0, 0)) : 1);
      if (kept == 0) continue;
      Point& point = all.points[static_cast<std::size_t>(row) * static_cast<std::size_t>(nx) +
                                static_cast<std::size_t>(i)];
      for (const double a : sides)
        for (const double b : sides)
          for (const double c : sides) add(place(a, b, c), kept, emission, absorption, point);
    }
  });
}

/// Luminance of the bright columns along the axis that has least. Flames are seen from the side,
/// and are brighter along their length.
double bright_of(const EyeFlame& flame) {
  double bright = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const std::array<std::size_t, 3> stride{
        1, static_cast<std::size_t>(flame.count[0]),
        static_cast<std::size_t>(flame.count[0]) * static_cast<std::size_t>(flame.count[1])};
    const double length = axis == 0 ? flame.step.x : axis == 1 ? flame.step.y : flame.step.z;
    std::vector<double> sums;
    for (int i = 0; i < flame.count[u]; ++i)
      for (int j = 0; j < flame.count[v]; ++j) {
        double sum = 0, passed = 1;
        for (int k = 0; k < flame.count[axis]; ++k) {
          const Point& p = flame.points[static_cast<std::size_t>(i) * stride[u] +
                                        static_cast<std::size_t>(j) * stride[v] +
                                        static_cast<std::size_t>(k) * stride[axis]];
          sum += passed * static_cast<double>(p.y) * length;
          if (p.absorption > 0) passed *= std::exp(-static_cast<double>(p.absorption) * length);
        }
        if (sum > 0) sums.push_back(sum);
      }
    if (sums.empty()) return 0;
    // Columns through the faint rim say nothing of what is bright.
    const double least = 0.02 * *std::max_element(sums.begin(), sums.end());
    std::erase_if(sums, [&](double sum) { return sum < least; });
    const auto at = sums.begin() + static_cast<std::ptrdiff_t>(
                                       kBrightShare * static_cast<double>(sums.size() - 1));
    std::nth_element(sums.begin(), at, sums.end());
    bright = axis == 0 ? *at : std::min(bright, *at);
  }
  return bright;
}

/// Values between the points, by straight lines.
Point between(const EyeFlame& flame, double x, double y, double z) {
  std::array<std::size_t, 3> cell{};
  std::array<float, 3> share{};
  const std::array<double, 3> place{x, y, z};
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = std::clamp(place[k], 0.0, static_cast<double>(flame.count[k] - 1));
    cell[k] = static_cast<std::size_t>(std::min(static_cast<int>(at), flame.count[k] - 2));
    share[k] = static_cast<float>(at - static_cast<double>(cell[k]));
  }
  const auto row = static_cast<std::size_t>(flame.count[0]);
  const auto layer = row * static_cast<std::size_t>(flame.count[1]);
  const Point* const first = &flame.points[cell[0] + row * cell[1] + layer * cell[2]];
  Point sum;
  for (std::size_t k = 0; k < 8; ++k) {
    const bool dx = (k & 1U) != 0, dy = (k & 2U) != 0, dz = (k & 4U) != 0;
    const Point& p = first[(dx ? 1 : 0) + (dy ? row : 0) + (dz ? layer : 0)];
    const float w = (dx ? share[0] : 1 - share[0]) * (dy ? share[1] : 1 - share[1]) *
                    (dz ? share[2] : 1 - share[2]);
    sum.x += w * p.x;
    sum.y += w * p.y;
    sum.z += w * p.z;
    sum.absorption += w * p.absorption;
  }
  return sum;
}

/// Blurs by the mean of neighbours, three times, which is nearly a bell.
void blur(std::vector<float>& values, int width, int height, int radius) {
  std::vector<float> line;
  const auto along = [&](std::size_t first, std::size_t stride, int count) {
    line.resize(static_cast<std::size_t>(count));
    double sum = 0;
    const auto at = [&](int i) -> double {
      return i < 0 || i >= count
                 ? 0.0
                 : static_cast<double>(values[first + stride * static_cast<std::size_t>(i)]);
    };
    for (int i = 0; i <= radius; ++i) sum += at(i);
    for (int i = 0; i < count; ++i) {
      line[static_cast<std::size_t>(i)] = static_cast<float>(sum / (2 * radius + 1));
      sum += at(i + radius + 1) - at(i - radius);
    }
    for (int i = 0; i < count; ++i)
      values[first + stride * static_cast<std::size_t>(i)] = line[static_cast<std::size_t>(i)];
  };
  for (int pass = 0; pass < 3; ++pass) {
    for (int y = 0; y < height; ++y)
      along(static_cast<std::size_t>(y) * static_cast<std::size_t>(width), 1, width);
    for (int x = 0; x < width; ++x)
      along(static_cast<std::size_t>(x), static_cast<std::size_t>(width), height);
  }
}

}  // namespace

Box EyeFlame::box() const {
  return {origin,
          origin + Vec3{step.x * (count[0] - 1), step.y * (count[1] - 1), step.z * (count[2] - 1)}};
}

std::shared_ptr<const EyeFlame> eye_flame(const Scene& scene, int longest,
                                          const Execution& execution,
                                          const std::vector<std::shared_ptr<const Medium>>& known) {
  if (scene.flames.empty()) return nullptr;
  const Scene eye = seen_by_eye(scene);
  const SpectralNodes nodes = spectral_nodes(eye);
  const std::string folder = std::filesystem::path(scene.file).parent_path().string();
  std::vector<std::shared_ptr<const Medium>> media;
  Box all;
  for (std::size_t i = 0; i < eye.flames.size(); ++i) {
    const FlameSpec& flame = eye.flames[i];
    media.push_back(i < known.size() && known[i] && is_same_in_all_channels(flame)
                        ? known[i]
                        : load_medium(flame, folder, nodes.sources, execution));
    const Box box = media.back()->bounds();
    if (box.empty()) continue;
    all = all.empty() ? box : Box{least_of(all.lower, box.lower), most_of(all.upper, box.upper)};
  }
  if (all.empty()) return nullptr;
  auto result = std::make_shared<EyeFlame>();
  const Vec3 size = all.upper - all.lower;
  const double step = std::max({size.x, size.y, size.z}) / (longest - 1);
  // One more on each side, where the light goes to 0.
  const auto divide = [&](double length, double& each) {
    const int cells = std::max(1, static_cast<int>(std::ceil(length / step - 1e-9)));
    each = length / cells;
    return cells + 3;
  };
  result->count = {divide(size.x, result->step.x), divide(size.y, result->step.y),
                   divide(size.z, result->step.z)};
  result->origin = all.lower - result->step;
  result->points.resize(static_cast<std::size_t>(result->count[0]) *
                        static_cast<std::size_t>(result->count[1]) *
                        static_cast<std::size_t>(result->count[2]));
  const SourceTable table(nodes.sources);
  for (std::size_t i = 0; i < media.size(); ++i)
    add_flame(*media[i], nodes, table, eye.flames[i], execution, *result);
  result->bright = bright_of(*result);
  return result;
}

EyeLight eye_light(const EyeFlame& flame, const EyeWindow& window, const Execution& execution) {
  EyeLight light{window.width, window.height, {}};
  light.pixels.resize(static_cast<std::size_t>(window.width) *
                      static_cast<std::size_t>(window.height));
  const Box box{most_of(flame.box().lower, window.kept.lower),
                least_of(flame.box().upper, window.kept.upper)};
  const double step = std::min({flame.step.x, flame.step.y, flame.step.z});
  for_rows(window.height, execution, [&](int row) {
    for (int column = 0; column < window.width; ++column) {
      const Vec3 place = window.corner + (column + 0.5) / window.width * window.across +
                         (row + 0.5) / window.height * window.down;
      const Vec3 way = normalize(place - window.eye);
      const RaySpan inside = clip_to_box(box, {window.eye, way}, 0, kFar);
      EyeLight::Pixel& pixel =
          light.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(window.width) +
                       static_cast<std::size_t>(column)];
      if (inside.empty()) continue;
      const double whole = inside.far - inside.near;
      const int steps = std::max(1, static_cast<int>(std::ceil(whole / step)));
      const double length = whole / steps;
      for (int i = 0; i < steps && pixel.passed > 1e-3F; ++i) {
        const Vec3 at = window.eye + (inside.near + (i + 0.5) * length) * way - flame.origin;
        const Point p =
            between(flame, at.x / flame.step.x, at.y / flame.step.y, at.z / flame.step.z);
        if (p.y == 0 && p.absorption == 0) continue;
        // Light and absorption are equal along the step.
        const float thick = p.absorption * static_cast<float>(length);
        const float kept = std::exp(-thick);
        const float reach =
            pixel.passed * (thick > 1e-4F ? (1 - kept) / p.absorption : static_cast<float>(length));
        pixel.x += reach * p.x;
        pixel.y += reach * p.y;
        pixel.z += reach * p.z;
        pixel.passed *= kept;
      }
    }
  });
  return light;
}

std::vector<std::uint8_t> eye_picture(EyeLight light, double bright, double exposure, int glare) {
  const std::size_t count = light.pixels.size();
  const double gain = bright > 0 ? kBrightOnScreen * std::exp2(exposure) / bright : 0;
  std::array<std::vector<float>, 3> sharp;
  for (std::vector<float>& channel : sharp) channel.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const EyeLight::Pixel& p = light.pixels[i];
    const auto rgb = linear_srgb({gain * static_cast<double>(p.x), gain * static_cast<double>(p.y),
                                  gain * static_cast<double>(p.z)});
    for (std::size_t c = 0; c < 3; ++c) sharp[c][i] = static_cast<float>(std::max(0.0, rgb[c]));
  }
  std::array<std::vector<float>, 3> soft = sharp;
  if (glare > 0)
    for (std::vector<float>& channel : soft) blur(channel, light.width, light.height, glare);
  std::vector<std::uint8_t> picture;
  picture.reserve(4 * count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> rgb{};
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = (1 - kGlare) * static_cast<double>(sharp[c][i]) +
               kGlare * static_cast<double>(soft[c][i]);
    const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    const double white = kWhitening * (1 - std::exp(-luminance * luminance));
    double most = 1 - static_cast<double>(light.pixels[i].passed);
    for (double& value : rgb) {
      value = encode_srgb(1 - std::exp(-1.6 * (value + white * (luminance - value))));
      most = std::max(most, value);
    }
    for (const double value : rgb)
      picture.push_back(static_cast<std::uint8_t>(most > 0 ? std::lround(255 * value / most) : 0));
    picture.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(1.0, most))));
  }
  return picture;
}

}  // namespace plenoflame::desktop
