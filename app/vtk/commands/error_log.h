#pragma once
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkObject.h>

#include <iostream>
#include <string>

#include "plenoflame/base/error.h"

namespace plenoflame::cli {

/// Turns error events into an exception, and prints warning events as the command does.
class ErrorLog {
 public:
  ErrorLog() {
    callback_->SetClientData(this);
    callback_->SetCallback([](vtkObject*, unsigned long event, void* self, void* data) {
      std::string text = static_cast<const char*>(data);
      if (const auto at = text.find("): "); at != std::string::npos) text = text.substr(at + 3);
      while (!text.empty() && text.back() == '\n') text.pop_back();
      auto& log = *static_cast<ErrorLog*>(self);
      if (event == vtkCommand::WarningEvent)
        std::cerr << "plenoflame: warning: " << text << '\n';
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
  vtkNew<vtkCallbackCommand> callback_;
  std::string first_;
};

}  // namespace plenoflame::cli
