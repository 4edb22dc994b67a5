#include "commands/calibration/white_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace plenoflame::cli {
namespace {

constexpr int kEnlarged = 3, kParts = 3, kPartGap = 6;

class PartsPicture {
 public:
  explicit PartsPicture(const Image& white) : white_(white) {
    part_w_ = std::min(160, white.width / kParts);
    part_h_ = std::min(160, white.height / kParts);
    picture_.width = kParts * kEnlarged * part_w_ + (kParts - 1) * kPartGap;
    picture_.height = kParts * kEnlarged * part_h_ + (kParts - 1) * kPartGap;
    picture_.channels = 3;
    picture_.samples.assign(picture_.sample_count(), 255);
    std::vector<float> values(white.pixels.begin(), white.pixels.end());
    const auto high = values.begin() +
                      static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), high, values.end());
    largest_ = std::max(1e-30, static_cast<double>(*high));
    for (int v = 0; v < kParts; ++v)
      for (int u = 0; u < kParts; ++u) fill(u, v);
  }

  /// Draws a ring, or a cross, in each part that shows it.
  void mark(Vec2 centre, double radius, const std::array<int, 3>& colour, bool cross) {
    for (int v = 0; v < kParts; ++v)
      for (int u = 0; u < kParts; ++u) {
        const Vec2 at{kEnlarged * (centre.x - left(u)), kEnlarged * (centre.y - top(v))};
        const double size = kEnlarged * radius;
        if (at.x < -size || at.y < -size || at.x > kEnlarged * part_w_ + size ||
            at.y > kEnlarged * part_h_ + size)
          continue;
        const int steps = std::max(24, static_cast<int>(8 * size));
        for (int k = 0; k < steps; ++k) {
          const double angle = 6.283185307179586 * k / steps;
          set(u, v, at.x + size * std::cos(angle), at.y + size * std::sin(angle), colour);
        }
        const double arm = cross ? 0.7 * size : 3;
        for (double t = -arm; t <= arm; t += 0.5) {
          set(u, v, at.x + t, cross ? at.y + t : at.y, colour);
          set(u, v, cross ? at.x + t : at.x, cross ? at.y - t : at.y + t, colour);
        }
      }
  }

  PngImage take() { return std::move(picture_); }

 private:
  int left(int u) const { return (white_.width - part_w_) * u / (kParts - 1); }
  int top(int v) const { return (white_.height - part_h_) * v / (kParts - 1); }

  void fill(int u, int v) {
    for (int y = 0; y < kEnlarged * part_h_; ++y)
      for (int x = 0; x < kEnlarged * part_w_; ++x) {
        const double value =
            static_cast<double>(white_.at(left(u) + x / kEnlarged, top(v) + y / kEnlarged));
        const int grey =
            static_cast<int>(230 * std::sqrt(std::clamp(value / largest_, 0.0, 1.0)) + 0.5);
        set(u, v, x, y, {grey, grey, grey});
      }
  }

  void set(int u, int v, double x, double y, const std::array<int, 3>& colour) {
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    if (column < 0 || row < 0 || column >= kEnlarged * part_w_ || row >= kEnlarged * part_h_)
      return;
    const auto at = static_cast<std::size_t>(
        3 * ((v * (kEnlarged * part_h_ + kPartGap) + row) * picture_.width +
             u * (kEnlarged * part_w_ + kPartGap) + column));
    for (std::size_t c = 0; c < 3; ++c)
      picture_.samples[at + c] = static_cast<std::uint16_t>(colour[c]);
  }

  const Image& white_;
  PngImage picture_;
  int part_w_ = 0, part_h_ = 0;
  double largest_ = 1;
};

}  // namespace

PngImage white_picture(const Image& white, const WhiteLattice* lattice) {
  PartsPicture picture(white);
  if (lattice != nullptr) {
    constexpr std::array<std::array<int, 3>, 3> kColours{
        {{230, 60, 40}, {30, 140, 255}, {40, 190, 60}}};
    for (const MicroImageFit& image : lattice->images) {
      const double radius = lattice->types[static_cast<std::size_t>(image.type)].radius;
      picture.mark(image.model, radius, kColours[static_cast<std::size_t>(image.type) % 3],
                   !image.good);
    }
  }
  return picture.take();
}

}  // namespace plenoflame::cli
