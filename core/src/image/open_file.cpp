#include "plenoflame/image/open_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "plenoflame/base/error.h"

namespace plenoflame {

std::FILE* open_for_reading(const std::string& path) {
  const auto fail = [&path](const std::string& why) {
    return FileError("cannot read '" + path + "': " + why);
  };
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) throw fail(std::generic_category().message(errno));
  struct stat kind {};
  if (fstat(descriptor, &kind) == 0 && S_ISFIFO(kind.st_mode)) {
    // A pipe with something in it says so, whether or not its writer is still there. An empty one
    // ends at once where there is no writer, and else asks to wait.
    pollfd state{descriptor, POLLIN, 0};
    const bool filled = poll(&state, 1, 0) > 0 && (state.revents & POLLIN) != 0;
    char byte = 0;
    if (!filled) {
      const ssize_t count = ::read(descriptor, &byte, 1);
      if (count >= 0) {  // more than 0: it came this moment, and cannot be put back
        close(descriptor);
        throw fail(count == 0 ? "it is a pipe into which nobody writes"
                              : "the pipe was filled while it was opened; try again");
      }
    }
  }
  static_cast<void>(fcntl(descriptor, F_SETFL, 0));
  std::FILE* const file = fdopen(descriptor, "rb");
  if (file == nullptr) {
    const int error = errno;
    close(descriptor);
    throw fail(std::generic_category().message(error));
  }
  return file;
}

}  // namespace plenoflame
