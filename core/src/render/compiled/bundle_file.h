#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// CRC-32 of the content of a tile.
std::uint32_t tile_checksum(std::span<const CompiledGroup> groups,
                            std::span<const CompiledNode> nodes);

/// Reads the content of a tile and checks it against a scene. @param paths, parts of the scene
/// @throws FileError for a tile that is damaged, or belongs to another scene
CompiledContent content_for(const CompiledCamera& camera, std::size_t tile, std::size_t paths,
                            std::size_t parts, const std::string& name);

/// Checks that a scene holds only flames. @throws InputError
void check_content(const CompiledScene& scene);

}  // namespace plenoflame
