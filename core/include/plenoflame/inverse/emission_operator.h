#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/inverse/csr_matrix.h"
#include "plenoflame/inverse/linear_operator.h"
#include "plenoflame/inverse/unknowns.h"

namespace plenoflame {

/// The linear problem b = A x: x are samples of emission or of a source function, b fluxes of
/// pixels [W]. Row i is the sum over the rays of the pixel of etendue times the weight that each
/// sample has in the ray's radiance (docs/theory/reconstruction.md).
struct EmissionProblem {
  const CameraRays* rays = nullptr;
  const Unknowns* unknowns = nullptr;
  RowModel model = RowModel::emission;
  std::vector<double> absorption = {};  ///< [1/m] of each unknown; empty: none
};

/// Entries that the stored matrix will have, from a sample of its rows: at 8 byte each.
std::size_t estimated_entries(const EmissionProblem& problem);

/// The rows of that sample, and the number of entries of some rows.
std::vector<std::size_t> sampled_rows(const CameraRays& rays);
std::size_t entries_of_rows(const EmissionProblem& problem, std::span<const std::size_t> rows);

/// Lower bound of the number of entries, before rays are drawn. One ray per replicate finds the
/// rows, and a sample of them is drawn in full. Three standard errors are subtracted. 0 if drawing
/// all rays takes no longer.
/// @param problem without rays yet
/// @throws as draw_camera_rays()
double least_entries(const EmissionProblem& problem, const std::vector<CameraView>& views,
                     const CameraRaySettings& settings, const Execution& execution);

/// The matrix, row by row. The same for any number of threads. @throws Cancelled
CsrMatrix<float> make_emission_matrix(const EmissionProblem& problem, const Execution& execution);

/// The same operator without a matrix: it follows the rays again in each product. Everything that
/// `problem` points to must outlive it. The results of apply() and apply_transpose() do not depend
/// on the number of threads. Both throw Cancelled soon after a stop of `execution`, also within a
/// product.
std::unique_ptr<LinearOperator> make_emission_operator(const EmissionProblem& problem,
                                                       const Execution& execution);

/// The parts of A x that come from the rays of the first two replicates, for some thousand evenly
/// spread rows at most. Empty for rays of one replicate.
/// @throws Cancelled
std::vector<std::array<double, 2>> replicate_fluxes(const EmissionProblem& problem,
                                                    std::span<const double> x,
                                                    const Execution& execution);

}  // namespace plenoflame
