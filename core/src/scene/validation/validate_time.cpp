#include <fmt/format.h>

#include "scene/files/file_series.h"
#include "scene/schema/nearest.h"
#include "scene/validation/issues.h"

namespace plenoflame {

void check_flame_time(const FlameSpec& flame, const std::string& path, const std::string& what,
                      Issues& issues) {
  const int digits = FileSeries::digits_of(flame.file);
  const FlameTimeSpec& time = flame.time;
  if (flame.kind != FlameKind::vdb) {
    if (time.is_series())
      issues.error(path + ".frame_rate",
                   what + " is layered, but a series of files needs kind = \"vdb\"");
    return;
  }
  if (time.is_series() && digits == 0 && !flame.file.empty())
    issues.error(path + ".file", what +
                                     " is a series, since it has a frame_rate; write # for each "
                                     "digit of its files' numbers, such as \"run_####.vdb\"");
  // A single # may be part of a file's name.
  if (!time.is_series() && digits > 1)
    issues.error(
        path + ".file",
        quote_for_message(flame.file) +
            " is a series of files; give their number per second, such as frame_rate = \"1 kHz\"");
  if (!time.is_series() && time.first_frame >= 0)
    issues.error(path + ".first_frame", what +
                                            " has a first_frame and no frame_rate; give the number "
                                            "of files per second, such as frame_rate = \"1 kHz\"");
}

}  // namespace plenoflame
