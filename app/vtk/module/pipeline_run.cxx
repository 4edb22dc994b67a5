#include "pipeline_run.h"

#include <vtkAlgorithm.h>
#include <vtkSetGet.h>

#include <exception>
#include <vector>

#include "plenoflame/base/error.h"
#include "watched_run.h"

namespace plenoflame::pipeline {

void report_error(vtkObject& object, const std::string& message) {
  vtkErrorWithObjectMacro(&object, << message);
}

void report_warning(vtkObject& object, const std::string& message) {
  vtkWarningWithObjectMacro(&object, << message);
}

bool run_here(vtkObject& object, const std::function<void()>& task) {
  try {
    task();
    return true;
  } catch (const Cancelled&) {
    return false;
  } catch (...) {
    report_error(object, message_of_current_exception({}));
    return false;
  }
}

bool run(vtkAlgorithm& algorithm, int threads, const std::function<void(const Execution&)>& task) {
  algorithm.SetAbortExecute(0);
  algorithm.UpdateProgress(0);
  const auto watch = [&](double fraction) {
    algorithm.UpdateProgress(fraction);
    return algorithm.GetAbortExecute() != 0;
  };
  std::vector<std::string> warnings;
  std::exception_ptr failure;
  try {
    watched_run(threads, watch, warnings, task);
  } catch (...) {
    failure = std::current_exception();
  }
  for (const std::string& warning : warnings) report_warning(algorithm, warning);
  const bool finished = run_here(algorithm, [&] {
    if (failure) std::rethrow_exception(failure);
  });
  if (finished) algorithm.UpdateProgress(1);
  return finished;
}

}  // namespace plenoflame::pipeline
