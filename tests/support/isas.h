#pragma once
#include <vector>

#include "plenoflame/base/isa.h"

namespace plenoflame::test {

/// Every instruction set that this processor has, baseline first.
inline std::vector<Isa> supported_isas() {
  std::vector<Isa> isas;
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (is_supported(isa)) isas.push_back(isa);
  return isas;
}

}  // namespace plenoflame::test
