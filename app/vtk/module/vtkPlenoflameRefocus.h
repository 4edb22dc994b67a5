/**
 * @class   vtkPlenoflameRefocus
 * @brief   the picture of a lens focused on another distance, after the exposure
 *
 * Input: a light field (vtkPlenoflameLightFieldSource, vtkPlenoflameLightFieldReader). Output: a
 * vtkImageData, array "radiance" [W/(m^2 sr)], rows upwards; GetPixelSize() gives its scale on the
 * object plane.
 */
#ifndef vtkPlenoflameRefocus_h
#define vtkPlenoflameRefocus_h

#include <string>  // for channel names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <memory>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameRefocus : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameRefocus* New();
  vtkTypeMacro(vtkPlenoflameRefocus, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Distance of the object plane from the front of the main lens [m] (default: 1).
   */
  vtkSetMacro(Depth, double);
  vtkGetMacro(Depth, double);
  ///@}

  ///@{
  /**
   * Pixels across; 0 (default): one per microlens.
   */
  vtkSetClampMacro(Width, int, 0, 20000);
  vtkGetMacro(Width, int);
  ///@}

  ///@{
  /**
   * Diameter of the synthetic lens in those of the real one, above 0 to 1 (default: 1).
   */
  vtkSetMacro(Aperture, double);
  vtkGetMacro(Aperture, double);
  ///@}

  ///@{
  /**
   * Channel by its name; empty (default): the first.
   */
  vtkSetStdStringFromCharMacro(Channel);
  vtkGetCharFromStdStringMacro(Channel);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  /**
   * Of the last picture: side of a pixel on the object plane [m].
   */
  vtkGetMacro(PixelSize, double);

  /**
   * Of the last picture: where its upper left corner lies on the object plane, in the camera's x
   * and y [m].
   */
  vtkGetVector2Macro(Corner, double);

 protected:
  vtkPlenoflameRefocus();
  ~vtkPlenoflameRefocus() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                          vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  double Depth = 1;
  int Width = 0;
  double Aperture = 1;
  std::string Channel;
  int NumberOfThreads = 0;
  double PixelSize = 0;
  double Corner[2] = {0, 0};

 private:
  vtkPlenoflameRefocus(const vtkPlenoflameRefocus&) = delete;
  void operator=(const vtkPlenoflameRefocus&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
  bool Make(vtkImageData& picture);
};

#endif
