#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "plenoflame/render/render.h"
#include "render/transport/emission_proposal.h"
#include "render/transport/medium_segments.h"

namespace plenoflame {

/// The end of a ray from the camera, and the share with which its light counts.
struct SurfacePath {
  int ray = 0;  ///< number of the camera's ray
  SurfaceHit hit;
  double throughput = 1;            ///< of reflections and, when they are grey, media on the way
  std::uint64_t key = 0;            ///< of its random numbers
  std::vector<double> passed = {};  ///< per channel through media that are not grey; empty: all
  /// Density per solid angle with which the last direction was drawn [1/sr], and the cosine at
  /// which it met the surface; density 0: the camera's ray.
  double density = 0, cosine = 0;

  double share(std::size_t channel) const {
    return passed.empty() ? throughput : throughput * passed[channel];
  }
};

/// Everything about the light on surfaces that is the same for all rays; immutable.
struct SurfaceLightPlan {
  SurfaceLightPlan(const CompiledScene& compiled, const RenderSettings& settings,
                   const Execution& execution);

  void add_emitters();

  const CompiledScene* scene;
  int channels = 1;
  int reflections = 1;
  MediumOptions options;
  bool emitters = false;  ///< some surface emits
  /// Emitting surfaces with an end, whose points are drawn by area.
  struct Emitter {
    int surface = 0;
    double share = 0;  ///< of the drawn points, this and all before it
  };
  std::vector<Emitter> emitting;
  std::vector<double> area_density;  ///< [1/m^2] of drawn points, by surface; 0: none are drawn
  /// Draws the flames' light; nullptr: they do not light surfaces.
  std::unique_ptr<EmissionProposal> flame;
  /// Light that leaves a surface is followed on even after the last reflection: it may come from an
  /// emitter or from the surroundings.
  bool follow_last = false;
  bool scatters = false;  ///< some of the light is scattered on its way: see ScatterWalk
  /// Tells whether the light of a path needs random numbers.
  bool random() const { return flame || follow_last || scatters || reflections > 1; }
  /// The density of a direction in which an emitting surface lies [1/sr].
  double emitter_density(int surface, double distance, double cosine) const {
    const double per_area = area_density[static_cast<std::size_t>(surface)];
    return per_area > 0 ? per_area * distance * distance / cosine : 0;
  }
};

/// nullptr for a scene with neither surfaces nor surroundings.
std::unique_ptr<const SurfaceLightPlan> make_surface_light(const CompiledScene& scene,
                                                           const RenderSettings& settings,
                                                           const Execution& execution);

/// Radiance that surfaces send towards the camera, by path tracing: point, parallel and flame light
/// and emitting surfaces are sampled directly at each reflection; surroundings are found by the
/// rays that go on, drawn in proportion to the cosine. These may find emitters, too: both ways
/// share their light by the balance heuristic (Veach and Guibas, SIGGRAPH 95). One per worker.
class SurfaceLight {
 public:
  explicit SurfaceLight(const SurfaceLightPlan& plan);

  /// Uniform numbers in (0, 1) for the first reflection of a path: [0, 1] for the direction it goes
  /// on in, [2, 3] for the flame, or, without one, for the point of an emitting surface.
  struct First {
    double u[4];
  };
  /// Adds the radiance of every path, at its hit, to radiance[c][path.ray] (before the medium
  /// between camera and hit). @param first one per path, used when plan.random()
  void add(std::vector<SurfacePath>& paths, const std::vector<First>& first,
           std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  double rays() const { return rays_; }  ///< traced so far, those to lights included

 private:
  void add_emission(const std::vector<SurfacePath>& paths,
                    std::vector<std::vector<double>>& radiance) const;
  void add_delta_lights(const std::vector<SurfacePath>& paths,
                        std::vector<std::vector<double>>& radiance, MediumCounters& counters);
  void add_flame(const std::vector<SurfacePath>& paths, const std::vector<First>& random, int depth,
                 std::vector<std::vector<double>>& radiance, MediumCounters& counters);
  void add_emitters(const std::vector<SurfacePath>& paths, const std::vector<First>& random,
                    int depth, std::vector<std::vector<double>>& radiance,
                    MediumCounters& counters);
  void go_on(std::vector<SurfacePath>& paths, const std::vector<First>& random,
             std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  struct Sample {
    int ray;
    std::size_t path;
    double weight;      ///< without what the path has passed
    std::size_t light;  ///< of the delta lights; of the surfaces, for emitters
  };
  const SurfaceLightPlan& plan_;
  MediumSegments segments_;
  std::vector<Sample> samples_;
  std::vector<SurfacePath> next_;
  std::vector<First> random_;
  double rays_ = 0;
};

}  // namespace plenoflame
