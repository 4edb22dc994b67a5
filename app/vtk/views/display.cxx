#include "display.h"

#include <vtkRenderingOpenGLConfigure.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#if defined(VTK_USE_X) && !defined(VTK_OPENGL_HAS_OSMESA)
#include <X11/Xlib.h>
#define PLENOFLAME_NEEDS_X
#endif

namespace plenoflame::views {

#ifdef PLENOFLAME_NEEDS_X

DisplayConnection::DisplayConnection() {
  // Tried here, since VTK ends the program when it gets no connection; several times, since a
  // server may just be starting.
  constexpr int kAttempts = 5;
  const char* const name = std::getenv("DISPLAY");
  const bool named = name && *name;
  for (int attempt = 0; named && !display_ && attempt < kAttempts; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    display_ = XOpenDisplay(nullptr);
  }
  if (display_) return;
  why_not_ = named ? "the X display '" + std::string(name) + "' cannot be opened"
                   : std::string("there is no X display");
  why_not_ +=
      ", and this VTK draws through X; put xvfb-run in front of the command (Debian packages xvfb "
      "and xauth), e.g. xvfb-run -a plenoflame picture ...";
}

DisplayConnection::~DisplayConnection() {
  if (display_) XCloseDisplay(static_cast<Display*>(display_));
}

#else

DisplayConnection::DisplayConnection() = default;
DisplayConnection::~DisplayConnection() = default;

#endif

}  // namespace plenoflame::views
