#pragma once
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// Sets a lens to an f-number, its focal length over the diameter of its entrance pupil, by the
/// diameter of its stop. A stop without a diameter gets the one that follows; one that has a
/// diameter is narrowed, since nothing says whether the lens lets more through.
/// @param f_number above 0
/// @throws InputError when the stop would have to be wider than it is, when there is not one stop,
/// or when the lens does not converge; the lens is then unchanged
void set_f_number(MainLensSpec& lens, double f_number);

}  // namespace plenoflame
