#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "reconstruct_settings.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

struct FileOption;

/// Arguments of the command line of a reconstruction.
struct ReconstructArguments : ReconstructRequest {
  std::vector<std::string> scenes, set, cameras, images, residuals, reports, refined_scenes;
  std::string output;
  int threads = 0;
  bool json = false, quiet = false;
};

void add_reconstruct_options(CLI::App& command, ReconstructArguments& arguments,
                             std::vector<FileOption>& file);

/// Refuses files that do not fit each other, and outputs that cannot be written or are inputs.
/// @throws UsageError, FileError
void check_reconstruct_files(const ReconstructArguments& arguments, std::size_t frames);

/// Frames of a series: pictures for each of the cameras; 1 without a series. @throws UsageError
std::size_t frame_count(const ReconstructArguments& arguments, std::size_t cameras);

/// The output's name, with the frame's number before its ending in a series.
std::string frame_name(const std::string& path, std::size_t frame, std::size_t frames);

}  // namespace plenoflame::cli
