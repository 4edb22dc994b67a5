#pragma once
#include "vtkPlenoflameModule.h"  // for export macro

extern "C" {

/// A x, or A^T x, of a vtkPlenoflameOperator, for callers that give up a lock meanwhile (Python's).
/// @param object the vtkPlenoflameOperator @param in, out as many numbers as it has columns and
/// rows @return 1; 0 where that failed
VTKPLENOFLAME_EXPORT int plenoflame_operator_apply(void* object, int transpose, const double* in,
                                                   double* out);
}
