#include "commands/light_field/develop_colour.h"

#include <array>

#include "options.h"
#include "plenoflame/base/error.h"
#include "plenoflame/lightfield/colour.h"
#include "report.h"
#include "run.h"

namespace plenoflame::cli {

int develop_colour(const LightField& light_field, const Scene& scene, double saturation,
                   const std::string& output, bool json) {
  std::array<const LightFieldChannel*, 3> chosen{};
  const char* const names[] = {"cie_x", "cie_y", "cie_z"};
  for (std::size_t c = 0; c < scene.channels.size() && c < light_field.channels.size(); ++c)
    for (std::size_t k = 0; k < 3; ++k)
      if (scene.channels[c].kind == ChannelKind::named && scene.channels[c].response == names[k])
        chosen[k] = &light_field.channels[c];
  ColourSettings settings;
  settings.saturation = saturation;
  settings.is_xyz = chosen[0] && chosen[1] && chosen[2];
  if (!settings.is_xyz) {
    if (light_field.channels.size() < 3)
      throw InputError(
          "a colour picture needs channels with the responses cie_x, cie_y and cie_z, or three "
          "channels as red, green and blue; the light field has " +
          std::to_string(light_field.channels.size()));
    for (std::size_t k = 0; k < 3; ++k) chosen[k] = &light_field.channels[k];
  }
  PngImage picture =
      colour_picture({&chosen[0]->flux, &chosen[1]->flux, &chosen[2]->flux}, settings);
  const std::string what = settings.is_xyz ? "XYZ to sRGB" : "as red, green, blue";
  const std::string used =
      chosen[0]->name + ", " + chosen[1]->name + ", " + chosen[2]->name + " " + what;
  picture.texts = {{"Software", "Plenoflame " + light_field.version}, {"Comment", used}};
  write_png(output, picture);
  Report report;
  report.add("picture", output, "picture", output);
  report.add("channels", used, "channels", {chosen[0]->name, chosen[1]->name, chosen[2]->name});
  report.add_json("colour", settings.is_xyz ? "xyz" : "rgb");
  report.print(json);
  return kSuccess;
}

}  // namespace plenoflame::cli
