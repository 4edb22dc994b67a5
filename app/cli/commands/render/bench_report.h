#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "plenoflame/render/benchmark.h"

namespace plenoflame::cli {

/// All that `bench` found out.
struct BenchResult {
  std::string scene;    ///< as given
  std::string command;  ///< that repeats it
  std::string scene_text;
  PixelWindow window;
  int repeat = 1, threads = 1;
  BenchmarkReference reference;
  std::vector<BenchmarkPoint> points;
};

/// Figures in SI units with machine, compiler, version and date.
nlohmann::ordered_json bench_json(const BenchResult& result);
/// The table for people. @param columns that a line may have, beyond which further ones of the
/// table stand below; 0: any number
std::string bench_table(const nlohmann::ordered_json& bench, std::size_t columns);
/// One line per point under a line of names.
std::string bench_csv(const nlohmann::ordered_json& bench);
/// Error against time as BASE.svg and BASE.png. @throws FileError
void write_bench_plots(const std::string& base, const nlohmann::ordered_json& bench);

/// Reads what bench wrote. @throws FileError, InputError when it is something else
nlohmann::ordered_json read_bench_json(const std::string& path);
/// Says what became faster or worse: ratios of new to old for every point that both have.
/// @throws InputError when they have none in common
std::string bench_comparison(const nlohmann::ordered_json& now, const nlohmann::ordered_json& old);

}  // namespace plenoflame::cli
