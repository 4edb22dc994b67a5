// A run that was stopped and continued gives the bits of a run in one go.
#include <optional>
#include <stop_token>

#include "plenoflame/base/error.h"
#include "plenoflame/film/checkpoint.h"
#include "plenoflame/film/reopened.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/render/render.h"
#include "render/estimators/backward.h"
#include "render/estimators/rounds.h"
#include "support/approx.h"
#include "support/cameras.h"
#include "support/flame_scenes.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::continued_test {
namespace {

/// Stops at the n-th checkpoint, and goes on from what that one was given, with other threads.
RenderResult in_two_parts(const CompiledScene& scene, RenderSettings settings, int checkpoints) {
  std::optional<Film> kept;
  std::stop_source stop;
  Execution execution = threads(3);
  execution.stop = stop.get_token();
  int count = 0;
  settings.checkpoint_seconds = 0;
  settings.checkpoint = [&](const Film& film) {
    if (++count == checkpoints) {
      kept = film;
      stop.request_stop();
    }
  };
  const RenderResult part = render(scene, settings, execution);
  EXPECT_FALSE(part.statistics.complete) << "was not stopped";
  EXPECT_TRUE(kept.has_value());
  settings.checkpoint = {};
  settings.resume = &*kept;
  return render(scene, settings, one_thread());
}

void expect_same(const CompiledScene& scene, const RenderSettings& settings, int checkpoints) {
  const RenderResult whole = render(scene, settings, threads(2));
  const RenderResult parts = in_two_parts(scene, settings, checkpoints);
  EXPECT_TRUE(parts.statistics.complete);
  EXPECT_GT(whole.statistics.flux, 0);
  EXPECT_LT(parts.statistics.rays, whole.statistics.rays) << "nothing was taken over";
  EXPECT_EQ(parts.light_field.samples, whole.light_field.samples);
  EXPECT_TRUE(parts.film == whole.film);
  for (std::size_t c = 0; c < whole.light_field.channels.size(); ++c) {
    EXPECT_TRUE(parts.light_field.channels[c].flux == whole.light_field.channels[c].flux);
    EXPECT_TRUE(parts.light_field.channels[c].standard_error ==
                whole.light_field.channels[c].standard_error);
  }
}

TEST(Continued, BackwardWithFixedSamples) {
  const CompiledScene scene = compile(paper_flame(560, 500, 0.004));
  RenderSettings settings;
  settings.samples = 8;
  expect_same(scene, settings, 2);
  // A complete film leaves nothing to do.
  const RenderResult whole = render(scene, settings, one_thread());
  settings.resume = &whole.film;
  const RenderResult again = render(scene, settings, one_thread());
  EXPECT_TRUE(again.statistics.complete);
  EXPECT_EQ(again.statistics.rays, 0);
  EXPECT_TRUE(again.film == whole.film);
  EXPECT_TRUE(again.light_field.channels[0].flux == whole.light_field.channels[0].flux);
}

// A run that was stopped before the first ray goes on as what is asked for then.
TEST(Continued, AStoppedStartBindsNothing) {
  const CompiledScene scene = compile(paper_flame(200, 170, 0.004));
  RenderSettings settings;
  settings.samples = 8;
  std::stop_source stop;
  stop.request_stop();
  Execution execution = one_thread();
  execution.stop = stop.get_token();
  const RenderResult start = render(scene, settings, execution);
  ASSERT_EQ(start.statistics.rays, 0);
  const auto expect_as_new = [&] {
    settings.resume = nullptr;
    const RenderResult whole = render(scene, settings, one_thread());
    settings.resume = &start.film;
    const RenderResult rest = render(scene, settings, one_thread());
    EXPECT_TRUE(rest.film == whole.film);
    EXPECT_TRUE(rest.light_field.channels[0].flux == whole.light_field.channels[0].flux);
  };
  expect_as_new();
  settings.samples = 1 << 16;
  settings.target_error = 0.06;
  expect_as_new();
}

TEST(Continued, FromAFile) {
  const CompiledScene scene = compile(paper_flame(260, 200, 0.004));
  RenderSettings settings;
  settings.samples = 8;
  settings.checkpoint_seconds = 0;
  std::stop_source stop;
  Execution execution = threads(2);
  execution.stop = stop.get_token();
  settings.checkpoint = [&](const Film&) { stop.request_stop(); };
  const RenderResult part = render(scene, settings, execution);
  ASSERT_FALSE(part.statistics.complete);
  ASSERT_GT(part.statistics.rays, 0);
  const TemporaryFolder folder;
  const std::string path = folder.file("state");
  write_checkpoint(path, part.film, "key");
  const Film film = read_checkpoint(path, "key");
  EXPECT_TRUE(film == part.film);
  EXPECT_THROW(read_checkpoint(path, "another key"), InputError);
  const std::string good = read_file(path);
  for (std::size_t at = 0; at < good.size(); at += at < 100 ? 1 : good.size() / 7) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = good;
      bad[at] = static_cast<char>(bad[at] ^ 1 << bit);
      write_file(path, bad);
      EXPECT_THROW(read_checkpoint(path, "key"), Error) << at << " " << bit;
    }
    write_file(path, good.substr(0, at));
    EXPECT_THROW(read_checkpoint(path, "key"), FileError) << at;
  }
  settings.checkpoint = {};
  settings.resume = &film;
  const RenderResult rest = render(scene, settings, one_thread());
  settings.resume = nullptr;
  const RenderResult whole = render(scene, settings, one_thread());
  EXPECT_LT(rest.statistics.rays, whole.statistics.rays);
  EXPECT_TRUE(rest.light_field.channels[0].flux == whole.light_field.channels[0].flux);
  settings.resume = &film;
  settings.target_error = 0.1;
  const RenderResult target = render(scene, settings, one_thread());
  EXPECT_TRUE(target.statistics.complete && target.statistics.target_reached);
  EXPECT_LE(target.statistics.relative_error_bound, 0.1);
}

