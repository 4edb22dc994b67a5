#pragma once
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <memory>
#include <utility>

namespace plenoflame::pipeline {

/// An array of VTK's that shows memory of ours and keeps its owner alive: views of it in Python
/// outlive everything else. To VTK and Python it is a plain array.
template <class Array>
class SharedArray : public Array {
 public:
  /// @param owner of the values, which must not move
  static vtkSmartPointer<Array> of(std::shared_ptr<const void> owner,
                                   const typename Array::ValueType* values, std::size_t count,
                                   int components) {
    auto* const array = new SharedArray;
    array->InitializeObjectBase();
    array->owner_ = std::move(owner);
    array->SetNumberOfComponents(components);
    // VTK knows no arrays of constants.
    array->SetArray(const_cast<typename Array::ValueType*>(values), static_cast<vtkIdType>(count),
                    1);
    return vtkSmartPointer<Array>::Take(array);
  }

 private:
  std::shared_ptr<const void> owner_;
};

}  // namespace plenoflame::pipeline
