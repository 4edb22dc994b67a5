#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/pupil_sampling.h"
#include "plenoflame/media/medium.h"
#include "plenoflame/radiometry/channel_mix.h"
#include "plenoflame/radiometry/source_function.h"
#include "plenoflame/scene/scene.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/spectral.h"
#include "plenoflame/surfaces/lights.h"
#include "plenoflame/surfaces/surface_scene.h"

namespace plenoflame {

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
  std::shared_ptr<const Medium> medium;         ///< all flames; nullptr when there is none
  std::unique_ptr<SurfaceScene> surfaces = {};  ///< nullptr when there are none
  Lights lights = {};
  /// How the scene's channels add up from those of the medium, the surfaces and the lights.
  ChannelMix mix = {};
  std::vector<Scatterer> scatterers = {};  ///< empty: nothing scatters
  double spectral_error = 0;               ///< of standing for a channel by a few wavelengths
  /// Where the camera disperses light: what each wavelength sees, with a camera, pupils and media
  /// of its own. The estimators render these; the scene itself is as the design wavelength sees it.
  std::vector<CompiledScene> parts = {};
  /// Of a part: which channel of the whole scene each of its channels adds to. Empty: the same.
  std::vector<int> film_channel = {};
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
/// checks where they lie. Warnings go to execution.message, with their place in the scene file.
/// @param positions of the scene's keys in its file, for messages
/// @throws InputError, FileError
CompiledScene compile(const Scene& scene, const MediumLoader& loader = load_core_medium,
                      const Execution& execution = {}, const PositionMap& positions = {});

}  // namespace plenoflame
