#pragma once
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkObject.h>

#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/base/execution.h"

namespace plenoflame {

/// Turns error events into an exception, and passes warning events on.
class ErrorLog {
 public:
  /// @param execution its warnings; it must live as long
  explicit ErrorLog(const Execution& execution) : execution_(execution) {
    callback_->SetClientData(this);
    callback_->SetCallback([](vtkObject*, unsigned long event, void* self, void* data) {
      std::string text = static_cast<const char*>(data);
      if (const auto at = text.find("): "); at != std::string::npos) text = text.substr(at + 3);
      while (!text.empty() && text.back() == '\n') text.pop_back();
      auto& log = *static_cast<ErrorLog*>(self);
      if (event == vtkCommand::WarningEvent)
        log.execution_.warn(text);
      else if (log.first_.empty())
        log.first_ = text;
    });
  }
  void watch(vtkObject* object) {
    object->AddObserver(vtkCommand::ErrorEvent, callback_);
    object->AddObserver(vtkCommand::WarningEvent, callback_);
  }
  /// @throws InputError with the first error's message
  void check() const {
    if (!first_.empty()) throw InputError(first_);
  }

 private:
  const Execution& execution_;
  vtkNew<vtkCallbackCommand> callback_;
  std::string first_;
};

}  // namespace plenoflame
