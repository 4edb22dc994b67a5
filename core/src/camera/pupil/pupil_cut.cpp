#include "plenoflame/camera/pupil_cut.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "plenoflame/base/constants.h"

namespace plenoflame {
namespace {

constexpr int kLast = PupilCuts::kAzimuths - 1;
// cos(pi k / 8)
constexpr std::array<float, PupilCuts::kAzimuths> kCosines{1.0f,         0.92387953f,  0.70710678f,
                                                           0.38268343f,  0.0f,         -0.38268343f,
                                                           -0.70710678f, -0.92387953f, -1.0f};
// Sectors of PixelCuts reach this far beyond their azimuth, in azimuth steps. Half a step leads to
// the border. A pixel, seen from the centre, has at most the size of a disc with a radius of one
// step.
constexpr double kSector = 1.5;
constexpr float kNone = -1e30f;

/// Four numbers for vector arithmetic (an extension of GCC and Clang).
typedef float Four __attribute__((vector_size(16)));

Four load(const PupilCut& cut) {
  Four four;
  std::memcpy(&four, cut.data(), sizeof four);
  return four;
}
PupilCut stored(Four four) {
  PupilCut cut;
  std::memcpy(cut.data(), &four, sizeof four);
  return cut;
}
Four widest(Four a, Four b) {
  return a > b ? a : b;
}

Four value_at(const PupilColumn& column, float step) {
  const int k = std::min(static_cast<int>(step), PupilColumn::kSteps - 1);
  const Four a = load(column.cuts[static_cast<std::size_t>(k)]),
             b = load(column.cuts[static_cast<std::size_t>(k + 1)]);
  return a + (step - static_cast<float>(k)) * (b - a);
}

/// A column that is at least as wide as all of the columns.
PupilColumn widest_of(const std::vector<PupilColumn>& columns) {
  PupilColumn wide = columns.front();
  for (const PupilColumn& column : columns) {
    wide.opens = std::min(wide.opens, column.opens);
    wide.closes = std::max(wide.closes, column.closes);
  }
  for (int step = 0; step <= PupilColumn::kSteps; ++step) {
    Four cut = {kNone, kNone, kNone, kNone};
    for (const PupilColumn& column : columns)
      cut = widest(cut, value_at(column, column.step_at(wide.distance_at(step))));
    wide.cuts[static_cast<std::size_t>(step)] = stored(cut);
  }
  // The others may bend between its steps; it is raised until it encloses them.
  for (const PupilColumn& column : columns)
    for (int k = 0; k <= PupilColumn::kSteps; ++k) {
      const float step = wide.step_at(column.distance_at(k));
      const Four lacking = load(column.cuts[static_cast<std::size_t>(k)]) - value_at(wide, step);
      const Four lift = lacking > 0 ? lacking : 0 * lacking;
      const auto i =
          static_cast<std::size_t>(std::min(static_cast<int>(step), PupilColumn::kSteps - 1));
      wide.cuts[i] = stored(load(wide.cuts[i]) + lift);
      wide.cuts[i + 1] = stored(load(wide.cuts[i + 1]) + lift);
    }
  return wide;
}

float steps_per_metre(float opens, float closes) {
  return closes > opens ? static_cast<float>(CutColumn::kSteps) / (closes - opens) : 0.0f;
}

CutColumn looked_up(const PupilColumn& column) {
  CutColumn c;
  c.opens = column.opens;
  c.closes = column.closes;
  c.steps_per_metre = steps_per_metre(c.opens, c.closes);
  for (std::size_t k = 0; k < CutColumn::kSteps; ++k)
    for (std::size_t side = 0; side < 4; ++side) {
      c.value[side][k] = column.cuts[k][side];
      c.rise[side][k] = column.cuts[k + 1][side] - column.cuts[k][side];
    }
  return c;
}

void set_mix_of(const CutColumn& a, const CutColumn& b, float t, CutColumn& c) {
  c.opens = a.opens + t * (b.opens - a.opens);
  c.closes = a.closes + t * (b.closes - a.closes);
  c.steps_per_metre = steps_per_metre(c.opens, c.closes);
  for (std::size_t side = 0; side < 4; ++side)
    for (std::size_t k = 0; k < CutColumn::kSteps; ++k) {
      c.value[side][k] = a.value[side][k] + t * (b.value[side][k] - a.value[side][k]);
      c.rise[side][k] = a.rise[side][k] + t * (b.rise[side][k] - a.rise[side][k]);
    }
}

}  // namespace

PupilCut ColumnBetween::at(float step) const {
  const Four from = value_at(a_, step), to = value_at(b_, step);
  return stored(from + t_ * (to - from));
}

PupilColumn PupilColumn::mix(const PupilColumn& a, const PupilColumn& b, float t) {
  PupilColumn column;
  column.opens = a.opens + t * (b.opens - a.opens);
  column.closes = a.closes + t * (b.closes - a.closes);
  for (std::size_t k = 0; k <= kSteps; ++k) {
    const Four from = load(a.cuts[k]), to = load(b.cuts[k]);
    column.cuts[k] = stored(from + t * (to - from));
  }
  return column;
}

PupilColumn PupilColumn::reaching(float farther) const {
  PupilColumn column = *this;
  column.closes = farther;
  return widest_of({*this, column});  // its steps have other distances
}

float PupilCuts::azimuth_cosine(int azimuth) {
  return kCosines[static_cast<std::size_t>(azimuth)];
}

PupilCuts PupilCuts::mix(const PupilCuts& a, const PupilCuts& b, float t) {
  PupilCuts c;
  for (std::size_t j = 0; j < kAzimuths; ++j)
    c.columns[j] = PupilColumn::mix(a.columns[j], b.columns[j], t);
  return c;
}

PupilCuts::Azimuth PupilCuts::azimuth(float cosine) {
  int i = 0;
  while (i < kLast - 1 && cosine < kCosines[static_cast<std::size_t>(i + 1)]) ++i;
  const float a = kCosines[static_cast<std::size_t>(i)],
              b = kCosines[static_cast<std::size_t>(i + 1)];
  return {i, std::clamp((a - cosine) / (a - b), 0.0f, 1.0f)};
}

ColumnBetween PupilCuts::at(const Azimuth& azimuth) const& {
  const auto j = static_cast<std::size_t>(azimuth.index);
  return {columns[j], columns[j + 1], azimuth.part};
}

PixelCuts::PixelCuts(const PupilCuts& cuts) {
  const auto column_at = [&](double place) {  // in azimuth steps, mirrored at the ends
    const double angle = constants::pi * place / kLast;
    return cuts.at(PupilCuts::azimuth(static_cast<float>(std::cos(angle)))).mixed();
  };
  for (int j = 0; j <= kLast; ++j) {
    std::vector<PupilColumn> sector{column_at(j - kSector), column_at(j + kSector)};
    for (int k = std::max(0, j - 1); k <= std::min(kLast, j + 1); ++k)
      sector.push_back(cuts.columns[static_cast<std::size_t>(k)]);
    columns_[static_cast<std::size_t>(j)] = looked_up(widest_of(sector));
  }
  columns_.back() = looked_up(widest_of({cuts.columns.begin(), cuts.columns.end()}));
}

void PixelCuts::set_mix(const PixelCuts& a, const PixelCuts& b, float t) {
  for (std::size_t j = 0; j < columns_.size(); ++j)
    set_mix_of(a.columns_[j], b.columns_[j], t, columns_[j]);
}

double PixelCuts::clear_of_centre(double half) {
  return std::sqrt(2.0) * half / kCutSine;  // its disc appears as large as one step
}

PixelView PixelCuts::look(Vec2 centre, double half, Vec2 field) const& {
  const double x = std::fabs(centre.x), y = std::fabs(centre.y);
  const double near = std::hypot(std::max(x - half, 0.0), std::max(y - half, 0.0)),
               far = std::hypot(x + half, y + half), distance = std::hypot(x, y);
  int sector = kSectors - 1;
  if (distance > clear_of_centre(half)) {
    const double along = dot(centre, field);
    sector = 0;
    for (const double border : kCutBorders) sector += along < border * distance ? 1 : 0;
  }
  const CutColumn& column = columns_[static_cast<std::size_t>(sector)];
  return {near >= static_cast<double>(column.closes), far <= static_cast<double>(column.opens),
          &column};
}

PupilCut cut_at(const CutColumn& column, float distance) {
  const float step = std::clamp((distance - column.opens) * column.steps_per_metre, 0.0f,
                                static_cast<float>(CutColumn::kSteps));
  const int k = std::min(static_cast<int>(step), CutColumn::kSteps - 1);
  PupilCut cut;
  for (std::size_t side = 0; side < 4; ++side)
    cut[side] = column.value[side][k] + (step - static_cast<float>(k)) * column.rise[side][k];
  return cut;
}

CutColumn constant_cut(const PupilCut& cut) {
  CutColumn column{};
  column.closes = std::numeric_limits<float>::infinity();
  for (std::size_t side = 0; side < 4; ++side)
    std::fill_n(column.value[side], CutColumn::kSteps, cut[side]);
  return column;
}

}  // namespace plenoflame
