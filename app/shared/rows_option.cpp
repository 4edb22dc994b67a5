#include "rows_option.h"

#include "options.h"

namespace plenoflame {

void rows_option(const SettingNames& names, const std::string& bin, int cells,
                 CameraRaySettings& rays) {
  rays.bin = 1;
  rays.cells = bin == "view" ? cells : bin == "micro-image" ? 1 : 0;
  if (rays.cells == 0) rays.bin = whole_number_option(names("bin"), bin, 1, 10000);
}

}  // namespace plenoflame
