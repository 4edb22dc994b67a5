// Kernels look at rows of pixels; here against single looks at each pixel.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "plenoflame/render/render.h"
#include "plenoflame/sampling/sobol.h"
#include "render/sampling/backward_tile.h"
#include "render/sampling/worth_levels.h"
#include "render/visibility/occupied_region.h"
#include "render/visibility/pixel_beams.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/isas.h"

namespace plenoflame::test::pixel_row_test {
namespace {

/// Rows of pixels behind one microlens of a camera.
class Rows {
 public:
  Rows(const Camera& camera, const PupilTable& table, Vec2 place)
      : camera_(camera), place_(place), node_(table.at(length(place))) {
    const SensorSpec& sensor = camera.spec().sensor;
    const Vec2 field = length(place) > 0 ? (1 / length(place)) * place : Vec2{1, 0};
    const Vec2 centre = node_.centre * field;
    survey.half_columns = 0.5 * sensor.columns;
    survey.pitch = survey.pitch_y = sensor.pixel_pitch;
    survey.lens_x = place.x;
    survey.centre_x = centre.x;
    survey.centre_y = centre.y;
    survey.field_x = field.x;
    survey.field_y = field.y;
    const double clear = PixelCuts::clear_of_centre(0.5 * survey.pitch);
    survey.clear2 = clear * clear;
    const WorthLevels::Rings worth = WorthLevels(table, 0.5 * survey.pitch).at(length(place));
    for (std::size_t k = 0; k < WorthLevels::kCount; ++k) {
      survey.rings[k] = worth.squares[k];
      survey.parts[k] = survey.pitch * WorthLevels::limit(k);
    }
    for (int k = 0; k < PixelCuts::kSectors; ++k)
      survey.closes[k] =
          std::min(node_.outer_radius, static_cast<double>(node_.cuts.sector(k).closes));
    survey.key = 0x1234567890abcdefu;
    // Around the micro-image, and a little more.
    const double reach = node_.outer_radius + 3 * survey.pitch;
    const Vec2 image = place + centre;
    const int first = static_cast<int>(survey.half_columns - (image.x + reach) / survey.pitch);
    const int last = static_cast<int>(survey.half_columns - (image.x - reach) / survey.pitch);
    survey.column = static_cast<std::uint32_t>(first);
    set_count(last - first);
    first_row = static_cast<int>(0.5 * sensor.rows - (image.y + reach) / survey.pitch);
    last_row = static_cast<int>(0.5 * sensor.rows - (image.y - reach) / survey.pitch);
  }
  void set_count(int count) { survey.count = count; }
  /// Rows from `first` on, as many as are looked at together, at most `most` of them.
  void take(int first, int most) {
    survey.row = static_cast<std::uint32_t>(first);
    survey.rows = std::min({most, last_row - first, kRowsPixels / survey.count});
    y_.clear();
    for (int row = 0; row < survey.rows; ++row)
      y_.push_back(camera_.sensor_point(0, first + row + 0.5).y - place_.y);
    survey.y = y_.data();
  }
  void take(int first) { take(first, kRowsPixels); }
  /// A pixel's centre, from that of the microlens.
  Vec2 pixel(int row, int i) const {
    return camera_.sensor_point(static_cast<double>(survey.column) + i + 0.5,
                                static_cast<double>(survey.row) + row + 0.5) -
           place_;
  }
  const PupilNode& node() const { return node_; }

  KernelRows survey{};
  int first_row = 0, last_row = 0;

