// Damaged files of the command's own results, which it reads back: refused in one line, or read and
// consistent. PLENOFLAME_DAMAGED_FILES=100000 tries so many of each kind.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "commands/render/bench_report.h"
#include "commands/render/run_record.h"
#include "commands/scene/info.h"
#include "commands/scene/ray_counts.h"
#include "number_rows.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/render/ray_paths.h"
#include "support/damaged_files.h"

namespace plenoflame::test::damaged_results_test {
namespace {

using Random = std::mt19937_64;

/// Words that are wrong in most places of JSON and XML.
std::vector<std::string> words_of_results() {
  std::vector<std::string> words = awkward_words();
  words.insert(words.end(), {"null", "{}", "[[", "\"rays\":", "<Piece", "/>", "&#0;", "\\u0000",
                             "\"\"", "]]>", "1e999", "\"reached\"", ",,", ";"});
  return words;
}

Outcomes read_damaged_text(const char* what, const std::vector<std::string>& samples, int seed,
                           const std::function<void(const std::string& text)>& read,
                           LeastShares least = {}) {
  const std::vector<std::string> words = words_of_results();
  Random random(static_cast<std::uint64_t>(seed));
  for (const std::string& sample : samples) read(sample);  // undamaged: does not throw
  return read_damaged(
      what, damaged_files_wanted(2000), samples,
      [&](const std::string& whole) { return damage_text(whole, words, random); }, read, least);
}

/// Two rays, of which one ends in the camera.
RayPaths two_rays() {
  RayPaths paths;
  paths.channels = {"red", "a \"quoted\", name"};
  paths.wavelengths = {650e-9, 0};
  paths.surfaces = {"sensor", "lens"};
  paths.rays.resize(2);
  paths.rays[0].weight = 1e-12;
  paths.rays[1].status.status = RayStatus::vignetted;
  paths.radiance = {1, 2, 0, 0};
  for (RayPath& ray : paths.rays) {
    ray.first = paths.vertices.size();
    ray.count = 3;
    for (int k = 0; k < 3; ++k) paths.vertices.push_back({{0.1 * k, 0, -0.5 * k}, k - 1});
  }
  return paths;
}

TEST(DamagedResults, RowsOfNumbers) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.csv");
  read_damaged_text("points and pixels (.csv)",
                    {"x, y, z\n0,0.001,1e-3\n# more\n-0.5,0,8 # the last\r\n", "1,2,3\n\n4,5,6"}, 1,
                    [&](const std::string& text) {
                      write_bytes(path, text);
                      const auto rows = read_number_rows(path, {3}, "a point");
                      ASSERT_FALSE(rows.empty());
                      for (const NumberRow& row : rows) {
                        ASSERT_EQ(row.values.size(), 3U);
                        for (const double value : row.values) ASSERT_TRUE(std::isfinite(value));
                      }
                    });
}

TEST(DamagedResults, RayPaths) {
  const TemporaryFolder folder;
  const auto counted = [](const cli::RayCounts& counts) {
    ASSERT_EQ(std::accumulate(counts.by_status.begin(), counts.by_status.end(), std::size_t{0}),
              counts.rays);
    ASSERT_EQ(counts.flux.size(), counts.channels.size());
    Report report;
    cli::report_ray_counts(counts, report);
    ASSERT_FALSE(report.json_text().empty());
  };
  for (const std::string ending : {"csv", "json", "vtp"}) {
    const std::string path = folder.file("a." + ending);
    write_ray_paths(path, two_rays());
    const std::string whole = read_bytes(path);
    const std::string what = "ray paths (." + ending + ")";
    // Only the tags of a .vtp file are read: much of the damage goes to the numbers between them.
    const LeastShares least = ending == "vtp" ? LeastShares{0.1, 0.05} : LeastShares{};
    read_damaged_text(
        what.c_str(), {whole}, 2,
        [&](const std::string& text) {
          write_bytes(path, text);
          Report report;
          if (ending == "csv") counted(cli::count_rays_of_csv(path));
          if (ending == "json") counted(cli::count_rays_of_json(path));
          if (ending == "vtp") cli::describe_poly_data(path, report);
          static_cast<void>(report.json_text());
        },
        least);
  }
}

TEST(DamagedResults, Benchmarks) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.json");
  cli::BenchResult result;
  result.scene = "candle.toml";
  result.scene_text = "[camera]\n";
  for (const int samples : {4, 16}) {
    BenchmarkPoint point;
    point.samples = samples;
    point.relative_rmse = 1.0 / samples;
    point.seconds = {0.1 * samples, 0.12 * samples};
    point.rays = 1000;
    result.points.push_back(point);
  }
  const nlohmann::ordered_json now = cli::bench_json(result);
  read_damaged_text(
      "benchmarks (.json)", {now.dump(2), now.dump()}, 3, [&](const std::string& text) {
        write_bytes(path, text);
        const std::string said = cli::bench_comparison(now, cli::read_bench_json(path));
        ASSERT_FALSE(said.empty());
      });
}

TEST(DamagedResults, RecordsOfRuns) {
  cli::RunRecord record;
  record.version = "1";
  record.scene_text = "[camera]\n";
  record.scene_file = "/a/b.toml";
  record.files = {{"flame.vdb", 12345, 1700000000}};
  record.numbers = {{"exposure.time", 0.001}};
  record.texts = {{"frame.run", "a"}};
  read_damaged_text("records of runs", {cli::to_text(record)}, 4, [](const std::string& text) {
    const cli::RunRecord back = cli::record_from(text, "a.exr.state");
    ASSERT_EQ(cli::to_text(cli::record_from(cli::to_text(back), "again")), cli::to_text(back));
  });
}

}  // namespace
}  // namespace plenoflame::test::damaged_results_test
