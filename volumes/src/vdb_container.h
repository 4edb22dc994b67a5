#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "vdb_bytes.h"

namespace plenoflame::detail {

/// The head of a grid, before its transform and tree.
struct GridEntry {
  std::string unique_name;  ///< as in the file; differs from `name` when several share a name
  std::string name;
  std::string tree_type;        ///< "Tree_float_5_4_3", without the suffix for 16-bit values
  std::string instance_parent;  ///< unique name of the grid whose tree this one shares, or empty
  bool half = false;
  std::uint32_t compression = 0;  ///< OpenVDB's COMPRESS_* flags
  std::map<std::string, std::string> metadata;
  std::size_t transform_position = 0;
};

/// Structure of a .vdb file without its trees.
struct Container {
  std::uint32_t file_version = 0;
  std::uint32_t library_major = 0, library_minor = 0;
  std::vector<GridEntry> grids;
};

/// Walks through header, metadata and grid descriptors. OpenVDB's own readers trust the lengths
/// that they find, so that a damaged file could make them write outside of their buffers; this
/// looks first. Files of OpenVDB 2.0 (2013, file version 222) and later.
/// @throws Damaged saying what is wrong.
Container parse_container(const std::vector<char>& bytes);

}  // namespace plenoflame::detail
