#pragma once
#include <vector>

#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/emission_operator.h"

namespace plenoflame {

/// Draws the rays and makes the stored matrix of reconstructions together with other ranks, each of
/// which is in serve_assembly(). Free ranks take the next piece of pictures or rows. The bits are
/// those of draw_camera_rays() and make_emission_matrix(), for any number of ranks and threads.
/// Rank 0 keeps rays and matrix, and solves by itself.
class SharedAssembly {
 public:
  /// The other ranks are on their way to serve_assembly(), with the same cameras and unknowns.
  explicit SharedAssembly(Communicator& ranks);
  /// The others leave serve_assembly().
  ~SharedAssembly();
  SharedAssembly(const SharedAssembly&) = delete;
  SharedAssembly& operator=(const SharedAssembly&) = delete;

  /// @throws as draw_camera_rays(); Error with what another rank says is wrong
  CameraRays rays(const std::vector<CameraView>& views, const Box& box,
                  const CameraRaySettings& settings, const Execution& execution);
  /// @throws as make_emission_matrix(); Error with what another rank says is wrong
  CsrMatrix<float> matrix(const EmissionProblem& problem, const Execution& execution);

 private:
  struct Work;
  void share(const Work& work, const Execution& execution);
  bool take(const Work& work);

  Communicator& ranks_;
  std::vector<int> out_;     ///< pieces that each rank has and has not answered
  std::vector<char> ready_;  ///< ranks that have their cameras
};

/// rays_of_form(), by all ranks where there is an assembly and rays are kept. @param assembly
/// nullptr: none
CameraRays rays_by(SharedAssembly* assembly, OperatorForm form,
                   const std::vector<CameraView>& views, const Box& box,
                   const CameraRaySettings& settings, const Execution& execution);

/// The part of a rank above 0, until rank 0 is done.
/// @param views compiled from the scenes of rank 0, in its order @param unknowns as those of rank 0
/// @return false when rank_message::kQuit came
bool serve_assembly(const std::vector<CameraView>& views, const Unknowns& unknowns,
                    Communicator& ranks, const Execution& execution);

}  // namespace plenoflame