// A complete picture takes more samples: its error is that of a picture with as many at one go, and
// lies off a far better one by no more than it states.
TEST(Continued, ACompletePictureGetsMoreSamples) {
  const CompiledScene scene = compile(paper_flame(260, 200, 0.004));
  RenderSettings settings;
  settings.samples = 512;
  settings.seed = 7;
  const Image best = render(scene, settings, threads(2)).light_field.channels[0].flux;
  settings.seed = 1;
  settings.samples = 8;
  const RenderResult first = render(scene, settings, threads(2));
  const Film film = film_of(first.light_field);
  settings.samples = 64;
  const RenderResult whole = render(scene, settings, threads(2));
  settings.resume = &film;
  const RenderResult more = render(scene, settings, threads(2));
  EXPECT_TRUE(more.statistics.complete);
  EXPECT_EQ(more.light_field.samples, 64);
  EXPECT_LT(more.statistics.rays, whole.statistics.rays);
  const auto rmse = [&](const Image& flux) {
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < flux.pixels.size(); ++i) {
      const double off = static_cast<double>(flux.pixels[i] - best.pixels[i]);
      squares += off * off;
      sum += static_cast<double>(best.pixels[i]);
    }
    return std::sqrt(squares * static_cast<double>(flux.pixels.size())) / sum;
  };
  const double at_first = rmse(first.light_field.channels[0].flux),
               at_once = rmse(whole.light_field.channels[0].flux),
               in_parts = rmse(more.light_field.channels[0].flux);
  EXPECT_LT(at_once, 0.5 * at_first);
  EXPECT_LT(in_parts, 0.5 * at_first);
  EXPECT_LT(in_parts, 1.5 * at_once);
  // The stated error adds those of both parts in squares, and so misses that the parts of one
  // sequence cancel: 1.2 to 1.4 times that of the whole.
  EXPECT_LT(more.statistics.relative_error, 1.5 * whole.statistics.relative_error);
  EXPECT_GT(more.statistics.relative_error, 0.7 * whole.statistics.relative_error);
}

