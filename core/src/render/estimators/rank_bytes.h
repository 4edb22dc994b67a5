#pragma once
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {

/// Appends values to a message in their memory layout, which is the same on all ranks. If this
/// function is inlined, GCC 12 warns wrongly that the string has too little room.
template <class Value>
[[gnu::noinline]] void put(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class Value>
void put_all(std::string& bytes, const std::vector<Value>& values) {
  static_assert(std::is_trivially_copyable_v<Value>);
  put(bytes, values.size());
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

/// Reads the values of a message. @throws Error for a message that ends too early
class RankReader {
 public:
  explicit RankReader(std::string_view bytes) : rest_(bytes) {}
  template <class Value>
  Value get() {
    Value value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  template <class Value>
  std::vector<Value> get_all() {
    const auto count = get<std::size_t>();
    if (count > rest_.size() / sizeof(Value)) throw too_short();
    std::vector<Value> values(count);
    const std::string_view bytes = take(count * sizeof(Value));
    if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }

 private:
  static Error too_short() { return Error("a message of another rank is too short"); }
  std::string_view take(std::size_t count) {
    if (count > rest_.size()) throw too_short();
    const std::string_view part = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return part;
  }
  std::string_view rest_;
};

}  // namespace plenoflame
