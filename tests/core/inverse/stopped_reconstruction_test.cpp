// A stop in the middle of a product that follows the rays: it ends there, and what the iterations
// before it have reached is handed out.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stop_token>

#include "core/inverse/glow_scene.h"
#include "plenoflame/base/error.h"
#include "plenoflame/inverse/emission_operator.h"
#include "plenoflame/inverse/reconstruction.h"
#include "plenoflame/inverse/thermal_reconstruction.h"
#include "plenoflame/scene/spectral.h"
#include "support/approx.h"

namespace plenoflame::test::stopped_reconstruction_test {
namespace {

/// Unknowns that count the rays that are followed through them, and ask for a stop at one of them.
class StoppingUnknowns final : public Unknowns {
 public:
  explicit StoppingUnknowns(const Unknowns& own) : own_(own) {}
  std::size_t size() const override { return own_.size(); }
  std::array<int, 3> shape() const override { return own_.shape(); }
  std::array<double, 3> spacing() const override { return own_.spacing(); }
  Box bounds() const override { return own_.bounds(); }
  std::unique_ptr<Unknowns> refined() const override { return own_.refined(); }
  Vec3 place(std::size_t unknown) const override { return own_.place(unknown); }
  double volume(std::size_t unknown) const override { return own_.volume(unknown); }
  VoxelField field(std::span<const double> values, const std::string& name) const override {
    return own_.field(values, name);
  }
  void append(const Ray& ray, double t_near, double t_far, RayIntervals& out) const override {
    if (++rays == stop_at) stop.request_stop();
    own_.append(ray, t_near, t_far, out);
  }

  mutable std::atomic<std::size_t> rays = 0;
  std::atomic<std::size_t> stop_at = 0;  ///< 0: never
  mutable std::stop_source stop;

 private:
  const Unknowns& own_;
};

/// A ring of light before one camera, without a matrix.
struct Glow {
  CompiledScene compiled = compile(glow_scene(80));
  std::unique_ptr<Unknowns> rings = make_ring_unknowns(glow_rings());
  ReconstructionSettings settings;
  ReconstructionInput input;
  std::size_t rays = 0;  ///< of one product

  Glow() {
    settings.rays.samples = 4;
    settings.iterations = 40;
    settings.draws = settings.probes = 0;
    settings.strength = 1e-4;
    settings.memory = 1;
    settings.ray_noise = false;  // the picture is made of the same rays
    input.views.push_back({&compiled, {}});
    const CameraRays drawn = draw_camera_rays(input.views, rings->bounds(), settings.rays);
    rays = drawn.rays.size();
    std::vector<double> glow;
    for (std::size_t j = 0; j < rings->size(); ++j) glow.push_back(glow_at(rings->place(j)));
    const std::vector<double> b =
        *make_emission_operator({&drawn, rings.get(), RowModel::emission, {}}, {}) * glow;
    Measurement picture;
    picture.window = {0, 0, 80, 120};
    picture.flux = Image(80, 120);
    picture.deviation =
        Image(80, 120, static_cast<float>(1e-4 * *std::max_element(b.begin(), b.end())));
    for (std::size_t i = 0; i < b.size(); ++i)
      picture.flux.at(drawn.rows[i].column, drawn.rows[i].row) = static_cast<float>(b[i]);
    input.measurements.push_back(std::move(picture));
  }

