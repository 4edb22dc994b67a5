/**
 * @class   vtkPlenoflameFlameGenerator
 * @brief   a generated flame: candle, diffusion flame, plume, ...
 *
 * Output: a vtkImageData with the float point arrays "temperature" [K] and "absorption" [1/m], and
 * one per emission line [W/m^3], as vtkPlenoflameFlameWriter takes it. The flames and their
 * parameters are those of `plenoflame flame`.
 */
#ifndef vtkPlenoflameFlameGenerator_h
#define vtkPlenoflameFlameGenerator_h

#include <string>  // for names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <map>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameFlameGenerator : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameFlameGenerator* New();
  vtkTypeMacro(vtkPlenoflameFlameGenerator, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Which flame (default: candle).
   */
  vtkSetStdStringFromCharMacro(FlameName);
  vtkGetCharFromStdStringMacro(FlameName);
  ///@}

  ///@{
  /**
   * Values of parameters, as text with units; what is not given has its default.
   */
  void SetParameter(const std::string& name, const std::string& value);
  void RemoveAllParameters();
  ///@}

  /**
   * The table of all flames: a list of {"name", "what", "parameters": [{"name", "about", "value",
   * "unit"}]}.
   */
  static std::string GetGeneratorsAsJson();

 protected:
  vtkPlenoflameFlameGenerator();
  ~vtkPlenoflameFlameGenerator() override = default;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  std::string FlameName = "candle";

 private:
  vtkPlenoflameFlameGenerator(const vtkPlenoflameFlameGenerator&) = delete;
  void operator=(const vtkPlenoflameFlameGenerator&) = delete;

#ifndef __VTK_WRAP__
  std::map<std::string, std::string> Parameters;
#endif
};

#endif
