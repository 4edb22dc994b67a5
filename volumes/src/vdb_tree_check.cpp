#include "vdb_tree_check.h"

#include <bit>

namespace plenoflame::detail {
namespace {

constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;
constexpr std::size_t kLeafValues = 512;  // 8^3
constexpr std::size_t kLowerValues = 16 * 16 * 16;
constexpr std::size_t kUpperValues = 32 * 32 * 32;
constexpr std::size_t kBloscHeader = 16;

std::size_t count_bits(const char* mask, std::size_t bytes) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < bytes; i += 8) {
    std::uint64_t word;
    std::memcpy(&word, mask + i, 8);
    count += static_cast<std::size_t>(std::popcount(word));
  }
  return count;
}

class TreeCheck {
 public:
  TreeCheck(ByteReader file, std::size_t value_size, bool half, std::uint32_t compression)
      : file_(file), value_size_(value_size), half_(half), compression_(compression) {}

  void run() {
    if (file_.value<std::int32_t>() != 1) throw Damaged("the number of buffers is not 1");
    file_.take(value_size_);  // background
    const auto tiles = file_.value<std::uint32_t>();
    const auto children = file_.value<std::uint32_t>();
    for (std::uint32_t i = 0; i < tiles; ++i) {
      root_origin();
      file_.take(value_size_ + 1);
    }
    for (std::uint32_t i = 0; i < children; ++i) {
      root_origin();
      const std::size_t lower_nodes = internal_node(kUpperValues);
      for (std::size_t lower = 0; lower < lower_nodes; ++lower) {
        const std::size_t leaves = internal_node(kLowerValues);
        file_.take(leaves * (kLeafValues / 8));  // value masks
        leaves_ += leaves;
      }
    }
    for (std::size_t leaf = 0; leaf < leaves_; ++leaf)
      values(kLeafValues, file_.take(kLeafValues / 8));
  }

 private:
  /// Multiples of the child's width. Their order does not matter for safety: every leaf's block
  /// starts with its own mask, so blocks can be read into any leaf.
  void root_origin() {
    for (int axis = 0; axis < 3; ++axis)
      if (file_.value<std::int32_t>() % 4096 != 0) throw Damaged("a root node's origin is wrong");
  }

  std::size_t internal_node(std::size_t size) {
    const char* children = file_.take(size / 8);
    const char* active = file_.take(size / 8);
    for (std::size_t i = 0; i < size / 8; ++i)
      if ((children[i] & active[i]) != 0)
        throw Damaged("the masks of a node contradict each other");
    values(size, active);
    return count_bits(children, size / 8);
  }

  void values(std::size_t size, const char* active) {
    const int kind = file_.value<std::int8_t>();
    if (kind < 0 || kind > 6) throw Damaged("a node's kind of compression is unknown");
    if (kind == 2 || kind == 4 || kind == 5) file_.take(value_size_);  // an inactive value
    if (kind == 5) file_.take(value_size_);                            // the second one
    if (kind == 3 || kind == 4 || kind == 5) file_.take(size / 8);     // which of both
    std::size_t stored = size;
    if ((compression_ & kActiveMask) != 0 && kind != 6) stored = count_bits(active, size / 8);
    if (half_ && stored == 0) return;
    chunk(stored * (half_ ? 2 : value_size_));
  }

  void chunk(std::size_t expected) {
    if ((compression_ & (kZip | kBlosc)) == 0) {
      file_.take(expected);
      return;
    }
    const auto length = file_.value<std::int64_t>();
    if (length <= 0) {  // stored as it is
      if (length != -static_cast<std::int64_t>(expected))
        throw Damaged("a block has the wrong length");
      file_.take(expected);
      return;
    }
    if (static_cast<std::uint64_t>(length) > file_.remaining()) throw Damaged("it ends too early");
    ByteReader block(file_.take(static_cast<std::size_t>(length)),
                     static_cast<std::size_t>(length));
    if ((compression_ & kBlosc) != 0) {
      if (block.remaining() < kBloscHeader) throw Damaged("a compressed block is too short");
      block.take(4);
      const auto plain = block.value<std::uint32_t>();
      block.take(4);
      const auto packed = block.value<std::uint32_t>();
      if (plain != expected || packed != static_cast<std::uint64_t>(length))
        throw Damaged("a compressed block has the wrong length");
    }
  }

  ByteReader file_;
  std::size_t value_size_;
  bool half_;
  std::uint32_t compression_;
  std::size_t leaves_ = 0;
};

}  // namespace

void check_tree(ByteReader file, std::size_t value_size, bool half, std::uint32_t compression) {
  TreeCheck(file, value_size, half, compression).run();
}

}  // namespace plenoflame::detail
