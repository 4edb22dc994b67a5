#pragma once

namespace plenoflame::cli {

/// Restarts the measurement of this process' largest resident memory, if the system can (Linux).
void reset_peak_memory();
/// The largest resident memory since then [byte]; since the start where it cannot be reset.
double peak_memory();

}  // namespace plenoflame::cli
