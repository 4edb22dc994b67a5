#pragma once
#include <cstdint>
#include <vector>

#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"
#include "render/medium_segments.h"

namespace plenoflame {

/// Light that media scatter into rays: random walks backwards along the light, one per ray. Places
/// of scattering are drawn by delta tracking (Woodcock et al., ANL-7050, 1965), directions by the
/// phase function. At each place the light of point and parallel lights is added, and the whole
/// emission that arrives along the new direction, which the medium integrates without random
/// numbers; so nothing is left to the walk itself but to find the places. Unbiased; walks end by
/// Russian roulette. One per worker.
class ScatterWalk {
 public:
  ScatterWalk(const CompiledScene& scene, const MediumOptions& options);

  /// A ray, followed from where it enters the medium.
  struct Start {
    int ray = 0;  ///< number in `radiance`
    Ray line;     ///< world, away from the camera
    std::uint64_t key = 0;
  };
  /// Adds to radiance[node][ray] what is scattered into the rays before they leave the medium.
  void add(const std::vector<Start>& starts, std::vector<std::vector<double>>& radiance,
           MediumCounters& counters);

 private:
  struct Walk {
    int ray;
    Ray line;
    NoiseStream noise;
    std::vector<double> weight;  ///< per node
  };
  bool collide(Walk& walk, double from, double& t) const;
  const Scatterer* scatter(Walk& walk, Vec3 place);
  void meet_places(std::vector<Walk>& walks, MediumCounters& counters);
  void add_lights(const std::vector<Walk>& walks, const std::vector<const Scatterer*>& scatterers,
                  std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  const CompiledScene& scene_;
  const Medium& medium_;
  Box bounds_;
  double majorant_;
  std::size_t nodes_;
  MediumSegments segments_;
  std::vector<double> ends_, coefficients_;
  std::vector<const Scatterer*> chosen_;
};

/// Phase function [1/sr] at a cosine between the directions before and behind.
double phase_function(const ScatteringSpec& spec, double cosine);
/// A cosine drawn from it by a uniform number.
double draw_cosine(const ScatteringSpec& spec, double u);

}  // namespace plenoflame
