#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "plenoflame/render/render.h"
#include "render/transport/emission_proposal.h"
#include "render/transport/medium_segments.h"

namespace plenoflame {

/// The end of a ray from the camera, and the weight of its light.
struct SurfacePath {
  int ray = 0;  ///< number of the camera's ray
  SurfaceHit hit;
  double throughput = 1;            ///< of reflections, and of grey media on the way
  std::uint64_t key = 0;            ///< of its random numbers
  std::vector<double> passed = {};  ///< transmittance per channel of other media; empty: all 1
  /// Density per solid angle with which the last direction was drawn [1/sr], and its cosine at the
  /// surface. Density 0: the camera's ray.
  double density = 0, cosine = 0;

  double share(std::size_t channel) const {
    return passed.empty() ? throughput : throughput * passed[channel];
  }
};

/// Data about the light on surfaces that all rays share; immutable.
struct SurfaceLightPlan {
  SurfaceLightPlan(const CompiledScene& compiled, const RenderSettings& settings,
                   const Execution& execution);

  void add_emitters();

  const CompiledScene* scene;
  int channels = 1;
  int reflections = 1;
  MediumOptions options;
  bool emitters = false;  ///< some surface emits
  /// Finite emitting surfaces, whose points are drawn by area.
  struct Emitter {
    int surface = 0;
    double share = 0;  ///< of the drawn points, cumulative
  };
  std::vector<Emitter> emitting;
  std::vector<double> area_density;  ///< [1/m^2] of drawn points, by surface; 0: none
  /// Draws points of the flames for their light; nullptr: they do not light surfaces.
  std::unique_ptr<EmissionProposal> flame;
  /// Paths continue even after the last reflection, since an emitter or the surroundings may
  /// follow.
  bool follow_last = false;
  bool scatters = false;  ///< media scatter light on its way: see ScatterWalk
  /// Tells whether the light of a path needs random numbers.
  bool random() const { return flame || follow_last || scatters || reflections > 1; }
  /// The density of a direction towards a point of an emitting surface [1/sr].
  double emitter_density(int surface, double distance, double cosine) const {
    const double per_area = area_density[static_cast<std::size_t>(surface)];
    return per_area > 0 ? per_area * distance * distance / cosine : 0;
  }
};

/// Returns nullptr for a scene with neither surfaces nor surroundings.
std::unique_ptr<const SurfaceLightPlan> make_surface_light(const CompiledScene& scene,
                                                           const RenderSettings& settings,
                                                           const Execution& execution);

/// Radiance that surfaces send towards the camera, by path tracing. Each reflection directly
/// samples emitting surfaces and the light of points, parallel lights and flames. Continued rays,
/// drawn in proportion to the cosine, find the surroundings. They may find emitters, too. Both
/// samples share their light by the balance heuristic (Veach and Guibas, SIGGRAPH 95). One object
/// per worker.
class SurfaceLight {
 public:
  explicit SurfaceLight(const SurfaceLightPlan& plan);

  /// Uniform numbers in (0, 1) for the first reflection of a path. Numbers 0 and 1 give the next
  /// direction. Numbers 2 and 3 give the point of the flame or, without flames, the point of an
  /// emitting surface.
  struct First {
    double u[4];
  };
  /// Adds the radiance of every path, at its hit, to radiance[c][path.ray]. The medium between
  /// camera and hit is not included. @param first one per path, used when plan.random()
  void add(std::vector<SurfacePath>& paths, const std::vector<First>& first,
           std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  double rays() const { return rays_; }  ///< traced so far, including rays to lights

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
    double weight;      ///< without the transmittance of the path
    std::size_t light;  ///< index of the delta light or of the surface of an emitter
  };
  const SurfaceLightPlan& plan_;
  MediumSegments segments_;
  std::vector<Sample> samples_;
  std::vector<SurfacePath> next_;
  std::vector<First> random_;
  double rays_ = 0;
};

}  // namespace plenoflame
