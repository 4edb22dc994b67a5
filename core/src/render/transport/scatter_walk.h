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

/// Seed of the sequences of scattered light, which differ from those of the rays.
inline constexpr std::uint64_t kScatterSeed = 0x73636174u;

/// Shared data of all walks in a scene; immutable.
struct ScatterPlan {
  /// @param light on the scene's surfaces, kept by reference; nullptr: no surfaces
  /// @throws InputError when the medium does not know its largest absorption
  ScatterPlan(const CompiledScene& compiled, const RenderSettings& settings,
              const Execution& execution, const SurfaceLightPlan* light = nullptr);

  const CompiledScene* scene;
  const SurfaceLightPlan* surface_light;
  MediumOptions options;
  MajorantGrid majorants;  ///< majorants of the extinction
  int reflections;         ///< largest number of reflections on surfaces
  /// Draws points of the flames for their light; nullptr: the flames are dark.
  const EmissionProposal* flame = nullptr;
  std::unique_ptr<const EmissionProposal> own_flame;

  const SurfaceScene* surfaces() const { return scene->surfaces.get(); }
};

/// Returns nullptr for a scene that does not scatter. @param light kept by reference; may be
/// nullptr
std::unique_ptr<const ScatterPlan> make_scatter_plan(const CompiledScene& scene,
                                                     const RenderSettings& settings,
                                                     const Execution& execution,
                                                     const SurfaceLightPlan* light);

/// The plans of the light that rays of one spectral path collect besides the flames' own.
struct PathLight {
  PathLight() = default;  ///< none
  PathLight(const CompiledScene& path, const RenderSettings& settings, const Execution& execution)
      : surfaces(make_surface_light(path, settings, execution)),
        scatter(make_scatter_plan(path, settings, execution, surfaces.get())) {}

  std::unique_ptr<const SurfaceLightPlan> surfaces;  ///< nullptr: no surfaces, no surroundings
  std::unique_ptr<const ScatterPlan> scatter;        ///< nullptr: nothing scatters
};

/// Light that media scatter into rays and that surfaces reflect through them. Random walks run
/// backwards along the light. Delta tracking draws places of scattering (Woodcock et al., ANL-7050,
/// 1965). The phase function or the cosine gives directions.
///
/// Each place samples point and parallel lights, points of emitting surfaces and points of the
/// flames. The next direction of the walk finds emitters and flames, too. Both samples share their
/// light by the balance heuristic (Veach and Guibas, SIGGRAPH 95). All emission along a line
/// counts; the medium integrates it without random numbers. The estimate is unbiased. Walks end by
/// Russian roulette, or at the last reflection on a surface that the scene allows.
///
/// If extinction depends on the wavelength, each walk has a hero wavelength at an evenly drawn
/// node. It counts at all nodes. Its density is the mean of the densities with which all nodes
/// would have drawn it (Wilkie et al., Hero Wavelength Spectral Sampling, EGSR 2014). Weights
/// therefore stay below the number of nodes for any differences between them. One object per
/// worker.
class ScatterWalk {
 public:
  explicit ScatterWalk(const ScatterPlan& plan);

  /// A ray, followed from its entry into the medium.
  struct Start {
    int ray = 0;  ///< number in `radiance`
    Ray line;     ///< world, away from the camera
    std::uint64_t key = 0;
    double far = kInfinity;  ///< [m] its end, at a surface whose light is not added
    /// Share of the rays whose first place is drawn evenly over the media that scatter. It is large
    /// in thin media. 0: the extinction draws all places.
    double even = 0;
    double near = -kInfinity;  ///< [m] its begin
  };
  /// Adds to radiance[node][ray] the light that is scattered into the rays inside of the medium.
  void add(const std::vector<Start>& starts, std::vector<std::vector<double>>& radiance,
           MediumCounters& counters);
  /// Adds the light that surfaces send back at the ends of the camera's rays; replaces
  /// SurfaceLight::add.
  void add_surfaces(const std::vector<SurfacePath>& paths,
                    const std::vector<SurfaceLight::First>& first,
                    std::vector<std::vector<double>>& radiance, MediumCounters& counters);

  double rays() const { return rays_; }  ///< intersected with surfaces so far

 private:
  using Radiance = std::vector<std::vector<double>>;
  /// A walk at a place of scattering or reflection, or on its way to the next one.
  struct Walk {
    Walk(int number, const Ray& along, std::uint64_t key, std::size_t nodes)
        : ray(number), line(along), noise(key, 0), weight(nodes, 1.0), density_share(nodes, 1.0) {}
    int ray;
    Ray line;  ///< from the place on; at the place, with its old direction
    NoiseStream noise;
    std::size_t driver = 0;             ///< node of the hero wavelength
    std::vector<double> weight;         ///< per node
    std::vector<double> density_share;  ///< per node: density with it as hero, over their mean
    const Scatterer* scatterer = nullptr;
    SurfacePart from;  ///< surface of the place, if there is no scatterer
    Vec3 normal;
    int reflections = 0;                         ///< so far
    const SurfaceLight::First* first = nullptr;  ///< random numbers for the place
    double end = 0;                              ///< [m] length of the line
    SurfaceHit next;                             ///< hit at the end; none: next.where.surface < 0
    std::vector<double> passed = {};             ///< transmittance of the whole line, unless grey

    /// Density [1/sr] with which a direction is drawn. It is also the direction's share of the
    /// light.
    double density(Vec3 way) const;
    /// Continues in a way that the hero wavelength of node c would have drawn with the density
    /// `drawn[c]`.
    /// @param light share of the light that is kept, per node
    void weigh(const double* light, const double* drawn);
  };
  /// The coefficients at a place, per node.
  struct Place {
    const Scatterer* scatterer = nullptr;  ///< nullptr: the walk ends
    double *scattering, *extinction;       ///< [1/m] of the scatterer; of all media
    /// Probability that a walk with this node as hero wavelength continues with the scatterer.
    double* choice;
  };
  struct Sample {
    std::size_t walk;
    double weight;
    const double* strength;  ///< per node, of lights and emitters
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
  std::vector<double> place_;  ///< the results of scatter()
  std::vector<Sample> samples_;
  double rays_ = 0;
};

}  // namespace plenoflame
