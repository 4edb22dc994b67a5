#pragma once
#include <algorithm>
#include <cstddef>

#include "plenoflame/base/execution.h"
#include "plenoflame/inverse/csr_matrix.h"

namespace plenoflame {

/// Fewest entries for a thread. Starting and ending one takes about as long as multiplying by half
/// of them.
inline constexpr std::size_t kEntriesOfThread = std::size_t{1} << 19;

/// The threads of products with a matrix, which are the same for any number of them.
inline Execution worthwhile_threads(const CsrMatrix<float>& matrix, Execution execution) {
  execution.threads = static_cast<int>(std::clamp<std::size_t>(
      matrix.entries() / kEntriesOfThread, 1, static_cast<std::size_t>(execution.thread_count())));
  return execution;
}

}  // namespace plenoflame
