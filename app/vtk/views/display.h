#pragma once
#include <string>

namespace plenoflame::views {

/// A connection to what OpenGL draws through. Held while VTK draws: a virtual X server restarts
/// when its last client leaves, and refuses connections meanwhile.
class DisplayConnection {
 public:
  DisplayConnection();
  ~DisplayConnection();
  DisplayConnection(const DisplayConnection&) = delete;
  DisplayConnection& operator=(const DisplayConnection&) = delete;

  /// Why OpenGL cannot be used here, and what to do; empty: it can.
  const std::string& why_not() const { return why_not_; }

 private:
  void* display_ = nullptr;
  std::string why_not_;
};

}  // namespace plenoflame::views
