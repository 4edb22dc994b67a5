#pragma once
#include <string>

namespace plenoflame::cli {

/// "plenoflame 0.1.0 (commit 0123456789; parts: ...; instruction set: avx2)": what was built, and
/// what this processor runs of it.
std::string build_information();

/// The sentence for a command that this build lacks: what it needs and how to get it.
/// @param part "OpenVDB" or "VTK"
std::string missing_part(const std::string& command, const std::string& part);

}  // namespace plenoflame::cli
