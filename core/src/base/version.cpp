#include "plenoflame/base/version.h"

namespace plenoflame {

std::string_view version() {
  return PLENOFLAME_VERSION;
}

}  // namespace plenoflame
