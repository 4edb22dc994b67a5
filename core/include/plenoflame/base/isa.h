#pragma once
#include <string_view>

namespace plenoflame {

/// Instruction sets for which the vector kernels are compiled; chosen at run time.
enum class Isa {
  baseline,  ///< what every processor of the platform has (x86-64: SSE2)
  avx2,      ///< x86-64-v3: AVX2, FMA
  avx512,    ///< x86-64-v4: AVX-512 F/BW/CD/DQ/VL
};

bool is_supported(Isa isa);      ///< by this processor
Isa best_isa();                  ///< the widest supported one
std::string_view name(Isa isa);  ///< "baseline", "avx2", "avx512"

}  // namespace plenoflame
