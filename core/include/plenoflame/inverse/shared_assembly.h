#pragma once
#include <memory>
#include <vector>

#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/emission_operator.h"

namespace plenoflame {

/// The rays and the stored matrix of reconstructions, shared with other ranks, each of which is in
/// serve_assembly(). A rank draws the rays of consecutive rows, makes these rows, keeps them, and
/// multiplies with them. The ranks have about equal numbers of rays. All results have the bits of
/// one process, for any number of ranks and threads. There is one matrix at a time.
class SharedAssembly {
 public:
  /// The other ranks are on their way to serve_assembly(), with the same cameras and unknowns.
  explicit SharedAssembly(Communicator& ranks) : ranks_(ranks), largest_(1.0 / ranks.size()) {}
  /// The others leave serve_assembly().
  ~SharedAssembly();
  SharedAssembly(const SharedAssembly&) = delete;
  SharedAssembly& operator=(const SharedAssembly&) = delete;

  /// Tells if each rank gets rows. Cells of micro-images are shared out by cameras.
  bool can_share(std::size_t cameras, const CameraRaySettings& settings) const;
  /// [byte] of the parts of a matrix on this machine, at most, and of the vectors on their way.
  /// @param bytes of the whole matrix
  double memory(double bytes, std::size_t columns) const;
  /// The rows of all ranks. Each keeps the rays of its own until the matrix is made, or draws them
  /// twice, where their memory is too large by the form. Here they are drawn again (RaySource).
  /// @throws as rays_of_form(); Error with what another rank says is wrong
  CameraRays rays(const std::vector<CameraView>& views, const Box& box, OperatorForm form,
                  const CameraRaySettings& settings, const Execution& execution);
  /// Tells what rows are. Returns estimated_entries().
  std::size_t entries(const EmissionProblem& problem);
  /// The matrix as an operator, as make_csr_operator(). Its products do not end early, and throw
  /// Error with what another rank says is wrong. Its end is forget().
  /// @param problem that of entries(), with these rays @param bytes of the whole matrix, estimated
  /// @throws InputError: a rank has no memory for its rows; Error as the products; Cancelled
  std::unique_ptr<LinearOperator> matrix(const EmissionProblem& problem, double bytes,
                                         const Execution& execution);
  /// Gives back all memory, and ends what ranks are at.
  void forget();

 private:
  class Matrix;

  Communicator& ranks_;
  double largest_;  ///< share of a rank, about
  int epoch_ = 0;   ///< raised by forget(): answers of earlier ones do not count
  CameraRays own_;
  std::vector<std::size_t> first_;  ///< row of each rank; then the number of rows
};

/// The part of a rank above 0, until rank 0 is done.
/// @param views compiled from the scenes of rank 0, in its order @param unknowns as those of rank 0
/// @return false when rank_message::kQuit came
bool serve_assembly(const std::vector<CameraView>& views, const Unknowns& unknowns,
                    Communicator& ranks, const Execution& execution);

}  // namespace plenoflame
