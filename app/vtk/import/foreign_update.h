#pragma once
#include "vtkPlenoflameImportModule.h"  // for export macro

/// Running an algorithm for a language whose lock must not be held meanwhile: Python calls this
/// through ctypes, which gives up the interpreter's lock during the call and takes it again for
/// the functions given here. VTK's own wrapping of Update() holds it throughout.
extern "C" {

/// @param fraction done @return other than 0: stop the run
using plenoflame_progress_function = int (*)(double fraction);
/// @param is_error 0: a warning @param text as VTK gives it to observers
using plenoflame_message_function = void (*)(int is_error, const char* text);

/// Calls Update() of a vtkAlgorithm. Both functions are called on the calling thread; no other
/// observer in a locked language may watch the algorithm meanwhile.
/// @return 0: the object is no algorithm, and nothing was done
VTKPLENOFLAMEIMPORT_EXPORT int plenoflame_update(void* object,
                                                 plenoflame_progress_function progress,
                                                 plenoflame_message_function message);
}
