#include "rows_option.h"

#include "options.h"

namespace plenoflame {

void rows_option(const std::string& bin, const std::string& cells, CameraRaySettings& rays) {
  const int parts = whole_number_option("--cells", cells, 1, 100);
  rays.bin = 1;
  rays.cells = bin == "view" ? parts : bin == "micro-image" ? 1 : 0;
  if (rays.cells == 0) rays.bin = whole_number_option("--bin", bin, 1, 10000);
}

}  // namespace plenoflame
