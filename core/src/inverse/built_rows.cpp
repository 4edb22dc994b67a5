#include "inverse/built_rows.h"

#include <fmt/format.h>

#include "plenoflame/base/error.h"

namespace plenoflame {

void check_built(const ReconstructionInput& input, const ReconstructionSettings& settings) {
  const CameraRays& rays = *input.built.rays;
  const CsrMatrix<float>* const matrix = input.built.matrix;
  if (matrix && (matrix->rows() != rays.rows.size() || matrix->columns() != input.unknowns->size()))
    throw InputError(
        fmt::format("the operator has {} rows and {} unknowns, the reconstruction {} and {}",
                    matrix->rows(), matrix->columns(), rays.rows.size(), input.unknowns->size()));
  if (!matrix && wants_matrix(settings.solver))
    throw InputError("this solver goes through the rows of the matrix, which was not made");
  for (std::size_t r = 0; r < rays.rows.size(); ++r) {
    const auto view = static_cast<std::size_t>(rays.rows[r].view);
    if (view >= input.measurements.size())
      throw InputError("the operator has more cameras than there are pictures");
    const PixelWindow& window = input.measurements[view].window;
    rays.for_each_pixel(r, settings.rays.bin, [&](int column, int row) {
      if (column < window.x || row < window.y || column >= window.x + window.width ||
          row >= window.y + window.height)
        throw InputError("the operator has pixels that the picture does not hold");
    });
  }
}

}  // namespace plenoflame
