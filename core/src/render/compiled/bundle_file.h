#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// CRC-32 of what a tile keeps.
std::uint32_t tile_checksum(std::span<const CompiledGroup> groups,
                            std::span<const CompiledNode> nodes);

/// What a tile keeps, for a scene. @param paths, parts of the scene
/// @throws FileError for one that is damaged, or of another scene
CompiledContent content_for(const CompiledCamera& camera, std::size_t tile, std::size_t paths,
                            std::size_t parts, const std::string& name);

/// That a scene holds nothing but flames. @throws InputError
void check_content(const CompiledScene& scene);

}  // namespace plenoflame
