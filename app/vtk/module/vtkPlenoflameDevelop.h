/**
 * @class   vtkPlenoflameDevelop
 * @brief   the picture that a sensor makes of a light field
 *
 * Input: a light field (vtkPlenoflameLightFieldSource, vtkPlenoflameLightFieldReader). Output: a
 * vtkImageData of unsigned short, "digital_number", as `plenoflame develop` writes it.
 */
#ifndef vtkPlenoflameDevelop_h
#define vtkPlenoflameDevelop_h

#include <string>  // for channel names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameDevelop : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameDevelop* New();
  vtkTypeMacro(vtkPlenoflameDevelop, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum CurveType { LINEAR = 0, DISPLAY = 1 };

  ///@{
  /**
   * Flux per pixel [W] that gives the largest digital number; 0 (default): the least that 99.9 % of
   * the pixels with light do not exceed.
   */
  vtkSetMacro(Saturation, double);
  vtkGetMacro(Saturation, double);
  ///@}

  ///@{
  /**
   * Bits of the sensor, 1 to 16 (default: 14); the values fill 16 bits.
   */
  vtkSetMacro(Bits, int);
  vtkGetMacro(Bits, int);
  ///@}

  ///@{
  /**
   * LINEAR, or DISPLAY (default): through the transfer function of sRGB.
   */
  vtkSetClampMacro(Curve, int, LINEAR, DISPLAY);
  vtkGetMacro(Curve, int);
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
   * Of the last picture: the flux [W] at which it saturates, and the share of saturated pixels.
   */
  vtkGetMacro(UsedSaturation, double);
  vtkGetMacro(SaturatedShare, double);
  ///@}

 protected:
  vtkPlenoflameDevelop() = default;
  ~vtkPlenoflameDevelop() override = default;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  double Saturation = 0;
  int Bits = 14;
  int Curve = DISPLAY;
  std::string Channel;
  double UsedSaturation = 0, SaturatedShare = 0;

 private:
  vtkPlenoflameDevelop(const vtkPlenoflameDevelop&) = delete;
  void operator=(const vtkPlenoflameDevelop&) = delete;
};

#endif
