#pragma once
#include <string>
#include <utility>
#include <vector>

#include "plot.h"
#include "slice_values.h"

namespace plenoflame::cli {

/// Numbers on a rectangle, row by row from the top.
struct HeatMap {
  std::string title, unit;
  int width = 0, height = 0;
  std::vector<double> values;  ///< grey where they are no numbers
  double low = 0, high = 1;    ///< ends of the colours
  bool signed_values = false;  ///< 0 is white, with a colour on either side
  double aspect = 1;           ///< of a value: its height over its width
  SliceAxis across, up;        ///< a side without a label is bare
};

/// A page that needs no other file: pictures and plots are inside.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  void table(const std::vector<std::pair<std::string, std::string>>& lines);
  void plots(const std::vector<Plot>& plots, int columns);
  /// Side by side, each with its scale.
  void heat_maps(const std::vector<HeatMap>& maps);
  std::string text() const;

 private:
  std::string title_, body_;
};

}  // namespace plenoflame::cli
