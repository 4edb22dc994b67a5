/**
 * @class   vtkPlenoflameFlameSource
 * @brief   samples the flames of a scene on a lattice in the world
 *
 * Input: a vtkPlenoflameScene. Output: a vtkImageData around all flames with the float point arrays
 * "temperature" [K] and "absorption" [1/m], whatever the flames are made of: for showing them. The
 * exact voxels of a file come from vtkPlenoflameFlameReader.
 */
#ifndef vtkPlenoflameFlameSource_h
#define vtkPlenoflameFlameSource_h

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <memory>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameFlameSource : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameFlameSource* New();
  vtkTypeMacro(vtkPlenoflameFlameSource, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Points along the longest side, 2 to 1024 (default: 128); the others follow from the shape.
   */
  vtkSetClampMacro(Resolution, int, 2, 1024);
  vtkGetMacro(Resolution, int);
  ///@}

 protected:
  vtkPlenoflameFlameSource();
  ~vtkPlenoflameFlameSource() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                          vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int Resolution = 128;

 private:
  vtkPlenoflameFlameSource(const vtkPlenoflameFlameSource&) = delete;
  void operator=(const vtkPlenoflameFlameSource&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
  bool Make(vtkImageData& image);
};

#endif