  Reconstruction found(StoppingUnknowns& unknowns, int threads) const {
    ReconstructionInput own = input;
    own.unknowns = &unknowns;
    Execution execution;
    execution.threads = threads;
    execution.stop = unknowns.stop.get_token();
    return reconstruct(own, settings, execution);
  }
};

constexpr int kIterations = 5;

class StoppedIn : public testing::TestWithParam<ReconstructionSolver> {};

// Stopped in the sixth iteration, a run has what five of them have; most solvers follow no ray for
// that, those that cut off negative values once each for the picture of it.
TEST_P(StoppedIn, KeepsTheLastWholeIteration) {
  Glow glow;
  glow.settings.solver = GetParam();
  glow.settings.evidence = false;
  // Without a start this solver begins with what conjugate gradients find, and is soon at its end.
  if (GetParam() == ReconstructionSolver::fista) glow.input.start.assign(glow.rings->size(), 0.0);
  const bool cut =
      GetParam() == ReconstructionSolver::cgls || GetParam() == ReconstructionSolver::lsqr;
  StoppingUnknowns plain(*glow.rings);
  glow.settings.iterations = kIterations;
  const Reconstruction five = glow.found(plain, 2);
  ASSERT_EQ(five.history.size(), static_cast<std::size_t>(kIterations));
  glow.settings.iterations = 40;
  for (const double share : {0.3, 0.6, 1.3}) {
    StoppingUnknowns unknowns(*glow.rings);
    int iterations = 0;
    glow.settings.watch = [&](const ReconstructionState&) {
      if (++iterations == kIterations)
        unknowns.stop_at =
            unknowns.rays + static_cast<std::size_t>(share * static_cast<double>(glow.rays));
    };
    const Reconstruction stopped = glow.found(unknowns, 2);
    EXPECT_EQ(stopped.reason, StopReason::stopped);
    EXPECT_FALSE(stopped.complete);
    EXPECT_EQ(stopped.history.size(), five.history.size()) << share;
    EXPECT_EQ(stopped.values, five.values) << share;
    EXPECT_TRUE(relative(stopped.chi_squared, five.chi_squared, 1e-12));
    EXPECT_EQ(stopped.explained[0].pixels, five.explained[0].pixels);
    const double after =
        static_cast<double>(unknowns.rays - unknowns.stop_at) / static_cast<double>(glow.rays);
    EXPECT_LT(after, cut ? 1.2 : 0.2) << share;
  }
}
INSTANTIATE_TEST_SUITE_P(Solvers, StoppedIn,
                         testing::Values(ReconstructionSolver::fista, ReconstructionSolver::cgls,
                                         ReconstructionSolver::lsqr, ReconstructionSolver::sirt,
                                         ReconstructionSolver::mlem),
                         [](const auto& solver) {
                           switch (solver.param) {
                             case ReconstructionSolver::fista:
                               return "fista";
                             case ReconstructionSolver::cgls:
                               return "cgls";
                             case ReconstructionSolver::lsqr:
                               return "lsqr";
                             case ReconstructionSolver::sirt:
                               return "sirt";
                             default:
                               return "mlem";
                           }
                         });

// The error of a known absorption comes after the solution. A stop in it leaves the solution, and
// no part of the deviations.
TEST(StoppedReconstruction, InTheErrorOfTheAbsorptionKeepsTheSolution) {
  Glow glow;
  glow.settings.evidence = false;
  glow.input.absorption.assign(glow.rings->size(), 20);
  StoppingUnknowns plain(*glow.rings);
  const Reconstruction without = glow.found(plain, 2);
  ASSERT_TRUE(without.complete);
  glow.settings.draws = 1;
  glow.settings.absorption_error = 0.1;
  for (const double share : {0.5, 1.5, 6.5}) {
    StoppingUnknowns unknowns(*glow.rings);
    unknowns.stop_at =
        plain.rays + static_cast<std::size_t>(share * static_cast<double>(glow.rays));
    const Reconstruction stopped = glow.found(unknowns, 2);
    EXPECT_FALSE(stopped.complete) << share;
    EXPECT_EQ(stopped.values, without.values) << share;
    EXPECT_TRUE(stopped.deviation.empty() && stopped.absorption_shift.empty()) << share;
    EXPECT_LT(static_cast<double>(unknowns.rays - unknowns.stop_at),
              0.2 * static_cast<double>(glow.rays))
        << share;
  }
}

// The strength of a trial is none to go on with.
TEST(StoppedReconstruction, InTheSearchForTheStrengthNamesNone) {
  Glow glow;
  glow.settings.strength = -1;
  for (const int last : {3, 300}) {  // in the first trial, and in a later one
    StoppingUnknowns unknowns(*glow.rings);
    int states = 0;
    glow.settings.watch = [&](const ReconstructionState&) {
      if (++states == last) unknowns.stop.request_stop();
    };
    const Reconstruction stopped = glow.found(unknowns, 2);
    EXPECT_FALSE(stopped.complete) << last;
    EXPECT_EQ(stopped.strength, -1) << last;
    EXPECT_EQ(stopped.values.size(), glow.rings->size()) << last;
  }
  glow.settings.watch = nullptr;
  glow.settings.memory = 1e9;  // with the matrix it takes a tenth of the time
  StoppingUnknowns whole(*glow.rings);
  EXPECT_GE(glow.found(whole, 2).strength, 0);
}

// Both products look at the stop every few rows: parts of them that threads share are longer.
TEST(StoppedReconstruction, ProductsEndInTheMiddle) {
  const Glow glow;
  const CameraRays drawn =
      draw_camera_rays(glow.input.views, glow.rings->bounds(), glow.settings.rays);
  for (const bool transpose : {false, true}) {
    StoppingUnknowns unknowns(*glow.rings);
    Execution execution;
    execution.threads = 1;
    execution.stop = unknowns.stop.get_token();
    const auto a = make_emission_operator({&drawn, &unknowns, RowModel::emission, {}}, execution);
    std::vector<double> x(a->columns(), 1.0), y(a->rows(), 1.0);
    unknowns.stop_at = glow.rays / 100;
    EXPECT_THROW(transpose ? a->apply_transpose(y, x) : a->apply(x, y), Cancelled);
    EXPECT_LT(static_cast<double>(unknowns.rays),
              (transpose ? 0.04 : 0.1) * static_cast<double>(glow.rays))
        << transpose;
  }
}

/// A hot ring in two channels, to be found from a start that knows neither temperature nor
/// absorption.
struct HotRing {
  CompiledScene compiled;
  std::unique_ptr<Unknowns> rings = make_ring_unknowns(glow_rings());
  ThermalSettings settings;
  ThermalInput input;
  std::size_t rays = 0;  ///< of all rows

