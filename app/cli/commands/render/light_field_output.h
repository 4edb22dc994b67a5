#pragma once
#include <optional>
#include <string>
#include <vector>

#include "image_files.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/light_field_channel.h"
#include "plenoflame/lightfield/micro_images.h"
#include "plenoflame/lightfield/views.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// A raw light field with the camera that took it.
struct RawLightField {
  LightField field;
  CameraSpec camera;
  std::vector<WindowSpec> windows;  ///< before the camera

  /// The geometry of its pixels, rays bent by the windows. @param white as of MicroImages
  MicroImages micro_images(bool white, const Execution& execution) const;
};

/// Arguments of all commands that make something of a raw light field.
struct RawArguments {
  std::string input, output, scene, camera, channel;
  std::vector<std::string> set;
  int threads = 0;
  bool force = false, json = false;
};

/// RAW and -o, the first of a command's options.
void add_raw_input(CLI::App& command, RawArguments& arguments, const std::string& output_text);
/// --channel, --scene, --set, --force, --threads, --json: the last of them.
void add_raw_options(CLI::App& command, RawArguments& arguments);

/// The options of views that are made of it: --spread and --resampling.
struct ViewArguments {
  double spread = ViewSettings{}.spread;
  std::string resampling = "barycentric";
  ViewSettings settings() const;
};
void add_view_options(CLI::App& command, ViewArguments& arguments);

/// The light field of the arguments, one channel of it, with its camera. The camera is that of
/// --scene, or of the light field's own scene.
/// @throws FileError, InputError
RawLightField read_raw(const RawArguments& arguments, Layers layers = Layers::none);

/// Makes sure that results can go into a folder: its parent must exist, and what is there must be
/// empty unless `force`. Call it before the work.
/// @param force  of --force; nothing: the command has no such option
/// @throws FileError
void check_folder(const std::string& folder, std::optional<bool> force);

}  // namespace plenoflame::cli