TEST(Continued, PartsOfTheSequenceAddUpToTheWhole) {
  // A pixel's points in [0, 16) and [16, 48) are those in [0, 48), on all levels.
  const CompiledScene scene = compile(paper_flame(64, 64, 0.001));
  RenderSettings settings;
  settings.precision = Precision::double_precision;
  const BackwardShared shared(scene, settings, {});
  const PixelWindow window{0, 0, 64, 64};
  const auto film_of = [&](const std::vector<PointRange>& ranges) {
    Film film(window, 1, settings.replicates);
    RenderStatistics statistics;
    for (const PointRange& range : ranges)
      EXPECT_TRUE(BackwardPass(scene, settings, {range}, shared)
                      .run({{0}}, one_thread(), film, statistics));
    return film;
  };
  const Film whole = film_of({{0, 48, true}}), parts = film_of({{0, 16, true}, {16, 32, true}});
  const Film other = film_of({{0, 16, true}, {64, 32, true}});
  int lit = 0, different = 0;
  for (int row = 0; row < 64; ++row)
    for (int column = 0; column < 64; ++column)
      for (int r = 0; r < settings.replicates; ++r) {
        const double sum = whole.sum(0, r, column, row);
        lit += sum > 0;
        different += other.sum(0, r, column, row) != sum;
        ASSERT_TRUE(relative(parts.sum(0, r, column, row), sum, 1e-12)) << column << "," << row;
      }
  EXPECT_GT(lit, 1000);
  EXPECT_GT(different, lit / 2);
}

TEST(Continued, ATimeLimitInTheFirstRoundLeavesThePictureIncomplete) {
  const CompiledScene scene = compile(paper_flame(1500, 1500));
  RenderSettings settings;
  settings.samples = 1 << 20;
  settings.time_limit = 1e-6;
  settings.target_error = 0.5;
  const RenderResult result = render(scene, settings, one_thread());
  EXPECT_FALSE(result.statistics.complete);
  EXPECT_FALSE(result.statistics.target_reached);
}

TEST(Continued, OneReplicateWithinATimeLimit) {
  const CompiledScene scene = compile(paper_flame(64, 64));
  RenderSettings settings;
  settings.samples = 64;
  settings.replicates = 1;
  settings.time_limit = 1e3;
  const RenderResult result = render(scene, settings, one_thread());
  EXPECT_TRUE(result.statistics.complete);
  EXPECT_GT(result.statistics.flux, 0);
}

TEST(Continued, ADarkPictureIsNotCalledSoAfterAFewRays) {
  // Nothing glows in the box, but rays must be sent to see that.
  const CompiledScene scene = scene_of(
      paper_flame(64, 64).camera, make_layered_medium({{{1, 0, 0}, {0.01, 0.01, 0.03}, 0, 20}},
                                                      RigidTransform{}, {SourceFunction::total()}));
  RenderSettings settings;
  settings.samples = 1 << 16;
  settings.target_error = 0.01;
  const RenderResult dark = render(scene, settings, one_thread());
  EXPECT_FALSE(dark.statistics.target_reached) << "no relative error is known";
  EXPECT_EQ(dark.statistics.flux, 0);
  EXPECT_EQ(dark.light_field.samples, 64 * settings.replicates);
}

TEST(Continued, BackwardToATarget) {
  RenderSettings settings;
  settings.samples = 1 << 16;
  settings.target_error = 0.06;
  const CompiledScene scene = compile(paper_flame(200, 170, 0.004));
  for (const int checkpoints : {1, 2}) expect_same(scene, settings, checkpoints);
}

TEST(Continued, BackwardWithinARoundToATarget) {
  // Stopped after a few tiles of a round: what the round was to do is kept, and done first.
  RenderSettings settings;
  settings.samples = 1 << 16;
  settings.target_error = 0.06;
  const CompiledScene scene = compile(paper_flame(200, 170, 0.004));
  const RenderResult whole = render(scene, settings, one_thread());
  for (const double share : {0.1, 0.4, 0.7}) {
    std::stop_source stop;
    Execution execution = threads(2);
    execution.stop = stop.get_token();
    // Well before the end: progress counts from 0 in every part of a round.
    execution.progress = [&](const Progress& progress) {
      if (progress.rays > share * whole.statistics.rays) stop.request_stop();
    };
    const RenderResult part = render(scene, settings, execution);
    ASSERT_FALSE(part.statistics.complete) << share;
    settings.resume = &part.film;
    const RenderResult rest = render(scene, settings, one_thread());
    settings.resume = nullptr;
    EXPECT_TRUE(rest.film == whole.film) << share;
  }
}

