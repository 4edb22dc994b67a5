#pragma once
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkNew.h>
#include <vtkObject.h>

#include <string>
#include <vector>

namespace plenoflame::test {

/// Collects the texts of an object's error or warning events, which VTK then doesn't print.
class Events {
 public:
  explicit Events(vtkObject* object, unsigned long event = vtkCommand::ErrorEvent)
      : object_(object) {
    callback_->SetClientData(&texts_);
    callback_->SetCallback([](vtkObject*, unsigned long, void* texts, void* text) {
      static_cast<std::vector<std::string>*>(texts)->emplace_back(static_cast<const char*>(text));
    });
    tag_ = object->AddObserver(event, callback_);
  }
  ~Events() { object_->RemoveObserver(tag_); }
  Events(const Events&) = delete;
  Events& operator=(const Events&) = delete;

  std::size_t size() const { return texts_.size(); }
  /// Tells if exactly one came, and has this in it.
  bool one_with(const std::string& part) const {
    return texts_.size() == 1 && texts_[0].find(part) != std::string::npos;
  }
  std::string all() const {
    std::string joined;
    for (const std::string& text : texts_) joined += text + "\n";
    return joined;
  }

 private:
  vtkObject* object_;
  vtkNew<vtkCallbackCommand> callback_;
  std::vector<std::string> texts_;
  unsigned long tag_ = 0;
};

}  // namespace plenoflame::test
