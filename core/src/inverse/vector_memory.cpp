#include <fmt/format.h>

#include <algorithm>

#include "inverse/operators/csr_parts.h"
#include "inverse/operators/followed_rows.h"
#include "inverse/operators/scaled_problem.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/reconstruction.h"

namespace plenoflame {
namespace {

/// Numbers for each variable with any solver: scales, known values, start, values and their
/// statistics.
constexpr double kCommon = 20;
/// Solutions that are kept while a strength is chosen: those of its range, and four between them.
constexpr double kMostStrengths = kLinearRange.points + 4;
/// The number of vectors that a solver holds: of variables, of rows of the penalty, of rows of A.
struct Work {
  double variables, penalty, rows;
};
constexpr Work kFista{7, 4, 6}, kKrylov{8, 4, 7}, kPlain{7, 0, 6};
/// The same of draws and probes, of which kTogether are solved at a time.
constexpr Work kDraws{28, 16, 16};

Work work_of(ReconstructionSolver solver) {
  if (!is_penalised(solver)) return kPlain;
  const bool krylov = solver == ReconstructionSolver::cgls || solver == ReconstructionSolver::lsqr;
  return krylov ? kKrylov : kFista;
}

/// Rows of the penalty for each variable.
double penalty_rows(const ReconstructionSettings& settings, const Unknowns& unknowns) {
  if (!is_penalised(settings.solver)) return 0;
  const auto shape = unknowns.shape();
  const auto axes = static_cast<double>(
      std::count_if(shape.begin(), shape.end(), [](int count) { return count > 1; }));
  return axes * (axes + 1) / 2;  // along each of them, and across each two
}

}  // namespace

double vector_memory(const ReconstructionSettings& settings, const Unknowns& unknowns,
                     std::size_t variables, std::size_t rows) {
  const bool chooses = is_penalised(settings.solver) && settings.strength < 0;
  Work work = work_of(settings.solver);
  if (chooses) work.variables += kMostStrengths;
  if (is_penalised(settings.solver) && (chooses || settings.draws + settings.probes > 0))
    work = {std::max(work.variables, kDraws.variables), kDraws.penalty, kDraws.rows};
  // A^T adds up parts of rows that are followed again, whose number is fixed, or of as many as
  // threads.
  const double sums = static_cast<double>(
      kTogether * std::min(kMostRowRanges, static_cast<std::size_t>(Execution{}.thread_count())));
  const double parts = settings.memory > 0 ? sums : kFollowedParts;
  const double for_variable =
      kCommon + work.variables + parts + work.penalty * penalty_rows(settings, unknowns);
  return sizeof(double) *
         (for_variable * static_cast<double>(variables) + work.rows * static_cast<double>(rows));
}

void require_vector_memory(const ReconstructionSettings& settings, const Unknowns& unknowns,
                           std::size_t variables, std::size_t rows, double more) {
  std::string what = fmt::format("the vectors of {} unknowns", unknowns.size());
  if (rows > 0) what += fmt::format(" and {} rows", rows);
  if (more > 0) what += " with their matrix";
  require_memory(
      vector_memory(settings, unknowns, variables, rows) + more, what,
      "take a coarser grid" + std::string(rows > 0 ? ", larger blocks of pixels" : "") +
          (more > 0 ? ", or allow no memory for the matrix, and rays are followed again" : ""));
}

}  // namespace plenoflame
