// A part of TileTracer: the pixels behind a microlens, row by row.
#include <algorithm>
#include <cmath>

#include "render/sampling/microlens_frame.h"
#include "render/tracer/backward_tile.h"

namespace plenoflame {

namespace {

/// The data of the rows behind a microlens, except for the numbers of the pixels.
KernelRows survey_of(const Camera& camera, const PupilNode& node, const WorthLevels::Rings& worth,
                     double lens_x, Vec2 field) {
  const SensorSpec& sensor = camera.spec().sensor;
  KernelRows survey{};
  survey.half_columns = 0.5 * sensor.columns;
  survey.pitch = sensor.pixel().x;
  survey.pitch_y = sensor.pixel().y;
  survey.lens_x = lens_x;
  survey.centre_x = node.centre * field.x;
  survey.centre_y = node.centre * field.y;
  survey.field_x = field.x;
  survey.field_y = field.y;
  survey.blur_x = sensor.blur_reach().x;
  survey.blur_y = sensor.blur_reach().y;
  const double clear = PixelCuts::clear_of_centre(std::max(0.5 * survey.pitch + survey.blur_x,  //
                                                           0.5 * survey.pitch_y + survey.blur_y));
  survey.clear2 = clear * clear;
  static_assert(WorthLevels::kCount == kWorthRings);
  for (std::size_t k = 0; k < WorthLevels::kCount; ++k) {
    survey.rings[k] = worth.squares[k];
    survey.parts[k] = (survey.pitch + 2 * survey.blur_x) * WorthLevels::limit(k);
  }
  for (int k = 0; k < PixelCuts::kSectors; ++k)
    survey.closes[k] = std::min(node.outer_radius, static_cast<double>(node.cuts.sector(k).closes));
  return survey;
}

/// Pixels of the tile that record light of a disc around `centre` on the sensor. If there are none,
/// the width or height is not positive.
PixelWindow pixels_of(const SensorSpec& sensor, const PixelWindow& tile, Vec2 centre,
                      double radius) {
  // Upright images run opposite to camera x, y.
  const auto column_of = [&](double x) {
    return static_cast<int>(std::floor(0.5 * sensor.columns - x / sensor.pixel().x));
  };
  const auto row_of = [&](double y) {
    return static_cast<int>(std::floor(0.5 * sensor.rows - y / sensor.pixel().y));
  };
  const Vec2 reach = Vec2{radius, radius} + sensor.blur_reach();
  const int column = std::max(tile.x, column_of(centre.x + reach.x));
  const int row = std::max(tile.y, row_of(centre.y + reach.y));
  return {column, row,
          std::min(tile.x + tile.width - 1, column_of(centre.x - reach.x)) - column + 1,
          std::min(tile.y + tile.height - 1, row_of(centre.y - reach.y)) - row + 1};
}

}  // namespace

KernelRowPixels PixelRows::arrays() {
  KernelRowPixels pixels{x.data(),          y.data(),    place.data(), x_low.data(),
                         x_width.data(),    far2.data(), level.data(), sector.data(),
                         visibility.data(), {}};
  for (std::size_t k = 0; k < random.size(); ++k) pixels.random[k] = random[k].data();
  return pixels;
}

template <class Real>
void TileTracer<Real>::add_microlens(LensIndex lens) {
  const Camera& camera = plan_.scene->camera;
  const Vec3 lens_place = camera.lens_place(lens);
  const Vec2 place{lens_place.x, lens_place.y}, from_foot = place - camera.foot();
  const int type = camera.lattice().type(lens);
  const PupilTable& table = plan_.scene->pupils.tables()[static_cast<std::size_t>(type)];
  const double h = std::sqrt(dot(from_foot, from_foot));
  const Vec2 field = h > 0 ? (1.0 / h) * from_foot : Vec2{1, 0};
  const auto [distance, radius] = table.micro_image(h);
  const SensorSpec& sensor = camera.spec().sensor;
  const PixelWindow pixels = pixels_of(sensor, tile_, place + distance * field, radius);
  if (pixels.width <= 0 || pixels.height <= 0) return;
  const Visibility visibility =
      plan_.beams ? plan_.beams->lenses().look(type, lens_place) : Visibility::full;
  if (visibility == Visibility::none) return;
  beam_.reset();
  if (visibility == Visibility::partial && plan_.beams->pixels()) {
    beam_ = plan_.beams->pixels()->of(type, place);
    kernel_beam_ = beam_->kernel();
  }
  generate_queued();  // queued pixels belong to the frame before
  table.look_up(h, node_);
  const PupilNode& node = node_;
  if (node.dark()) return;
  whole_ = whole_aperture(table.discs.bound);
  frame_ = microlens_frame<Real>(table, node, place, field, camera.ideal_array());
  set_blur();
  add_faces(camera, type, frame_);
  has_own_lens_ = false;
  if (camera.misaligned()) {
    own_lens_ = plan_.microlenses[static_cast<std::size_t>(type)];
    set_lens(camera, lens, own_lens_);
    has_own_lens_ = true;
  }
  const std::uint64_t key =
      mix64((static_cast<std::uint64_t>(static_cast<std::uint32_t>(lens.q)) << 32 |
             static_cast<std::uint32_t>(lens.r)) ^
            plan_.settings->seed);
  KernelRows survey =
      survey_of(camera, node, plan_.worths[static_cast<std::size_t>(type)].at(h), place.x, field);
  survey.column = static_cast<std::uint32_t>(pixels.x);
  survey.count = pixels.width;
  survey.key = key;
  lens_ = lens;
  type_ = type;
  static_assert(Film::kTile <= kRowsPixels);
  const int together = kRowsPixels / survey.count;
  std::array<double, kRowsPixels> y;
  survey.y = y.data();
  const KernelRowPixels arrays = rows_.arrays();
  for (int first = pixels.y; first < pixels.y + pixels.height; first += together) {
    survey.row = static_cast<std::uint32_t>(first);
    survey.rows = std::min(together, pixels.y + pixels.height - first);
    for (int row = 0; row < survey.rows; ++row)
      y[static_cast<std::size_t>(row)] = camera.sensor_point(0, first + row + 0.5).y - place.y;
    plan_.kernels.set_up_rows(survey, arrays);
    if (beam_) plan_.kernels.cull_pixels(survey, kernel_beam_, arrays);
    add_rows(survey);
  }
}

template void TileTracer<float>::add_microlens(LensIndex);
template void TileTracer<double>::add_microlens(LensIndex);

}  // namespace plenoflame
