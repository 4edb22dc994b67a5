#pragma once
#include <string>
#include <vector>

#include "commands/reconstruct/reconstruct_options.h"
#include "commands/scene_input.h"
#include "plenoflame/volumes/reconstructor.h"

namespace plenoflame::cli {

/// Compiles the scenes of the cameras, and finds the channels in them.
/// @throws FileError, InputError, UsageError
ReconstructCameras compile_cameras(const ReconstructArguments& arguments,
                                   const std::vector<CameraScene>& views,
                                   const Execution& execution);

/// The pictures of one frame.
struct FramePictures {
  std::vector<std::string> names;  ///< files
  std::vector<LightField> pictures;
  FrameMeasurements measurements;
};
/// @throws FileError, InputError as take_measurement()
FramePictures read_frame(const ReconstructArguments& arguments, const ReconstructCameras& cameras,
                         std::size_t frame, const Execution& execution);

}  // namespace plenoflame::cli
