/**
 * @class   vtkPlenoflameLightFieldReader
 * @brief   reads a light field (.exr) that Plenoflame wrote
 *
 * The output is laid out as that of vtkPlenoflameLightFieldSource.
 */
#ifndef vtkPlenoflameLightFieldReader_h
#define vtkPlenoflameLightFieldReader_h

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameLightFieldReader : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameLightFieldReader* New();
  vtkTypeMacro(vtkPlenoflameLightFieldReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the EXR file.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

 protected:
  vtkPlenoflameLightFieldReader();
  ~vtkPlenoflameLightFieldReader() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  char* FileName = nullptr;

 private:
  vtkPlenoflameLightFieldReader(const vtkPlenoflameLightFieldReader&) = delete;
  void operator=(const vtkPlenoflameLightFieldReader&) = delete;
};

#endif
