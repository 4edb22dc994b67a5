#include "render/transport/world_paths.h"

namespace plenoflame {

void trace_from(const CompiledScene& scene, const Ray& ray, WindowPath& path) {
  path.stopped = false;
  if (scene.windows)
    scene.windows->trace(ray, path);
  else
    path.segments.assign(1, AirSegment{ray, kInfinity, 1, -1});
}

WorldPaths::WorldPaths(const CompiledScene& scene)
    : windows_(scene.windows.get()), surfaces_(scene.surfaces.get()), front_(scene.camera) {}

void WorldPaths::clear(std::size_t rays) {
  paths_.assign(rays, {});
  stretches_.clear();
  hits_.clear();
}

void WorldPaths::add(std::size_t ray, const Ray& line) {
  const Ray begun{line.at(front_.t_near(line)), line.direction};
  WorldPath& path = paths_[ray];
  path.first = stretches_.size();
  path.open = true;
  if (windows_) {
    way_.stopped = false;
    windows_->trace(begun, way_);
    path.open = !way_.stopped;
    stretches_.insert(stretches_.end(), way_.segments.begin(), way_.segments.end());
  } else {
    stretches_.push_back({begun, kInfinity, 1, -1});
  }
  for (std::size_t s = path.first; surfaces_ && s < stretches_.size(); ++s) {
    AirSegment& stretch = stretches_[s];
    if (!surfaces_->intersect(stretch.ray, 0, stretch.far, {}, hit_)) continue;
    stretch.far = hit_.t;
    stretch.window = -1;
    path.hit = static_cast<int>(hits_.size());
    hits_.push_back(hit_);
    path.open = false;
    stretches_.resize(s + 1);
  }
  path.count = stretches_.size() - path.first;
}

const WorldPath& WorldPaths::trace(const Ray& line) {
  clear(1);
  add(0, line);
  return paths_.front();
}

}  // namespace plenoflame
