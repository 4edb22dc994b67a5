#pragma once
#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace plenoflame {

/// Memory of numbers that is all zeros when it is got, and is not written to for them to be zeros.
template <class T>
struct ZeroedAllocator {
  static_assert(std::is_trivial_v<T>);
  using value_type = T;

  ZeroedAllocator() = default;
  template <class U>
  ZeroedAllocator(const ZeroedAllocator<U>&) {}

  T* allocate(std::size_t count) {
    void* const memory = std::calloc(count, sizeof(T));
    if (!memory) throw std::bad_alloc();
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t) { std::free(memory); }

  /// Leaves numbers without value as they are in memory: 0 in new memory.
  template <class U>
  void construct(U*) {}
  template <class U, class... Values>
  void construct(U* place, Values&&... values) {
    ::new (static_cast<void*>(place)) U(std::forward<Values>(values)...);
  }

  friend bool operator==(const ZeroedAllocator&, const ZeroedAllocator&) { return true; }
};

/// The numbers of a picture. For a large and mostly dark picture the system allocates only the
/// memory pages that hold light.
struct PixelValues : std::vector<float, ZeroedAllocator<float>> {
  using vector::vector;
  /// New values are 0, also where the memory is not.
  void resize(std::size_t count) { vector::resize(count, 0.0F); }
};

}  // namespace plenoflame
