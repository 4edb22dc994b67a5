#pragma once
#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>

#include <functional>
#include <utility>

#include "plenoflame/base/error.h"

namespace plenoflame::simulation {

/// Gets the progress, 0 to 1, and returns whether to continue.
using Watcher = std::function<bool(double)>;

/// Updates an algorithm under the eyes of a watcher. It stops where it looks at AbortExecute.
/// @throws Cancelled when the watcher wants no more of it
inline void update_watched(vtkAlgorithm& algorithm, const Watcher& watcher,
                           const std::function<void()>& update) {
  struct Watch {
    const Watcher& watcher;
    bool wanted = true;
  } watch{watcher};
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&watch);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void* fraction) {
    auto& self = *static_cast<Watch*>(data);
    self.wanted = self.wanted && self.watcher(*static_cast<double*>(fraction));
    if (!self.wanted) static_cast<vtkAlgorithm*>(caller)->AbortExecuteOn();
  });
  struct Observed {
    vtkAlgorithm& algorithm;
    unsigned long tag;
    ~Observed() { algorithm.RemoveObserver(tag); }
  };
  {
    const Observed observed{algorithm, algorithm.AddObserver(vtkCommand::ProgressEvent, callback)};
    update();
  }
  if (!watch.wanted || !watcher(1)) throw Cancelled();
}

}  // namespace plenoflame::simulation
