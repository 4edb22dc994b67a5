#pragma once
#include <vector>
#include "plenoflame/base/constants.h"
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame::test {

/// The paper's biconvex singlet: R = 300 mm, 24.26 mm thick, n = 1.5; the stop lies on the front.
inline std::vector<SurfaceSpec> paper_singlet(double diameter = 0.12) {
  return {{0.3, 0.02426, 1.5, diameter, true}, {-0.3, 0, 1, 0.16, false}};
}

/// CODE V's sample double Gauss, f/2, 100 mm (ag_dblgauss of the project ray-optics, BSD-3); clear
/// diameters chosen wide enough for its f/2 beam and field. Surface 5 is the stop.
inline std::vector<SurfaceSpec> double_gauss() {
  return {{0.05620238, 0.00875, 1.622292, 0.066, false},
          {0.15228580, 0.0005, 1, 0.066, false},
          {0.03768262, 0.0125, 1.607379, 0.056, false},
          {kInfinity, 0.0038, 1.603417, 0.056, false},
          {0.02423130, 0.016369445, 1, 0.042, false},
          {kInfinity, 0.013747957, 1, 0.0344, true},
          {-0.02837731, 0.0038, 1.603417, 0.046, false},
          {kInfinity, 0.011, 1.620408, 0.056, false},
          {-0.03792546, 0.0005, 1, 0.056, false},
          {0.17741176, 0.007, 1.620408, 0.066, false},
          {-0.07941143, 0, 1, 0.066, false}};
}

}  // namespace plenoflame::test
