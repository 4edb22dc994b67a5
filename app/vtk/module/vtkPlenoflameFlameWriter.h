/**
 * @class   vtkPlenoflameFlameWriter
 * @brief   writes an image as a flame's grids to an OpenVDB file (.vdb)
 *
 * Input: a vtkImageData with a temperature array [K] and an absorption array [1/m], of points or
 * cells. Origin, spacing and direction matrix become the grids' transform. Call Write().
 */
#ifndef vtkPlenoflameFlameWriter_h
#define vtkPlenoflameFlameWriter_h

#include <string>  // for array names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameFlameWriter : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameFlameWriter* New();
  vtkTypeMacro(vtkPlenoflameFlameWriter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the .vdb file; a file that is there is replaced when the new one is complete.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Names of the arrays (default: "temperature", "absorption").
   */
  vtkSetStdStringFromCharMacro(TemperatureArray);
  vtkGetCharFromStdStringMacro(TemperatureArray);
  vtkSetStdStringFromCharMacro(AbsorptionArray);
  vtkGetCharFromStdStringMacro(AbsorptionArray);
  ///@}

  ///@{
  /**
   * Temperature outside of the grid [K] (default: 293.15).
   */
  vtkSetMacro(AmbientTemperature, double);
  vtkGetMacro(AmbientTemperature, double);
  ///@}

  ///@{
  /**
   * Whether values are stored with 16 bits (default: off).
   */
  vtkSetMacro(Half, bool);
  vtkGetMacro(Half, bool);
  vtkBooleanMacro(Half, bool);
  ///@}

  /**
   * Update the input and write it. False after an error event, or when an observer of progress
   * events has set AbortExecute: then there is no file, or the one that was there before.
   */
  bool Write();

 protected:
  vtkPlenoflameFlameWriter();
  ~vtkPlenoflameFlameWriter() override;

  char* FileName = nullptr;
  std::string TemperatureArray = "temperature", AbsorptionArray = "absorption";
  double AmbientTemperature = 293.15;
  bool Half = false;

 private:
  vtkPlenoflameFlameWriter(const vtkPlenoflameFlameWriter&) = delete;
  void operator=(const vtkPlenoflameFlameWriter&) = delete;
};

#endif
