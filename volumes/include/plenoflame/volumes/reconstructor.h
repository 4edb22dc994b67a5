#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plenoflame/base/report.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/inverse/refine.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/volumes/reconstruct_request.h"
#include "plenoflame/volumes/reconstruct_result.h"

/// Reconstructions from pictures in memory: one at once, or frame after frame.
namespace plenoflame {

/// A camera whose pictures are reconstructed from.
struct ReconstructCamera {
  std::shared_ptr<const CompiledScene> scene;
  std::string what;  ///< of the scene, and of its camera where that has a name: for messages
};

/// The cameras of a reconstruction, compiled once for all frames.
struct ReconstructCameras {
  std::vector<ReconstructCamera> cameras;
  std::vector<std::size_t> channels;  ///< numbers in the scenes of what is reconstructed
  std::uint64_t seed = 1;             ///< of the rays

  const CompiledScene& first() const { return *cameras.front().scene; }
  std::string channel_name(std::size_t k) const { return first().scene.channels[channels[k]].name; }
  std::vector<CameraView> views() const;
};

/// Finds the channels in the scenes of the cameras.
/// @param first picture of the first camera @param names of the pictures of each camera
/// @throws InputError, UsageError
ReconstructCameras reconstruct_cameras(const ReconstructRequest& request,
                                       std::vector<ReconstructCamera> cameras,
                                       const LightField& first,
                                       const std::vector<std::string>& names);

/// Measurements of one frame: of each channel, of each camera.
using FrameMeasurements = std::vector<std::vector<Measurement>>;

/// @param names of the pictures, one for each camera as they are
/// @throws InputError as take_measurement()
FrameMeasurements measure_frame(const ReconstructRequest& request,
                                const ReconstructCameras& cameras,
                                const std::vector<LightField>& pictures,
                                const std::vector<std::string>& names);

/// Warns of pixels that are left out.
void warn_of_pictures(const FrameMeasurements& measurements, const std::vector<std::string>& names,
                      const Execution& execution);

/// A reconstruction of one frame after the other.
class Reconstructor {
 public:
  /// @param cameras must outlive it
  /// @param first frame, to which the axis of rings is fitted on request
  /// @throws InputError, UsageError, FileError: earlier results and supports that cannot be read or
  ///         do not fit
  Reconstructor(const ReconstructRequest& request, const ReconstructCameras& cameras,
                const FrameMeasurements& first, const Execution& execution);

  const Unknowns& unknowns() const { return *unknowns_; }
  /// The settings of the unknowns, with the axis that was fitted.
  const UnknownsRequest& unknowns_request() const { return request_.unknowns; }
  /// Lets other processes take part in frames. @param assembly must outlive them
  void share(SharedAssembly& assembly) { settings_.assembly = &assembly; }
  /// The scene's flames at the unknowns, if the request has the truth.
  const FlameTruth* truth() const { return truth_ ? &*truth_ : nullptr; }

  /// Begins where the frame before ended, with the first frame's strength. The first frame refines
  /// the cameras for all.
  /// @param watch may be empty @throws as reconstruct() and reconstruct_thermal()
  ReconstructResult frame(const FrameMeasurements& measurements, const Execution& execution,
                          const std::function<void(const ReconstructionState&)>& watch = {});

  /// The corrected cameras. They are those that were given before the first frame, and if nothing
  /// is wrong.
  std::vector<CameraSpec> camera_specs() const;

  /// The figures of a frame; warns of what they say against it. @param output name of the file
  /// where it is written; empty: none
  Report report(const ReconstructResult& result, const std::string& output,
                const Execution& execution) const;

 private:
  std::vector<double> samples_of(std::vector<double> emission,
                                 const std::vector<double>& absorption) const;
  std::vector<CameraView> views() const;
  ReconstructionInput linear_input(const FrameMeasurements& measurements) const;
  void refine(const FrameMeasurements& measurements, const Execution& execution);
  ReconstructResult linear(const FrameMeasurements& measurements, const Execution& execution);
  ReconstructResult thermal(const FrameMeasurements& measurements, const Execution& execution);
  void test_thermal(const FrameMeasurements& measurements, double strength,
                    const Execution& execution, ReconstructResult& result) const;
  std::vector<std::vector<ThermalPart>> parts_of_stop(std::size_t channel) const;

  ReconstructRequest request_;
  const ReconstructCameras& cameras_;
  std::unique_ptr<Unknowns> unknowns_;
  ReconstructionSettings settings_;
  std::vector<double> absorption_, start_, prior_, start_temperature_, start_absorption_,
      start_emission_;
  std::vector<char> support_;
  std::optional<FlameTruth> truth_;
  std::optional<Refinement> refinement_;  ///< of the first frame; empty: nothing is refined
};

/// A camera with its picture.
struct CameraPicture {
  std::shared_ptr<const CompiledScene> scene;
  LightField picture;
  std::string camera = "the scene", name = "the picture";  ///< for messages
};

/// Names a camera in messages. @param name may be empty
std::string camera_text(const std::string& name);

/// A reconstruction from one picture of each camera, with all that is known of it.
struct FlameReconstruction {
  ReconstructCameras cameras;
  std::unique_ptr<Reconstructor> reconstructor;
  ReconstructResult result;
  Report report;

  const Unknowns& unknowns() const { return reconstructor->unknowns(); }
};

/// Called with each state of a reconstruction, by the thread that reconstructs.
using ReconstructWatch = std::function<void(const ReconstructionState&, const Unknowns&)>;

/// @param watch may be empty @throws as Reconstructor
std::unique_ptr<const FlameReconstruction> reconstruct_flame(const ReconstructRequest& request,
                                                             std::vector<CameraPicture> pictures,
                                                             const Execution& execution = {},
                                                             const ReconstructWatch& watch = {});

}  // namespace plenoflame