  explicit HotRing(bool both) : compiled(compile(scene(both))) {
    const int columns = columns_of(both), lines = columns * 3 / 2;
    settings.linear.rays.samples = 4;
    settings.linear.draws = settings.linear.probes = 0;
    settings.linear.strength = 1e-3;
    settings.linear.support = settings.linear.ray_noise = false;  // no linear problem first
    const std::size_t n = rings->size();
    std::vector<double> x, absorption;
    for (std::size_t j = 0; j < n; ++j) x.push_back(1300 + 0.6 * glow_at(rings->place(j)));
    for (std::size_t j = 0; j < n; ++j) absorption.push_back(2 + 0.02 * glow_at(rings->place(j)));
    for (const double kappa : absorption) x.push_back(std::log(kappa));
    input.views.push_back({&compiled, {}});
    input.start_temperature.assign(n, 1500);
    if (both)
      input.start_absorption.assign(n, 8);
    else
      input.absorption = absorption;
    for (std::size_t c = 0; c < (both ? 2U : 1U); ++c) {
      ThermalPictures pictures;
      pictures.channel = static_cast<int>(c);
      pictures.source = channel_source(compiled.scene, c);
      pictures.absorption_ratio = c == 0 ? 1 : 650.0 / 850;
      CameraRaySettings how = settings.linear.rays;
      how.seed += c;
      const CameraRays drawn = draw_camera_rays(input.views, rings->bounds(), how);
      rays += drawn.rays.size();
      ThermalModel model;
      model.unknowns = rings.get();
      model.channels = {{&drawn, pictures.source, pictures.absorption_ratio}};
      const std::vector<double> b = thermal_fluxes(model, x);
      Measurement picture;
      picture.window = {0, 0, columns, lines};
      picture.flux = Image(columns, lines);
      picture.deviation =
          Image(columns, lines, static_cast<float>(1e-3 * *std::max_element(b.begin(), b.end())));
      for (std::size_t i = 0; i < b.size(); ++i)
        picture.flux.at(drawn.rows[i].column, drawn.rows[i].row) = static_cast<float>(b[i]);
      pictures.measurements.push_back(std::move(picture));
      input.channels.push_back(std::move(pictures));
    }
  }
  /// Enough rows that those between two looks at the stop are few of them.
  static int columns_of(bool both) { return both ? 40 : 56; }
  static Scene scene(bool both) {
    Scene result = glow_scene(columns_of(both));
    result.channels.push_back({"850nm", ChannelKind::band, 850e-9, 10e-9});
    return result;
  }
  ThermalReconstruction found(StoppingUnknowns& unknowns) const {
    ThermalInput own = input;
    own.unknowns = &unknowns;
    Execution execution;
    execution.threads = 2;
    execution.stop = unknowns.stop.get_token();
    return reconstruct_thermal(own, settings, execution);
  }
};

class ThermalStop : public testing::TestWithParam<bool> {};

// Temperatures, and absorptions with them: stopped in the third step, with a derivative that is
// stored or not, a run has what two steps have, and follows next to no ray after the stop. Fails
// when the picture of what was reached is made anew, or its derivative.
TEST_P(ThermalStop, KeepsTheLastWholeStep) {
  constexpr int kSteps = 2;
  HotRing ring(GetParam());
  for (const double memory : {0.0, 2e9}) {
    ring.settings.linear.memory = memory;
    ring.settings.linear.watch = nullptr;
    ring.settings.steps = kSteps;
    StoppingUnknowns plain(*ring.rings);
    const ThermalReconstruction two = ring.found(plain);
    ASSERT_EQ(two.figures.history.size(), static_cast<std::size_t>(kSteps));
    ring.settings.steps = 20;
    for (const double share : {0.3, 0.8}) {
      StoppingUnknowns unknowns(*ring.rings);
      int steps = 0;
      ring.settings.linear.watch = [&](const ReconstructionState&) {
        if (++steps == kSteps)
          unknowns.stop_at =
              unknowns.rays + static_cast<std::size_t>(share * static_cast<double>(ring.rays));
      };
      const ThermalReconstruction stopped = ring.found(unknowns);
      EXPECT_EQ(stopped.figures.reason, StopReason::stopped);
      EXPECT_FALSE(stopped.figures.complete);
      EXPECT_EQ(stopped.estimate.temperature, two.estimate.temperature);
      EXPECT_EQ(stopped.estimate.absorption, two.estimate.absorption);
      EXPECT_EQ(stopped.figures.chi_squared, two.figures.chi_squared);
      EXPECT_EQ(stopped.figures.explained[0].pixels, two.figures.explained[0].pixels);
      const double after =
          static_cast<double>(unknowns.rays - unknowns.stop_at) / static_cast<double>(ring.rays);
      EXPECT_LT(after, 0.2) << share << " " << memory;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Sought, ThermalStop, testing::Bool(),
                         [](const auto& both) { return both.param ? "both" : "temperature"; });

// At any moment a run ends within little more than the product that tells what is handed out; until
// the first guess has an iteration there is nothing.
TEST(StoppedReconstruction, AtAnyMoment) {
  Glow glow;
  glow.settings.strength = -1;
  glow.settings.ray_noise = true;  // with a first guess
  bool nothing = false, something = false;
  // The step's length takes thirty products each way, of the first guess and of each solution.
  for (const int products : {0, 1, 2, 5, 40, 64, 70, 80, 100, 130, 150, 170, 200, 230}) {
    StoppingUnknowns unknowns(*glow.rings);
    unknowns.stop_at = static_cast<std::size_t>((products + 0.5) * static_cast<double>(glow.rays));
    try {
      const Reconstruction found = glow.found(unknowns, 2);
      something = true;
      EXPECT_EQ(found.reason, StopReason::stopped) << products;
      EXPECT_FALSE(found.complete);
      EXPECT_GT(*std::max_element(found.values.begin(), found.values.end()), 0) << products;
    } catch (const Cancelled&) {
      nothing = true;
      EXPECT_FALSE(something) << products;
    }
    const double after =
        static_cast<double>(unknowns.rays - unknowns.stop_at) / static_cast<double>(glow.rays);
    EXPECT_LT(after, 1.5) << products;
  }
  EXPECT_TRUE(nothing && something);
}

}  // namespace
}  // namespace plenoflame::test::stopped_reconstruction_test
