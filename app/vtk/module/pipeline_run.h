#pragma once
#include <functional>
#include <string>

#include "plenoflame/base/execution.h"

class vtkAlgorithm;
class vtkObject;

/// Shared by all algorithms of the module: running core's functions under VTK's rules.
namespace plenoflame::pipeline {

/// Calls `task` on its own thread. Meanwhile the calling thread forwards progress to `algorithm`'s
/// progress events, so that observers (also in Python) run where Update() was called. It turns
/// AbortExecute into a stop request. Warnings become warning events; an exception becomes an error
/// event with the message of the command line.
/// @param threads workers of the task; 0: one per processor
/// @return whether the task ended without exception; false when it was aborted before there was a
/// result
bool run(vtkAlgorithm& algorithm, int threads, const std::function<void(const Execution&)>& task);

/// The same on the calling thread, for what takes no time.
bool run_here(vtkObject& object, const std::function<void()>& task);

/// Invokes an error event; without observer VTK prints it.
void report_error(vtkObject& object, const std::string& message);
void report_warning(vtkObject& object, const std::string& message);

}  // namespace plenoflame::pipeline
