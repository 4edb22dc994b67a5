#include "commands/light_field/develop_colour.h"

#include <array>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/base/report.h"
#include "plenoflame/lightfield/colour.h"
#include "run.h"
#include "terminal.h"

namespace plenoflame::cli {

int develop_colour(const LightField& light_field, const Scene& scene, double saturation,
                   const std::string& output, bool json) {
  const ColourChannels colours = display_colours(light_field, scene);
  std::array<const Image*, 3> chosen{};
  for (std::size_t k = 0; k < 3; ++k) chosen[k] = &find_channel(light_field, colours.names[k]).flux;
  const ColourSettings settings{colours.is_xyz, saturation};
  PngImage picture = colour_picture(chosen, settings);
  const std::string what = settings.is_xyz ? "XYZ to sRGB" : "as red, green, blue";
  const std::string used =
      colours.names[0] + ", " + colours.names[1] + ", " + colours.names[2] + " " + what;
  picture.texts = {{"Software", "Plenoflame " + light_field.version}, {"Comment", used}};
  write_png(output, picture);
  Report report;
  report.add("picture", output, "picture", output);
  report.add("channels", used, "channels", colours.names);
  report.add_json("colour", settings.is_xyz ? "xyz" : "rgb");
  print(report, json);
  return kSuccess;
}

}  // namespace plenoflame::cli
