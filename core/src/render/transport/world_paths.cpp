#include "render/transport/world_paths.h"

namespace plenoflame {
namespace {

void follow(const WindowSet* windows, const Ray& ray, WindowPath& path) {
  path.stopped = false;
  if (windows)
    windows->trace(ray, path);
  else
    path.segments.resize(1), path.segments.front() = {ray, kInfinity, 1, -1};
}

}  // namespace

void trace_from(const CompiledScene& scene, const Ray& ray, WindowPath& path) {
  follow(scene.windows.get(), ray, path);
}

WorldPaths::WorldPaths(const CompiledScene& scene)
    : windows_(scene.windows.get()), surfaces_(scene.surfaces.get()), front_(scene.camera) {}

void WorldPaths::clear(std::size_t rays) {
  paths_.assign(rays, {});
  stretches_.clear();
  hits_.clear();
}

void WorldPaths::add(std::size_t ray, const Ray& line) {
  follow(windows_, {line.at(front_.t_near(line)), line.direction}, way_);
  WorldPath& path = paths_[ray];
  path.first = stretches_.size();
  path.open = !way_.stopped;
  SurfaceHit hit;
  for (const AirSegment& segment : way_.segments) {
    stretches_.push_back(segment);
    if (!surfaces_ || !surfaces_->intersect(segment.ray, 0, segment.far, {}, hit)) continue;
    stretches_.back().far = hit.t;
    stretches_.back().window = -1;
    path.hit = static_cast<int>(hits_.size());
    path.open = false;
    hits_.push_back(hit);
    break;
  }
  path.count = stretches_.size() - path.first;
}

const WorldPath& WorldPaths::trace(const Ray& line) {
  clear(1);
  add(0, line);
  return paths_.front();
}

}  // namespace plenoflame
