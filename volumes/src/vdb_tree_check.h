#pragma once
#include <cstddef>
#include <cstdint>

#include "vdb_bytes.h"

namespace plenoflame::detail {

/// Walks through a float (value_size 4) or double (8) tree of the standard 5-4-3 configuration. It
/// checks that every length in it is the one that OpenVDB expects, because OpenVDB reads without
/// checks. Follows openvdb/tree/{RootNode,InternalNode,LeafNode}.h and openvdb/io/Compression.h,
/// file versions 222 to 224.
/// @param file stands at the tree's first byte   @throws Damaged
void check_tree(ByteReader file, std::size_t value_size, bool half, std::uint32_t compression);

}  // namespace plenoflame::detail
