#include "foreign_operator.h"

#include "vtkPlenoflameOperator.h"

int plenoflame_operator_apply(void* object, int transpose, const double* in, double* out) {
  auto* const a = vtkPlenoflameOperator::SafeDownCast(static_cast<vtkObjectBase*>(object));
  if (!a) return 0;
  try {
    a->Apply(transpose != 0, in, out);
    return 1;
  } catch (...) {
    return 0;  // no exception may leave a function of C
  }
}
