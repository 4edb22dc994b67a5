#include "foreign_update.h"

#include <vtkAlgorithm.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkObject.h>

#include <array>

namespace {

/// Passes the events of one run on to the caller's functions.
class Relay : public vtkCommand {
 public:
  static Relay* New() { return new Relay; }
  vtkTypeMacro(Relay, vtkCommand);

  void Execute(vtkObject* caller, unsigned long event, void* data) override {
    if (event == vtkCommand::ProgressEvent) {
      auto* const algorithm = vtkAlgorithm::SafeDownCast(caller);
      if (algorithm && this->Progress(algorithm->GetProgress())) algorithm->SetAbortExecute(1);
    } else if (data) {
      this->Message(event == vtkCommand::ErrorEvent, static_cast<const char*>(data));
    }
  }

  plenoflame_progress_function Progress = nullptr;
  plenoflame_message_function Message = nullptr;
};

}  // namespace

int plenoflame_update(void* object, plenoflame_progress_function progress,
                      plenoflame_message_function message) {
  vtkAlgorithm* const algorithm = vtkAlgorithm::SafeDownCast(static_cast<vtkObjectBase*>(object));
  if (!algorithm || !progress || !message) return 0;
  Relay* const relay = Relay::New();
  relay->Progress = progress;
  relay->Message = message;
  std::array<vtkObject*, 2> subjects{algorithm, algorithm->GetExecutive()};
  for (vtkObject* const subject : subjects) {
    subject->AddObserver(vtkCommand::ErrorEvent, relay);
    subject->AddObserver(vtkCommand::WarningEvent, relay);
  }
  algorithm->AddObserver(vtkCommand::ProgressEvent, relay);
  algorithm->Update();
  for (vtkObject* const subject : subjects) subject->RemoveObserver(relay);
  relay->Delete();
  return 1;
}
