#include "commands/reconstruct/reconstruct_input.h"

#include <memory>
#include <utility>

#include "medium_loader.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame::cli {
namespace {

/// Files of a frame, one for each camera.
std::vector<std::string> files_of(const ReconstructArguments& arguments, std::size_t cameras,
                                  std::size_t frame) {
  const std::size_t frames = frame_count(arguments, cameras);
  std::vector<std::string> names;
  for (std::size_t v = 0; v < cameras; ++v) names.push_back(arguments.images[v * frames + frame]);
  return names;
}

}  // namespace

ReconstructCameras compile_cameras(const ReconstructArguments& arguments,
                                   const std::vector<CameraScene>& views,
                                   const Execution& execution) {
  const std::vector<std::string> names = files_of(arguments, views.size(), 0);
  const LightField first = read_light_field(names[0], execution.stop);
  std::vector<ReconstructCamera> cameras;
  for (const CameraScene& view : views) {
    cameras.push_back(
        {std::make_shared<const CompiledScene>(compile(
             view.document, medium_loader(), execution,
             {cameras.empty() ? nullptr : cameras.front().scene.get()}, {IssueCode::no_flame})),
         view.what()});
  }
  return reconstruct_cameras(arguments, std::move(cameras), first, names);
}

FramePictures read_frame(const ReconstructArguments& arguments, const ReconstructCameras& cameras,
                         std::size_t frame, const Execution& execution) {
  FramePictures result;
  result.names = files_of(arguments, cameras.cameras.size(), frame);
  for (const std::string& file : result.names)
    result.pictures.push_back(read_light_field(file, execution.stop));
  result.measurements = measure_frame(arguments, cameras, result.pictures, result.names);
  return result;
}

}  // namespace plenoflame::cli
