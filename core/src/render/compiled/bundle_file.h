#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// CRC-32 of what a tile keeps.
std::uint32_t tile_checksum(std::span<const CompiledGroup> groups,
                            std::span<const CompiledNode> nodes);

/// The contents of a tile are as they were written, and nothing else follows from it.
/// @param paths, parts of the scene that it is used for @throws FileError
void check_tile(const CompiledCamera& camera, const CompiledTile& tile, std::size_t paths,
                std::size_t parts, const std::string& name);

/// That a scene holds nothing but flames. @throws InputError
void check_content(const CompiledScene& scene);

}  // namespace plenoflame
