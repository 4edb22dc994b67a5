#pragma once
#include <cstdint>
#include <span>

#include "plenoflame/render/compiled_camera.h"

namespace plenoflame {

/// CRC-32 of what a tile keeps.
std::uint32_t tile_checksum(std::span<const CompiledGroup> groups,
                            std::span<const CompiledNode> nodes);

/// That a scene holds nothing but flames. @throws InputError
void check_content(const CompiledScene& scene);

}  // namespace plenoflame
