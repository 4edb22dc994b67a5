#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "plenoflame/inverse/unknowns.h"
#include "support/approx.h"

namespace plenoflame::test::values_at_places_test {
namespace {

/// Samples of the hats whose sum is nearest to a field over [0, count - 1], by the midpoint rule.
std::vector<double> nearest_lines(int count, double (*field)(double)) {
  constexpr int kParts = 200;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd projections = Eigen::VectorXd::Zero(count);
  for (int part = 0; part < (count - 1) * kParts; ++part) {
    const double x = (part + 0.5) / kParts;
    const int i = part / kParts;
    const double after = x - i, before = 1 - after;
    products(i, i) += before * before;
    products(i + 1, i + 1) += after * after;
    products(i, i + 1) += before * after;
    products(i + 1, i) += before * after;
    projections[i] += before * field(x);
    projections[i + 1] += after * field(x);
  }
  const Eigen::VectorXd samples = products.ldlt().solve(projections);
  return {samples.data(), samples.data() + samples.size()};
}

/// True within three samples of an end at which the field falls to 0.
bool is_near_a_rim(const Unknowns& unknowns, std::size_t unknown) {
  for (std::size_t axis = 3; axis-- > 0;) {
    const auto count = static_cast<std::size_t>(unknowns.shape()[axis]);
    const std::size_t at = unknown % count;
    unknown /= count;
    const bool begins_at_rim = axis > 0 || !unknowns.begins_at_centre();
    if (count > 1 && ((begins_at_rim && at < 3) || at + 4 > count)) return true;
  }
  return false;
}

RegularLattice line_of(int count) {
  RegularLattice lattice;
  lattice.count = {count, 1, 1};
  lattice.index_to_world.linear = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  return lattice;
}

// Straight lines miss a curved field by a term of second order in the step. The correction leaves
// a tenth of it at these steps.
TEST(ValuesAtPlaces, AreThoseOfTheFieldThatLinesComeNearestTo) {
  const auto field = [](double x) { return 2 + std::sin(0.7 * x); };
  constexpr int kCount = 21;
  const std::vector<double> samples = nearest_lines(kCount, field);
  const auto unknowns = make_voxel_unknowns(line_of(kCount));
  const std::vector<double> values = values_at_places(*unknowns, samples, {});
  double before = 0, after = 0;
  for (int i = 2; i < kCount - 2; ++i) {
    const auto at = static_cast<std::size_t>(i);
    before += std::pow(samples[at] - field(i), 2);
    after += std::pow(values[at] - field(i), 2);
  }
  EXPECT_GT(std::sqrt(before / kCount), 0.02);
  EXPECT_LT(std::sqrt(after), 0.1 * std::sqrt(before));
}

// By hand: an isolated sample along two axes; the light stays, but not in what is known to be
// empty.
TEST(ValuesAtPlaces, KeepTheLightAndLeaveEmptyOnesEmpty) {
  RegularLattice lattice = line_of(5);
  lattice.count = {5, 5, 1};
  const auto unknowns = make_voxel_unknowns(lattice);
  std::vector<double> samples(25, 0.0);
  samples[12] = 144;
  std::vector<double> expected(25, 0.0);
  expected[12] = 100;
  for (const std::size_t j : {7, 11, 13, 17}) expected[j] = 10;
  for (const std::size_t j : {6, 8, 16, 18}) expected[j] = 1;
  const std::vector<double> values = values_at_places(*unknowns, samples, {});
  for (std::size_t j = 0; j < 25; ++j) EXPECT_TRUE(relative(values[j], expected[j], 1e-13)) << j;
  std::vector<char> solved(25, 1);
  solved[11] = 0;
  EXPECT_EQ(values_at_places(*unknowns, samples, solved)[11], 0);
  EXPECT_TRUE(relative(values_at_places(*unknowns, samples, solved)[12], 100, 1e-13));
}

// A field of third degree that is even about the axis, at places inside: cubic interpolation keeps
// it.
TEST(ValuesAtPlaces, RefinedOnesAreOfTheSameField) {
  RegularLattice lattice;
  lattice.count = {6, 5, 1};
  lattice.index_to_world.linear = {{{{0, 2, 0}, {1, 0, 0}, {0, 0, 3}}}};
  lattice.index_to_world.translation = {-4, 1, 2};
  const RingGrid rings{{1, 2, 3}, {0, 0, 1}, 0.5, 2, 7, 6};
  const std::vector<std::unique_ptr<Unknowns>> all = [&] {
    std::vector<std::unique_ptr<Unknowns>> list;
    list.push_back(make_voxel_unknowns(lattice));
    list.push_back(make_ring_unknowns(rings));
    list.push_back(make_layer_unknowns({{3, 0, 0}, {4, 5, 6}, 8}));
    return list;
  }();
  const std::array<double, 3> centres{0, 1, 3};
  for (std::size_t n = 0; n < all.size(); ++n) {
    SCOPED_TRACE(n);
    const auto field = [&](const Vec3& at) {
      const double radius = at.x - centres[n];
      return 900 + 3 * radius * radius + at.y + std::pow(at.z - 4, 3);
    };
    std::vector<double> values;
    for (std::size_t j = 0; j < all[n]->size(); ++j) values.push_back(field(all[n]->place(j)));
    const std::unique_ptr<Unknowns> finer = all[n]->refined();
    const std::vector<double> fine = refined_values(*all[n], values);
    ASSERT_EQ(fine.size(), finer->size());
    std::size_t inside = 0;
    for (std::size_t j = 0; j < fine.size(); ++j) {
      const Vec3 at = finer->place(j);
      if (is_near_a_rim(*finer, j)) continue;
      ++inside;
      EXPECT_TRUE(relative(fine[j], field(at), 1e-13)) << j;
    }
    EXPECT_GT(inside, finer->size() / 5);
  }
}

// An axis of one unknown has no places between.
TEST(ValuesAtPlaces, OfASingleSampleAlongAnAxisAreRefinedAlongTheOther) {
  for (const auto& [count, refined] :
       {std::pair<std::array<int, 2>, std::array<int, 2>>{{1, 4}, {1, 9}}, {{4, 1}, {8, 1}}}) {
    const auto rings = make_ring_unknowns({{}, {0, 0, 1}, 1, 1, count[0], count[1]});
    const std::unique_ptr<Unknowns> finer = rings->refined();
    EXPECT_EQ(finer->shape()[0], refined[0]);
    EXPECT_EQ(finer->shape()[1], refined[1]);
    EXPECT_EQ(refined_values(*rings, std::vector<double>(4, 1.0)).size(), finer->size());
  }
}

// About the axis of rings a field goes on as it came; constant voxels are no lines.
TEST(ValuesAtPlaces, AtACentreAndOfConstantVoxels) {
  RingGrid grid;
  grid.radial_step = grid.height_step = 1;
  grid.rings = 4;
  grid.heights = 1;
  const std::vector<double> samples{12, 6, 0, 0};
  const std::vector<double> values = values_at_places(*make_ring_unknowns(grid), samples, {});
  EXPECT_TRUE(relative(values[0], 11, 1e-13));
  EXPECT_TRUE(relative(values[1], 6, 1e-13));
  EXPECT_TRUE(relative(values[2], 0.5, 1e-13));
  RegularLattice lattice = line_of(4);
  lattice.interpolation = VoxelInterpolation::constant;
  EXPECT_EQ(values_at_places(*make_voxel_unknowns(lattice), samples, {}), samples);
}

// Samples that change as fast as they can, with an empty one among them.
TEST(ValuesAtPlaces, TellTheirSamples) {
  RegularLattice lattice = line_of(5);
  lattice.count = {5, 6, 7};
  const auto unknowns = make_voxel_unknowns(lattice);
  std::vector<double> samples;
  for (int j = 0; j < 210; ++j) samples.push_back(3 + std::sin(1.7 * j * j));
  std::vector<char> solved(samples.size(), 1);
  samples[100] = solved[100] = 0;
  const std::vector<double> found =
      samples_of_places(*unknowns, values_at_places(*unknowns, samples, solved));
  for (std::size_t j = 0; j < samples.size(); ++j) {
    if (j == 100)
      EXPECT_EQ(found[j], 0);
    else
      EXPECT_TRUE(relative(found[j], samples[j], 1e-5)) << j;
  }
}

}  // namespace
// Between two samples of a parabola the field is a step^2 / 8 of its curvature from the line. A
// field that differs along both axes errs by the root of the sum of squares.
TEST(ErrorsOfChords, AreTheLargestDistancesFromTheLines) {
  constexpr int kCount = 9, kMiddle = kCount / 2;
  const auto field = [](double x, double y) { return 50 - 0.8 * x * x + 0.3 * y * y; };
  RegularLattice lattice = line_of(kCount);
  lattice.count = {kCount, kCount, 1};
  std::vector<double> values;
  for (int i = 0; i < kCount; ++i)
    for (int j = 0; j < kCount; ++j) values.push_back(field(i, j));
  const auto farthest = [&](bool first) {
    double distance = 0;
    for (int k = 0; k <= 1000; ++k) {
      const double s = kMiddle + k / 1000.0, share = s - kMiddle;
      const auto on = [&](double t) { return first ? field(t, kMiddle) : field(kMiddle, t); };
      distance = std::max(distance,
                          std::fabs(on(s) - (1 - share) * on(kMiddle) - share * on(kMiddle + 1)));
    }
    return distance;
  };
  const std::vector<double> errors = errors_of_chords(*make_voxel_unknowns(lattice), values);
  EXPECT_TRUE(relative(errors[static_cast<std::size_t>(kMiddle * kCount + kMiddle)],
                       std::hypot(farthest(true), farthest(false)), 1e-5));
}

// A spike errs by a quarter of its height, and its neighbours share in it. Rings are even about
// their axis, where a spike is a line that has nothing on either side.
TEST(ErrorsOfChords, OfASpikeAndAtACentre) {
  const std::vector<double> spike{0, 0, 0, 8, 0, 0, 0};
  const std::vector<double> errors = errors_of_chords(*make_voxel_unknowns(line_of(7)), spike);
  const double squares[] = {0, 0.25, 0.25 * 4 + 0.5, 0.5 * 4 + 2 * 0.25};
  EXPECT_EQ(errors[0], 0);
  for (std::size_t j = 1; j < 6; ++j)
    EXPECT_TRUE(relative(errors[j], std::sqrt(squares[j < 4 ? j : 6 - j]), 1e-13)) << j;
  // The same light from a source function of 2 in matter that differs from place to place.
  const std::vector<double> source(7, 2), matter{0, 0, 0, 4, 0, 0, 0};
  const std::vector<double> of_source =
      errors_of_chords(*make_voxel_unknowns(line_of(7)), source, matter);
  EXPECT_TRUE(relative(of_source[3], errors[3] / 4, 1e-13));
  EXPECT_EQ(of_source[2], 0);
  RingGrid grid;
  grid.radial_step = grid.height_step = 1;
  grid.rings = 4;
  grid.heights = 1;
  const std::vector<double> line =
      errors_of_chords(*make_ring_unknowns(grid), std::vector<double>{8, 0, 0, 0});
  EXPECT_TRUE(relative(line[0], std::sqrt(0.5 * 4 + 0.5), 1e-13));
  EXPECT_TRUE(relative(line[1], std::sqrt(0.5 + 0.25 * 4), 1e-13));
  EXPECT_TRUE(relative(line[2], 0.5, 1e-13));
}

}  // namespace plenoflame::test::values_at_places_test