 private:
  const Camera& camera_;
  Vec2 place_;
  PupilNode node_;
  std::vector<double> y_;
};

constexpr Vec2 kPlaces[]{{0, 0}, {1e-3, -2e-3}, {-6e-3, 4e-3}, {0, 7e-3}};

TEST(PixelRow, SurveysSayWhatSingleLooksDo) {
  for (const char* name : {"paper-plenoptic2", "paper-previous-60x60", "raytrix-r29"}) {
    const Camera camera(preset_camera(name));
    const PupilSampling pupils(camera);
    for (const Vec2 place : kPlaces) {
      Rows rows(camera, pupils.tables().back(), place);
      const KernelRows& survey = rows.survey;
      const Vec2 centre{survey.centre_x, survey.centre_y}, field{survey.field_x, survey.field_y};
      const double half = 0.5 * survey.pitch;
      int lit = 0, dark = 0, cut = 0, edges = 0;
      for (const Isa isa : supported_isas()) {
        std::vector<bool> levels(WorthLevels::kCount + 1);
        PixelRows found;
        for (int first = rows.first_row; first < rows.last_row; first += survey.rows) {
          rows.take(first);
          backward_kernels<float>(isa).set_up_rows(survey, found.arrays());
          for (int pixel = 0; pixel < survey.rows * survey.count; ++pixel) {
            const int row = pixel / survey.count, i = pixel % survey.count;
            const auto k = static_cast<std::size_t>(pixel);
            const Vec2 v = rows.pixel(row, i) - centre;
            const PixelView view = rows.node().cuts.look(v, half, field);
            const double near = std::hypot(std::max(std::fabs(v.x) - half, 0.0),
                                           std::max(std::fabs(v.y) - half, 0.0));
            const double far = std::hypot(std::fabs(v.x) + half, std::fabs(v.y) + half);
            const double radius =
                std::min(rows.node().outer_radius, static_cast<double>(view.column->closes));
            ASSERT_TRUE(near > radius * (1 - 1e-9) || found.x_width[k] > 0);
            ASSERT_TRUE(near < radius * (1 + 1e-9) || !(found.x_width[k] > 0));
            ASSERT_TRUE(within(found.x[k], rows.pixel(row, i).x, 1e-9, radius));
            ASSERT_EQ(found.y[k], rows.pixel(row, i).y);
            ASSERT_EQ(&rows.node().cuts.sector(found.sector[k]), view.column);
            if (!(found.x_width[k] > 0)) {
              ++dark;
              continue;
            }
            ++lit;
            EXPECT_TRUE(relative(found.far2[k], far * far, 1e-9));
            const double y_off = std::max(std::fabs(v.y) - half, 0.0);
            const double reach = std::sqrt(radius * radius - y_off * y_off);
            const double low = std::max(v.x - half, -reach), high = std::min(v.x + half, reach);
            EXPECT_TRUE(within(found.x_low[k], centre.x + low, 1e-9, radius));
            EXPECT_TRUE(within(found.x_width[k], high - low, 1e-9, radius));
            cut += high - low < 0.99 * survey.pitch;
            // Next to a ring, or to a limit, either level will do.
            const auto level = [&](double by) {
              int sum = WorthLevels::of((high - low) / survey.pitch * (1 - by));
              for (const double ring : survey.rings) sum += dot(v, v) * (1 + by) > ring ? 1 : 0;
              return sum;
            };
            EXPECT_GE(found.level[k], level(-1e-9));
            EXPECT_LE(found.level[k], level(1e-9));
            edges += level(1e-9) != level(-1e-9);
            levels[static_cast<std::size_t>(
                std::min(found.level[k], static_cast<int>(WorthLevels::kCount)))] = true;
            const std::uint64_t numbers =
                static_cast<std::uint64_t>(survey.column + static_cast<std::uint32_t>(i)) << 32 |
                (survey.row + static_cast<std::uint32_t>(row));
            EXPECT_EQ(found.place[k], numbers);
            const std::uint64_t word = mix64(numbers ^ survey.key);
            EXPECT_EQ(found.random[0][k], word);
            for (std::size_t n = 1; n < kRowWords; ++n)
              EXPECT_EQ(found.random[n][k], mix64(word + n));
          }
        }
        EXPECT_GT(std::count(levels.begin(), levels.end(), true), 2) << name;
      }
      EXPECT_GT(lit, 100) << name;
      EXPECT_GT(dark, 50) << name;
      EXPECT_GT(cut, 0) << name;
      EXPECT_LT(edges, 0.01 * lit) << name;
    }
  }
}

// Findings about a pixel do not depend on which others are looked at with it, since the picture
// must not depend on the window.
TEST(PixelRow, PixelsDoNotDependOnTheirNeighbours) {
  const Camera camera(preset_camera("paper-plenoptic2"));
  const PupilSampling pupils(camera);
  const OccupiedRegion region(camera, {{{0.99, -4e-3, -3e-3}, {1.01, 2e-3, 5e-3}}});
  const auto beams = PixelBeams::make(camera, pupils.tables(), region);
  int several = 0;
  for (const Isa isa : supported_isas())
    for (const Vec2 place : kPlaces) {
      Rows rows(camera, pupils.tables().front(), place);
      const KernelBeam beam = beams->of(0, place).kernel();
      const auto kernels = backward_kernels<float>(isa);
      const int count = rows.survey.count;
      for (int first = rows.first_row; first < rows.last_row; first += kRowsPixels / count) {
        rows.set_count(count);
        rows.take(first);
        const int together = rows.survey.rows;
        several += together > 1 ? 1 : 0;
        PixelRows all, some;
        kernels.set_up_rows(rows.survey, all.arrays());
        kernels.cull_pixels(rows.survey, beam, all.arrays());
        for (int part = 0; part < 6 * together; ++part) {
          const int row = part / 6,
                    skipped = std::array{0, 1, 3, 8, 9, 12}[static_cast<std::size_t>(part % 6)];
          rows.set_count(std::min(std::array{1, 7, 8, count}[static_cast<std::size_t>(part % 4)],
                                  count - skipped));
          rows.take(first + row, std::min(together - row, 1 + part % 5));
          KernelRows survey = rows.survey;
          survey.column += static_cast<std::uint32_t>(skipped);
          kernels.set_up_rows(survey, some.arrays());
          kernels.cull_pixels(survey, beam, some.arrays());
          for (int pixel = 0; pixel < survey.rows * survey.count; ++pixel) {
            const int i = pixel % survey.count, of_row = pixel / survey.count;
            const auto k = static_cast<std::size_t>(pixel),
                       of_all = static_cast<std::size_t>((row + of_row) * count + skipped + i);
            ASSERT_EQ(some.x[k], all.x[of_all]);
            ASSERT_EQ(some.y[k], all.y[of_all]);
            ASSERT_EQ(some.place[k], all.place[of_all]);
            ASSERT_EQ(some.x_low[k], all.x_low[of_all]);
            ASSERT_EQ(some.x_width[k], all.x_width[of_all]);
            ASSERT_EQ(some.far2[k], all.far2[of_all]);
            ASSERT_EQ(some.level[k], all.level[of_all]);
            ASSERT_EQ(some.sector[k], all.sector[of_all]);
            ASSERT_EQ(some.visibility[k], all.visibility[of_all]);
            for (std::size_t word = 0; word < kRowWords; ++word)
              ASSERT_EQ(some.random[word][k], all.random[word][of_all]);
          }
        }
      }
    }
  EXPECT_GT(several, 10);
}

// Flat and deep regions: beams are short or long between their planes. What is said to see nothing
// does not by a single look at the pixel.
TEST(PixelRow, VerdictsAreThoseOfTheBeam) {
  const Camera camera(preset_camera("paper-plenoptic2"));
  const PupilSampling pupils(camera);
  std::mt19937_64 generator(5);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * (static_cast<double>(generator() >> 11) * 0x1p-53);
  };
  for (const Isa isa : supported_isas()) {
    std::array<int, 3> verdicts{};
    int wider = 0;
    for (int round = 0; round < 120; ++round) {
      const int type = round % 3;
      const Vec2 place{uniform(-7e-3, 7e-3), uniform(-7e-3, 7e-3)};
      Rows rows(camera, pupils.tables()[static_cast<std::size_t>(type)], place);
      // Boxes near where the microlens looks.
      const double z = uniform(0.7, 1.3), scale = z / std::fabs(camera.sensor());
      std::vector<Box> boxes;
      for (int box = 0; box < 1 + round % 3; ++box) {
        const double size = std::pow(10, uniform(-4, -2)), deep = round % 2 == 0 ? 1e-3 : 0.2;
        const Vec3 at{-scale * place.x + uniform(-6e-3, 6e-3),
                      -scale * place.y + uniform(-6e-3, 6e-3), z + uniform(-0.5, 0.5) * deep};
        const Vec3 half{size, uniform(0.3, 3) * size, deep * uniform(0.1, 0.5)};
        Box ahead;
        const Vec3 a = camera.to_world().point(at - half), b = camera.to_world().point(at + half);
        ahead.lower = {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
        ahead.upper = {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
        boxes.push_back(ahead);
      }
      const OccupiedRegion region(camera, boxes);
      const auto beams = PixelBeams::make(camera, pupils.tables(), region);
      ASSERT_TRUE(beams);
      const PixelBeam beam = beams->of(type, place);
      const KernelBeam kernel = beam.kernel();
      PixelRows found;
      const KernelRows& survey = rows.survey;
      for (int first = rows.first_row; first < rows.last_row; first += survey.rows) {
        rows.take(first);
        backward_kernels<float>(isa).set_up_rows(survey, found.arrays());
        backward_kernels<float>(isa).cull_pixels(survey, kernel, found.arrays());
        for (int number = 0; number < survey.rows * survey.count; ++number) {
          const int row = number / survey.count, i = number % survey.count;
          if (!(found.x_width[static_cast<std::size_t>(number)] > 0)) continue;
          const Vec2 pixel = rows.pixel(row, i);
          const int visibility = found.visibility[static_cast<std::size_t>(number)];
          ++verdicts[static_cast<std::size_t>(visibility)];
          const bool sees = beam.may_meet(pixel);
          if (visibility == kSeesNone) {
            EXPECT_FALSE(sees);
          }
          // Discs are those of the widest in a bin of distances.
          wider += visibility == kSeesSomething && !sees ? 1 : 0;
        }
      }
    }
    for (const int count : verdicts) EXPECT_GT(count, 100);
    EXPECT_LT(wider, 0.1 * verdicts[kSeesSomething]);
  }
}

}  // namespace
}  // namespace plenoflame::test::pixel_row_test
