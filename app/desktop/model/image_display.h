#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "colour_map.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/image/image.h"

namespace plenoflame::desktop {

enum class ToneScale {
  linear,
  gamma,        ///< the transfer curve of displays: equal steps look equal
  logarithmic,  ///< `decades` of them below white
};

/// Rule by which values become colours.
struct ToneSettings {
  ToneScale scale = ToneScale::gamma;
  ColourMap map = ColourMap::grey;
  double white = 1;        ///< value of the last colour, > 0
  double decades = 3;      ///< of the logarithmic scale
  double saturation = 0;   ///< values from here on are marked; 0: none
  bool is_signed = false;  ///< from -white to white (linear)
};

/// Place of a value on the scale, 0 to 1.
double tone(const ToneSettings& settings, double value);

/// Colours of single-precision values by table: 0xffRRGGBB. The table knows 1/512 of a value, finer
/// than 8 bits can show.
class ToneTable {
 public:
  explicit ToneTable(const ToneSettings& settings);
  std::uint32_t operator()(float value) const;

 private:
  static constexpr int kShift = 14;  ///< bits of a float that are left out
  std::vector<std::uint32_t> positive_, negative_;
};

/// An image with halved copies, each pixel the mean of four, down to about 64 pixels.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// @throws Cancelled
  ImagePyramid(std::shared_ptr<const Image> image, const Execution& execution);

  bool empty() const { return levels_.empty(); }
  int width() const { return empty() ? 0 : levels_.front()->width; }
  int height() const { return empty() ? 0 : levels_.front()->height; }
  std::size_t level_count() const { return levels_.size(); }
  const Image& level(std::size_t i) const { return *levels_[i]; }
  /// The coarsest level with at least one pixel per screen pixel. @param scale screen pixels per
  /// image pixel
  std::size_t level_for(double scale) const;
  /// The first level that is nowhere larger than `side`.
  std::size_t level_within(int side) const;
  float largest() const { return largest_; }    ///< finite value of level 0
  float smallest() const { return smallest_; }  ///< the same

 private:
  std::vector<std::shared_ptr<const Image>> levels_;
  float largest_ = 0, smallest_ = 0;
};

/// Counts of values in equal steps (of the value, or of its logarithm over `decades`).
struct Histogram {
  std::vector<double> counts;
  double lower = 0, upper = 0;  ///< ends of the first and last bin
  bool logarithmic = false;
  double below = 0;  ///< pixels that are 0, or below `lower`
};
Histogram histogram(const Image& image, int bins, bool logarithmic, double decades = 6);

/// Values along a line, one per pixel of its length, both ends included; nearest pixels.
/// Coordinates are continuous: pixel (0, 0) has its centre at (0.5, 0.5). NaN outside.
std::vector<double> line_profile(const Image& image, double x0, double y0, double x1, double y1);

}  // namespace plenoflame::desktop
