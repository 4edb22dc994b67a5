#pragma once
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "media/voxels/majorant_grid.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/render.h"
#include "render/forward/forward_chunk.h"
#include "render/forward/forward_pixels.h"
#include "render/transport/camera_aim.h"
#include "render/transport/emission_proposal.h"
#include "render/transport/medium_segments.h"
#include "render/visibility/aperture_cone.h"
#include "render/visibility/endless_planes.h"

namespace plenoflame {

/// Bundles of a scene with surfaces, lights or media that scatter. A bundle leaves a flame, a light
/// or a hot surface, either towards the camera or to light the scene. In the second case surfaces
/// reflect it and media scatter it. At each of these places its part towards the camera's aperture
/// is traced.
class SurfaceBundles : public BundleSource {
 public:
  static constexpr std::size_t kMostWaiting = 100'000;
  /// @param proposal emission of the flames; nullptr: no flames, or dark ones
  /// @param stop may end a chunk of a scene that scatters early
  /// @param most_waiting approximate number of arrivals in such scenes that wait to be added to the
  /// chunk
  SurfaceBundles(const CompiledScene& scene, const RenderSettings& settings, const Film& film,
                 const EmissionProposal* proposal, std::stop_token stop = {},
                 std::size_t most_waiting = kMostWaiting);

  bool dark() const { return jobs_.empty(); }
  void trace(std::int64_t first, std::int64_t end, ForwardChunk& chunk) const override;

 private:
  enum class Origin { flame, delta_light, environment, surface };
  /// A task of a bundle; all have the same probability.
  struct Job {
    Origin origin;
    int index;       ///< of the light or surface
    bool to_camera;  ///< true: to the camera; false: to light the scene
  };
  struct Bundle {
    std::int64_t index = 0;
    Ray ray;  ///< its current path
    SurfacePart from;
    Vec3 normal;  ///< at a surface that it leaves
    double reflectivity = 0;
    /// The scatterer that it leaves; the ray still has the old direction.
    const Scatterer* scatterer = nullptr;
    int reflections = 0;     ///< by surfaces so far; in scenes that scatter
    std::size_t driver = 0;  ///< node of its hero wavelength in media
    bool lights_surfaces = true;
    /// Times spectrum: flux [W], per steradian if it leaves for the camera.
    double weight = 0;
    std::size_t spectrum = 0;  ///< index in Work::spectra
  };
  /// A bundle that arrived on a pixel.
  struct Arrived {
    int column, row, replicate;
    double weight;
    std::size_t spectrum;
    int pupil_part;               ///< part of the stop that it passed
    std::size_t first_way, ways;  ///< in Work::ways: one, or one per stretch between windows
  };
  struct Work;

  void add_jobs(const EmissionProposal* proposal);
  bool start(std::int64_t index, const Job& job, Bundle& bundle, Work& work) const;
  bool start_at_flame(const Job& job, Bundle& bundle, Work& work) const;
  double line_density(const Ray& line, bool any_direction) const;
  void start_before(Ray& line) const;
  bool can_reflect() const;
  bool start_at_light(const Job& job, Bundle& bundle, Work& work) const;
  bool start_in_surroundings(const Job& job, Bundle& bundle, Work& work) const;
  bool start_at_surface(const Job& job, Bundle& bundle, Work& work) const;
  bool send_on(std::optional<std::size_t> plane, double u, double v, std::uint64_t block,
               Bundle& bundle) const;
  void reflect(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const;
  bool scatter(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const;
  void make_room(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const;
  void meet_places(std::vector<Bundle>& bundles, std::uint64_t step, Work& work,
                   ForwardChunk& chunk) const;
  void meet_surfaces(std::vector<Bundle>& bundles, Work& work, ForwardChunk& chunk) const;
  /// @param factor share of the weight that leaves per solid angle [1/sr], without the cosine or
  /// phase function
  void send_to_camera(const Bundle& bundle, bool has_normal, double factor, std::uint64_t block,
                      Work& work, ForwardChunk& chunk) const;
  bool find_way(const Ray& ray, SurfacePart from, double& passed, Work& work) const;
  void deposit(Work& work, ForwardChunk& chunk) const;
  double number(std::int64_t bundle, std::uint64_t block, std::size_t word) const;

  const CompiledScene& scene_;
  const RenderSettings& settings_;
  const EmissionProposal* proposal_;
  std::stop_token stop_;
  std::size_t most_waiting_;
  ForwardPixels pixels_;
  ApertureCone cone_;
  RigidTransform to_camera_;
  MediumOptions options_;
  std::vector<Job> jobs_;
  Vec3 centre_;        ///< of a sphere around everything that surroundings may light
  double radius_ = 0;  ///< [m]
  std::unique_ptr<EndlessPlanes> endless_;
  std::unique_ptr<const MajorantGrid> majorants_;  ///< nullptr: nothing scatters
  std::unique_ptr<const CameraAim> aim_;
  double field_versine_ = 0;  ///< 1 - cos of the largest angle of the field
};

}  // namespace plenoflame
