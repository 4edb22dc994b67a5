#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "plenoflame/scene/scene.h"
#include "raw_pictures.h"

/// Files and values of single channels of a camera: NAME=VALUE.
namespace plenoflame {

/// An exposure time [s] with its unit. @param setting as messages write it @throws UsageError
double exposure_of_text(const std::string& setting, const std::string& text);

/// The values that are a channel's own, or else the ones with no channel in front.
/// @param option as messages write it @param channel empty: pictures that have several channels
/// @throws UsageError
std::vector<std::string> values_of_channel(const std::string& option,
                                           const std::vector<std::string>& values,
                                           const std::string& channel, const Scene& scene);

/// Files of each channel, in the scene's order. Without names in front of the files: the channels
/// that all pictures have.
struct ChannelFiles {
  std::vector<std::string> channels;  ///< empty: as many as the pictures have
  std::vector<std::string> files;
};

/// @throws UsageError
std::vector<ChannelFiles> channel_files(const RawPicturesRequest& arguments, const Scene& scene);

/// The scene's number of a channel. @throws UsageError that lists them
std::size_t channel_number(const Scene& scene, const std::string& name,
                           const SettingNames& setting);

/// Names of the channels that pictures hold. @throws InputError, UsageError
std::vector<std::string> names_of(const ChannelFiles& files, const CountFrames& frames,
                                  const Scene& scene, bool mosaic, const SettingNames& setting);

}  // namespace plenoflame
