#pragma once
#include <cstddef>
#include <vector>

namespace plenoflame {

/// The weighted sums that turn nodes into a scene's channels. Nodes are the channels of media,
/// surfaces and lights: wavelengths or parts of a channel.
class ChannelMix {
 public:
  /// Nodes are the channels.
  ChannelMix() = default;
  /// Every node is a part of one channel. @param channel_of_node ascending, none left out
  static ChannelMix of_parts(const std::vector<int>& channel_of_node);
  /// Nodes that several channels share. @param weights at least 0; of node n in channel c at
  /// [c * nodes + n]
  ChannelMix(int channels, std::vector<double> weights);

  bool empty() const { return weights_.empty(); }
  int channels() const { return channels_; }
  int nodes() const { return nodes_; }
  double weight(int channel, int node) const {
    return weights_[static_cast<std::size_t>(channel) * static_cast<std::size_t>(nodes_) +
                    static_cast<std::size_t>(node)];
  }
  /// The first channel that a node belongs to.
  int channel_of(int node) const;

 private:
  int channels_ = 0, nodes_ = 0;
  std::vector<double> weights_;
};

}  // namespace plenoflame
