#include "build_information.h"

#include "commit.h"  // made by commit.cmake
#include "plenoflame/base/isa.h"
#include "plenoflame/base/version.h"

namespace plenoflame::cli {

std::string build_information() {
  std::string text = "plenoflame " + std::string(version()) + " (";
  const std::string commit = PLENOFLAME_COMMIT;
  if (!commit.empty()) text += "commit " + commit + "; ";
  text += "parts: light fields";
#ifdef PLENOFLAME_HAS_SURFACES
  text += ", solid surfaces";
#endif
#ifdef PLENOFLAME_HAS_VOLUMES
  text += ", flames from OpenVDB";
#endif
#ifdef PLENOFLAME_HAS_VTK
  text += ", pictures and import by VTK";
#endif
  return text + "; instruction set: " + std::string(name(best_isa())) + ")";
}

std::string missing_part(const std::string& command, const std::string& part) {
  const std::string preset = part == "VTK" ? "python" : "command";
  return "'" + command + "' needs " + part +
         ", which this build was made without; get it with tools/setup.sh " + preset +
         " && cmake --preset " + preset + " && cmake --build --preset " + preset +
         " (docs/user/install.md)";
}

}  // namespace plenoflame::cli
