#pragma once
#include "plenoflame/scene/main_lens_spec.h"

namespace plenoflame {

/// Sets a lens to an f-number, its focal length over the diameter of its entrance pupil, by the
/// diameter of its stop. A stop without a diameter gets the resulting one. A stop with a diameter
/// is only narrowed, because the lens may not let more light through.
/// @param f_number above 0
/// @throws InputError if the stop would have to be widened, if there is not exactly one stop, or if
///         the lens does not converge. The lens is then unchanged
void set_f_number(MainLensSpec& lens, double f_number);

}  // namespace plenoflame
