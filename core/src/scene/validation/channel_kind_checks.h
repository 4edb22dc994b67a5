#pragma once
#include <string>

#include "scene/validation/issues.h"

namespace plenoflame {

/// Tells what cannot be of a channel of its kind. @param path of the channel in the scene
void check_channel_kind(const ChannelSpec& channel, const std::string& path, Issues& issues);

}  // namespace plenoflame
