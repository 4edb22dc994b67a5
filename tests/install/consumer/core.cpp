// Uses the installed library the way a program of somebody else would, with the parts that need
// OpenEXR, libpng and threads: a static library leaves those to whoever links it.
#include <atomic>
#include <cstdio>
#include <string>

#include "plenoflame/base/execution.h"
#include "plenoflame/base/version.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"

namespace {

bool threads_work() {
  plenoflame::Execution execution;
  execution.threads = 2;
  std::atomic<int> runs{0};
  plenoflame::parallel_for(execution, 10, [&](std::size_t, int) { ++runs; });
  return runs == 10;
}

bool pictures_work(const std::string& path) {
  plenoflame::PngImage image;
  image.width = 2;
  image.height = 1;
  image.samples = {7, 200};
  plenoflame::write_png(path, image);
  return plenoflame::read_png(path).samples == image.samples;
}

bool light_fields_work(const std::string& path) {
  plenoflame::LightField field;
  field.sensor_width = 2;
  field.sensor_height = 1;
  field.window = {0, 0, 2, 1};
  plenoflame::LightFieldChannel channel;
  channel.name = "total";
  channel.flux.width = 2;
  channel.flux.height = 1;
  channel.flux.pixels = {0.5f, 0.25f};
  field.channels.push_back(channel);
  plenoflame::write_light_field(path, field);
  return plenoflame::read_light_field(path).channels.at(0).flux.pixels == channel.flux.pixels;
}

}  // namespace

int main(int count, char** arguments) {
  const std::string folder = count > 1 ? arguments[1] : ".";
  std::printf("plenoflame %s\n", std::string(plenoflame::version()).c_str());
  if (!threads_work()) return 1;
  if (!pictures_work(folder + "/picture.png")) return 2;
  if (!light_fields_work(folder + "/field.exr")) return 3;
  return 0;
}
