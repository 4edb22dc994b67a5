#pragma once
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/inverse/glowing_grid.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/unknowns.h"
#include "plenoflame/render/ranks.h"
#include "support/small_scene.h"

/// Ranks that are threads of one process, and cameras whose rays they share.
namespace plenoflame::test {

/// Mailboxes of ranks that are threads of this process.
struct Post {
  explicit Post(int ranks) : boxes(static_cast<std::size_t>(ranks)) {}
  std::mutex mutex;
  std::vector<std::deque<RankMessage>> boxes;
};

class ThreadRank final : public Communicator {
 public:
  ThreadRank(Post& post, int rank, int on_node = 1) : post_(post), rank_(rank), on_node_(on_node) {}
  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(post_.boxes.size()); }
  int ranks_on_node() const override { return on_node_; }
  void send(int to, std::string bytes) override {
    const std::lock_guard lock(post_.mutex);
    post_.boxes[static_cast<std::size_t>(to)].push_back({rank_, std::move(bytes)});
  }
  std::optional<RankMessage> receive() override {
    const std::lock_guard lock(post_.mutex);
    auto& own = post_.boxes[static_cast<std::size_t>(rank_)];
    if (own.empty()) return std::nullopt;
    RankMessage first = std::move(own.front());
    own.pop_front();
    return first;
  }

 private:
  Post& post_;
  int rank_, on_node_;
};

inline constexpr std::array<int, 3> kCount{5, 6, 7};

struct Cameras {
  CompiledScene scene;
  std::unique_ptr<Unknowns> unknowns;
  CameraRaySettings settings;

  /// The first camera sees a window that is no multiple of a tile, the second one all.
  std::vector<CameraView> views() const { return {{&scene, {3, 5, 85, 70}}, {&scene, {}}}; }
};

inline Cameras make_cameras(int bin, int samples) {
  const AffineTransform map = scaled(1.5e-3, {1 - 3e-3, -4e-3, -4.5e-3});
  const std::size_t size = 5 * 6 * 7;
  const GlowingGrid g{kCount, map, std::vector<double>(size, 1), std::vector<double>(size, 20)};
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.camera.sensor = {90, 80, 0.064e-3};
  scene.flames = {glowing_flame()};
  scene.channels = {{"430nm", ChannelKind::band, 430e-9, 20e-9}};
  Cameras cameras{compile(scene, glowing_loader(g)), nullptr, {}};
  cameras.unknowns = make_voxel_unknowns({kCount, map, VoxelInterpolation::trilinear});
  cameras.settings.samples = samples;
  cameras.settings.bin = bin;
  return cameras;
}

}  // namespace plenoflame::test
