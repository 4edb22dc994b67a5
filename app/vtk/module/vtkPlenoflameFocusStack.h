/**
 * @class   vtkPlenoflameFocusStack
 * @brief   refocused pictures at several depths, and what they tell together
 *
 * Input: a light field. Output: a vtkImageData with the arrays "all_in_focus" [W/(m^2 sr)], "depth"
 * [m] (for opaque scenes), "confidence", and "plane_0000", ... in the order of the depths; rows
 * upwards.
 */
#ifndef vtkPlenoflameFocusStack_h
#define vtkPlenoflameFocusStack_h

#include "vtkPlenoflameModule.h"  // for export macro
#include "vtkPlenoflameRefocus.h"

#ifndef __VTK_WRAP__
#include <vector>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameFocusStack : public vtkPlenoflameRefocus {
 public:
  static vtkPlenoflameFocusStack* New();
  vtkTypeMacro(vtkPlenoflameFocusStack, vtkPlenoflameRefocus);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Depths in front of the main lens [m], ascending, at least three.
   */
  void AddDepth(double depth);
  void RemoveAllDepths();
  ///@}

 protected:
  vtkPlenoflameFocusStack() = default;
  ~vtkPlenoflameFocusStack() override = default;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

 private:
  vtkPlenoflameFocusStack(const vtkPlenoflameFocusStack&) = delete;
  void operator=(const vtkPlenoflameFocusStack&) = delete;

#ifndef __VTK_WRAP__
  std::vector<double> Depths;
#endif
};

#endif
