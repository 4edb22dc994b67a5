#pragma once
#include <cstdint>
#include <string_view>

namespace plenoflame {

/// FNV-1a, 64 bits (Fowler, Noll, Vo; RFC 9923): finds damage and change, not malice.
class Fnv {
 public:
  void add(std::string_view bytes) {
    for (const char byte : bytes)
      state_ = (state_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace plenoflame