TEST(Continued, BetweenThePassesOfARound) {
  // Tiles that get more points than a pass holds come several times in a round, and ranges that do
  // not fit together come one after the other: stopped between any two of them nothing is lost.
  constexpr int kMostPoints = 8;
  RenderSettings settings;
  settings.samples = 1 << 16;
  settings.target_error = 0.008;
  const CompiledScene scene = compile(paper_flame(200, 170, 0.004));
  const PixelWindow window{0, 0, 200, 170};
  const auto run = [&](Film& film, const Execution& execution) {
    RenderStatistics statistics;
    statistics.complete = true;
    render_rounds(scene, settings, execution, film, statistics, kMostPoints);
    return statistics;
  };
  Film whole(window, 1, settings.replicates);
  settings.checkpoint_seconds = 0;
  int passes = 0;
  settings.checkpoint = [&](const Film&) { ++passes; };
  ASSERT_TRUE(run(whole, threads(2)).target_reached);
  double most = 0;
  for (const double samples : whole.all_tile_samples()) most = std::max(most, samples);
  EXPECT_GT(most, 4.0 * kMostPoints) << "no tile needed several passes";
  ASSERT_GE(passes, 6);
  for (const int stop_after : {1, 3, passes / 2, passes - 1}) {
    Film film(window, 1, settings.replicates);
    std::stop_source stop;
    Execution execution = threads(3);
    execution.stop = stop.get_token();
    int count = 0;
    settings.checkpoint = [&](const Film&) {
      if (++count == stop_after) stop.request_stop();
    };
    ASSERT_FALSE(run(film, execution).complete) << stop_after;
    settings.checkpoint = {};
    EXPECT_TRUE(run(film, one_thread()).complete);
    EXPECT_TRUE(film == whole) << stop_after;
  }
}

TEST(Continued, ATileComesOnceInAPass) {
  const CompiledScene scene = compile(paper_flame(64, 64, 0.001));
  const RenderSettings settings;
  const BackwardShared shared(scene, settings, {});
  Film film({0, 0, 64, 64}, 1, settings.replicates);
  RenderStatistics statistics;
  const BackwardPass pass(scene, settings, {{0, 4}, {4, 4}}, shared);
  EXPECT_THROW(pass.run({{0, 0}, {0, 1}}, one_thread(), film, statistics), std::logic_error);
  EXPECT_EQ(film.tile_samples(0), 0);
}

TEST(Continued, ForwardWithFixedSamples) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 3000001;  // a last chunk that is not whole
  expect_same(compile(bare_flame(24, 20, 0.9e-3)), settings, 1);
}

TEST(Continued, ForwardToATarget) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 100000000;
  settings.target_error = 0.025;
  const CompiledScene scene = compile(bare_flame(24, 20, 0.9e-3));
  for (const int checkpoints : {1, 2}) expect_same(scene, settings, checkpoints);
}

TEST(Continued, AForwardTimeLimitIsNoInterruption) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 1 << 30;
  settings.time_limit = 0.3;
  const RenderResult result = render(compile(bare_flame(24, 20, 0.9e-3)), settings);
  EXPECT_TRUE(result.statistics.complete);
  EXPECT_TRUE(result.statistics.target_reached);
  EXPECT_LT(result.light_field.samples, 1 << 30);
}

TEST(Continued, AForwardTargetThatCannotBeReached) {
  RenderSettings settings;
  settings.estimator = Estimator::forward;
  settings.replicates = 4;
  settings.samples = 200000;
  settings.target_error = 1e-4;
  const RenderResult result = render(compile(bare_flame(24, 20, 0.9e-3)), settings);
  EXPECT_TRUE(result.statistics.complete);
  EXPECT_FALSE(result.statistics.target_reached);
  EXPECT_EQ(result.light_field.samples, 200000);
}

}  // namespace
}  // namespace plenoflame::test::continued_test
