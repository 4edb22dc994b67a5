#include "inverse/row_results.h"

#include <algorithm>
#include <cstdio>
#include <string>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

std::string megabytes(double bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f MB", bytes < 1e7 ? 2 : 0, 1e-6 * bytes);
  return text;
}

}  // namespace

bool must_be_stored(const ReconstructionSettings& settings) {
  return settings.form == OperatorForm::matrix || wants_matrix(settings.solver);
}

bool may_be_stored(const ReconstructionSettings& settings) {
  return settings.form == OperatorForm::automatic || settings.form == OperatorForm::matrix;
}

bool is_stored(const ReconstructionSettings& settings, double matrix_bytes, bool at_least) {
  const bool stored = may_be_stored(settings) && matrix_bytes <= settings.memory;
  const bool wanted = wants_matrix(settings.solver);
  if (stored || !must_be_stored(settings)) return stored;
  throw InputError(
      std::string(wanted
                      ? "this solver goes through the rows of the stored matrix, which would take "
                      : "the stored matrix would take ") +
      (at_least ? "at least " : "") + megabytes(matrix_bytes) + " of the " +
      megabytes(settings.memory) + " that it may: give it more, take larger blocks of pixels, or " +
      (wanted ? "another solver, which follows the rays again"
              : "the form 'rays' or 'drawn', which follows the rays again"));
}

void count_left_out(std::span<const double> weights, Reconstruction& result) {
  result.left_out = static_cast<std::size_t>(std::count(weights.begin(), weights.end(), 0.0));
  if (result.left_out == weights.size())
    throw InputError("every pixel that sees the grid is saturated or otherwise left out");
}

void add_row_pictures(const std::vector<Measurement>& measurements, const CameraRays& rays,
                      std::span<const double> flux, std::span<const double> explained,
                      std::span<const double> weights, Reconstruction& result) {
  const std::size_t first = result.explained.size();
  for (const Measurement& measurement : measurements) {
    result.explained.emplace_back(measurement.window.width, measurement.window.height);
    result.residual.emplace_back(measurement.window.width, measurement.window.height);
  }
  for (std::size_t i = 0; i < rays.rows.size(); ++i) {
    const auto v = static_cast<std::size_t>(rays.rows[i].view);
    const PixelWindow& window = measurements[v].window;
    const int column = rays.rows[i].column - window.x, row = rays.rows[i].row - window.y;
    result.explained[first + v].at(column, row) = static_cast<float>(explained[i]);
    if (weights[i] > 0)
      result.residual[first + v].at(column, row) = static_cast<float>(flux[i] - explained[i]);
  }
}

}  // namespace plenoflame
