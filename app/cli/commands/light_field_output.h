#pragma once
#include <map>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/image/light_field_channel.h"
#include "plenoflame/lightfield/views.h"

namespace CLI {
class App;
}

namespace plenoflame::cli {

/// A raw light field with the camera that took it.
struct RawLightField {
  LightField field;
  CameraSpec camera;
};

/// What every command takes that makes something of a raw light field.
struct RawArguments {
  std::string input, output, scene, channel;
  int threads = 0;
  bool force = false, json = false;
};

/// RAW and -o, the first of a command's options.
void add_raw_input(CLI::App& command, RawArguments& arguments, const std::string& output_text);
/// --channel, --scene, --force, --threads, --json: the last of them.
void add_raw_options(CLI::App& command, RawArguments& arguments);

/// How views are made of it: --spread and --resampling.
struct ViewArguments {
  double spread = ViewSettings{}.spread;
  std::string resampling = "barycentric";
  ViewSettings settings() const;
};
void add_view_options(CLI::App& command, ViewArguments& arguments);

/// The light field of the arguments, one channel of it, with its camera: that of --scene, or of the
/// light field's own scene. @throws FileError, InputError
RawLightField read_raw(const RawArguments& arguments, Layers layers = Layers::none);

/// Makes sure that results can go into a folder: its parent must exist, and what is there must be
/// empty unless `force`. To be asked before the work is done. @throws FileError
void check_folder(const std::string& folder, bool force);
/// The same, and makes the folder. @throws FileError
void prepare_folder(const std::string& folder, bool force);

/// A picture that was computed from a raw light field, ready to be written.
struct NamedImage {
  std::string name;  ///< without folder and ending
  Image image;
  std::map<std::string, double> numbers;
};

/// Writes every image as PNG (sRGB curve, 16 bits, one exposure for all: 99.9 % of the pixels with
/// light are not saturated), and as EXR in `unit` when asked for.
/// @return the value that is white
/// @throws FileError, Cancelled
double write_images(const std::string& folder, const std::vector<NamedImage>& images,
                    const std::string& unit, const std::string& channel, bool exr,
                    const LightField& raw, const Execution& execution = {});

/// Writes a depth map: depth.exr with the channels "depth" [m] and "confidence", and depth.png, in
/// which the nearest depth is white, the farthest dark, and what is unknown black.
void write_depth(const std::string& folder, const Image& depth, const Image& confidence,
                 double nearest, double farthest, const LightField& raw);

}  // namespace plenoflame::cli
