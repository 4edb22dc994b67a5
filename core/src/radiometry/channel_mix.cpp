#include "plenoflame/radiometry/channel_mix.h"

#include <utility>

namespace plenoflame {

ChannelMix ChannelMix::of_parts(const std::vector<int>& channel_of_node) {
  const std::size_t nodes = channel_of_node.size();
  const int channels = nodes > 0 ? channel_of_node.back() + 1 : 0;
  std::vector<double> weights(static_cast<std::size_t>(channels) * nodes);
  for (std::size_t n = 0; n < nodes; ++n)
    weights[static_cast<std::size_t>(channel_of_node[n]) * nodes + n] = 1;
  return {channels, std::move(weights)};
}

ChannelMix::ChannelMix(int channels, std::vector<double> weights)
    : channels_(channels), weights_(std::move(weights)) {
  if (channels_ > 0) nodes_ = static_cast<int>(weights_.size()) / channels_;
}

int ChannelMix::channel_of(int node) const {
  int channel = 0;
  while (channel + 1 < channels_ && weight(channel, node) == 0) ++channel;
  return channel;
}

}  // namespace plenoflame
