#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "media/voxels/majorant_grid.h"
#include "plenoflame/math/ray_span.h"
#include "plenoflame/render/render.h"
#include "plenoflame/sampling/noise.h"
#include "render/transport/emission_proposal.h"
#include "render/transport/medium_segments.h"
#include "render/transport/surface_light.h"

namespace plenoflame {

/// Sequences of scattered light are apart from what the rays use.
inline constexpr std::uint64_t kScatterSeed = 0x73636174u;

/// Data that all walks of a scene share; immutable.
struct ScatterPlan {
  /// @param light on the scene's surfaces, kept; nullptr: there are none
  /// @throws InputError when the medium does not know its largest absorption
  ScatterPlan(const CompiledScene& compiled, const RenderSettings& settings,
              const Execution& execution, const SurfaceLightPlan* light = nullptr);

  const CompiledScene* scene;
  const SurfaceLightPlan* surface_light;
  MediumOptions options;
  MajorantGrid majorants;  ///< of the extinction
  int reflections;         ///< on surfaces, at most
  /// Draws the flames' light; nullptr: they are dark.
  const EmissionProposal* flame = nullptr;
  std::unique_ptr<const EmissionProposal> own_flame;

  const SurfaceScene* surfaces() const { return scene->surfaces.get(); }
};

/// nullptr for a scene that does not scatter. @param light kept; may be nullptr
std::unique_ptr<const ScatterPlan> make_scatter_plan(const CompiledScene& scene,
                                                     const RenderSettings& settings,
                                                     const Execution& execution,
                                                     const SurfaceLightPlan* light);

/// Light that media scatter into rays and surfaces reflect through them: random walks backwards
/// along the light. Places of scattering are drawn by delta tracking (Woodcock et al., ANL-7050,
/// 1965), directions by the phase function or the cosine. From each place point and parallel
/// lights, points of emitting surfaces and of the flames are looked at; the direction in which the
/// walk goes on finds emitters and flames, too, and both ways share their light by the balance
/// heuristic (Veach and Guibas, SIGGRAPH 95). All emission along a line counts, integrated by the
/// medium without random numbers. Unbiased; walks end by Russian roulette, or at the last
/// reflection on a surface that the scene allows.
/// If extinction depends on the wavelength, each walk is driven by one node, drawn evenly, and
/// counts at all of them with the mean of the densities that all nodes would have drawn it with
/// (Wilkie et al., Hero Wavelength Spectral Sampling, EGSR 2014): weights stay below the number of
/// nodes however different these are. One per worker.
class ScatterWalk {
 public:
  explicit ScatterWalk(const ScatterPlan& plan);

  /// A ray, followed from where it enters the medium.
  struct Start {
    int ray = 0;  ///< number in `radiance`
    Ray line;     ///< world, away from the camera
    std::uint64_t key = 0;
    double far = kInfinity;  ///< [m] where it ends, at a surface: what that sends is not added
    /// Share of the rays whose first place is drawn evenly over the media that scatter: much
    /// where these are thin. 0: all places are drawn by the extinction.
    double even = 0;
  };
  /// Adds to radiance[node][ray] what is scattered into the rays before they leave the medium.
  void add(const std::vector<Start>& starts, std::vector<std::vector<double>>& radiance,
           MediumCounters& counters);
  /// Adds what surfaces send back where the camera's rays end: in place of SurfaceLight::add.
  void add_surfaces(const std::vector<SurfacePath>& paths,
                    const std::vector<SurfaceLight::First>& first,
                    std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  double rays() const { return rays_; }  ///< met with surfaces so far

 private:
  using Radiance = std::vector<std::vector<double>>;
  /// At a place where light is scattered or reflected, or on its way to the next one.
  struct Walk {
    Walk(int number, const Ray& along, std::uint64_t key, std::size_t nodes)
        : ray(number), line(along), noise(key, 0), weight(nodes, 1.0), density_share(nodes, 1.0) {}
    int ray;
    Ray line;  ///< from the place on; at the place, the direction in which it was reached
    NoiseStream noise;
    std::size_t driver = 0;             ///< node whose extinction its places are drawn by
    std::vector<double> weight;         ///< per node
    std::vector<double> density_share;  ///< per node: had it been the driver, over their mean
    const Scatterer* scatterer = nullptr;
    SurfacePart from;  ///< the place is on a surface when there is no scatterer
    Vec3 normal;
    int reflections = 0;                         ///< so far
    const SurfaceLight::First* first = nullptr;  ///< numbers for the place
    double end = 0;                              ///< [m] of the line
    SurfaceHit next;                             ///< there; none: next.where.surface < 0
    std::vector<double> passed = {};             ///< transmittance of the whole line, unless grey

    /// Density [1/sr] with which a direction is drawn, and the share that it has in the light.
    double density(Vec3 way) const;
    /// Goes on in a way that a node as the driver would have drawn with a density `drawn` per node.
    /// @param light what of the light is kept, per node
    void weigh(const double* light, const double* drawn);
  };
  /// The fate of light at a place, per node.
  struct Place {
    const Scatterer* scatterer = nullptr;  ///< nullptr: the walk ends
    double *scattering, *extinction;       ///< [1/m] of the scatterer; of everything
    double* choice;  ///< probability that a walk of this driver goes on with the scatterer
  };
  struct Sample {
    std::size_t walk;
    double weight;
    const double* strength;  ///< per node; of lights and emitters
  };

  RaySpan scattering_span(const Ray& line, double from, double to) const;
  void follow(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void begin(const std::vector<Start>& starts, std::vector<Walk>& walks, MediumCounters& counters);
  void draw_driver(Walk& walk) const;
  bool collide(Walk& walk, double& t);
  Place scatter(Walk& walk, Vec3 place);
  bool reflect(Walk& walk, const SurfaceHit& hit) const;
  void aim(Walk& walk, Vec3 direction);
  void move_on(std::vector<Walk>& walks, MediumCounters& counters);
  void visit(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void add_delta_lights(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void add_emitters(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void add_samples(const std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void add_flame(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  void go_on(std::vector<Walk>& walks, Radiance& radiance, MediumCounters& counters);
  bool sees_flame(const Walk& walk) const;

  const ScatterPlan& plan_;
  const CompiledScene& scene_;
  const Medium& medium_;
  Box bounds_;
  std::size_t nodes_;
  MediumSegments segments_;
  std::vector<double> coefficients_, shares_;
  std::vector<double> place_;  ///< what scatter() found
  std::vector<Sample> samples_;
  double rays_ = 0;
};

}  // namespace plenoflame
