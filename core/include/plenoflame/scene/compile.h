#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/optics/window_set.h"
#include "plenoflame/radiometry/channel_mix.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/scene.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/scene/validate.h"
#include "plenoflame/solids/lights.h"
#include "plenoflame/solids/surface_scene.h"

namespace plenoflame {

struct CompiledScene;
/// Scenes that were compiled before. compile() reuses the parts that one of them has in common with
/// the new scene. A nullptr is ignored.
using EarlierScenes = std::vector<const CompiledScene*>;

/// Makes the medium of one flame, with its spectrum at the channels' wavelengths. Core itself knows
/// the closed-form kinds; flames in OpenVDB files come from plenoflame::volumes, whose loader the
/// caller passes in.
using MediumLoader = std::function<std::shared_ptr<const Medium>(
    const FlameSpec& flame, const std::string& scene_folder,
    const std::vector<SourceFunction>& channels, const Execution& execution)>;

/// A flame that scatters, in the medium's measure: its absorption is extinction.
struct Scatterer {
  const Medium* medium = nullptr;  ///< one of those that the scene's medium is made of
  ScatteringSpec spec;
  /// Share of its extinction that is scattering.
  double albedo(Vec3 world) const {
    return spec.grid.empty() ? spec.albedo : medium->albedo(world);
  }
};

/// A scene, ready to trace: immutable, may be shared by threads.
struct CompiledScene {
  Scene scene;
  Camera camera;
  PupilSampling pupils;
  std::shared_ptr<const Medium> medium;               ///< all flames; nullptr when there is none
  std::shared_ptr<const SurfaceScene> surfaces = {};  ///< nullptr when there are none
  Lights lights = {};
  /// Weighted sums that turn the channels of medium, surfaces and lights into the scene's.
  ChannelMix mix = {};
  std::vector<Scatterer> scatterers = {};  ///< empty: nothing scatters
  double spectral_error = 0;               ///< of representing a channel by a few wavelengths
  /// For a camera that disperses light, the scene of each wavelength, with its own camera, pupils
  /// and media. This scene is then that of the design wavelength. Read through paths().
  std::vector<CompiledScene> dispersed = {};
  /// Bodies that refract on the way of the camera's rays; nullptr when there are none.
  std::unique_ptr<const WindowSet> windows = {};
  /// Channel of the whole scene to which each channel of this path adds. Empty: the same.
  std::vector<int> film_channel = {};
  /// The sources from which media and surfaces were compiled, and each flame's own medium. Other
  /// scenes share them if they are equal.
  std::vector<SourceFunction> sources = {}, emitters = {};
  std::vector<std::shared_ptr<const Medium>> flames = {};
  std::vector<std::shared_ptr<const Medium>> loaded = {};  ///< these before FlameSpec::brightness
  /// With filters over parts of the stop, the mix of the rays through each of them
  /// (PupilFilters::part_at()); `mix` is their mean over the stop. Empty: `mix` holds for all.
  std::vector<ChannelMix> part_mixes = {};
  /// The spectral paths through the camera, at least one. The renderer uses these; a scene without
  /// dispersion is its own only path.
  std::span<const CompiledScene> paths() const {
    return dispersed.empty() ? std::span(this, 1) : std::span(dispersed);
  }
  std::span<CompiledScene> paths() {
    return dispersed.empty() ? std::span(this, 1) : std::span(dispersed);
  }
  int node_count() const {
    return mix.empty() ? static_cast<int>(scene.channels.size()) : mix.nodes();
  }
};

/// Loads flames of the kinds that core knows (layered). @throws InputError for other kinds, naming
/// what is missing in this build.
std::unique_ptr<Medium> load_core_medium(const FlameSpec& flame, const std::string& scene_folder,
                                         const std::vector<SourceFunction>& channels,
                                         const Execution& execution);

/// Validates the scene (see validate.h), solves the camera, traces its pupils, loads the flames and
/// checks their positions. Warnings go to execution.message, with their place in the scene file.
/// @param scene with one camera (cameras.h chooses it); a list of a single one is as good
/// @param positions of the scene's keys in its file, for messages
/// @param earlier scenes whose common parts are reused, not compiled again: the camera with its
///        pupils, each flame, the surfaces. Voxels are reused even if the flame's place, scale or
///        brightness differs. Traced results have the same bits either way. Files must not have
///        changed since
/// @param unsaid warnings that do not matter for the caller's use of the scene
/// @throws InputError, FileError
CompiledScene compile(const Scene& scene, const MediumLoader& loader = load_core_medium,
                      const Execution& execution = {}, const PositionMap& positions = {},
                      const EarlierScenes& earlier = {}, const std::vector<IssueCode>& unsaid = {});
/// Compiles the scene of a document, with its positions.
CompiledScene compile(const SceneDocument& document, const MediumLoader& loader = load_core_medium,
                      const Execution& execution = {}, const EarlierScenes& earlier = {},
                      const std::vector<IssueCode>& unsaid = {});

/// Replaces the flames by light of 1 W/(m^2 sr) from everywhere, as for a white picture.
void fill_with_light(CompiledScene& compiled);

}  // namespace plenoflame
