#pragma once
#include <string>

#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// The layers that are read besides a channel.
enum class Layers { none, all };

/// The flux of one channel of a file from write_light_field(). Other channels and all standard
/// errors stay in the file, so that memory holds only one image.
/// @param channel by name; empty: the first
/// @throws FileError, InputError as read_light_field, and InputError that lists the channels
LightField read_light_field_channel(const std::string& path, const std::string& channel,
                                    Layers layers = Layers::none);

/// The same of an EXR from elsewhere (read_foreign_image).
LightField read_foreign_channel(const std::string& path, const std::string& channel);

}  // namespace plenoflame
