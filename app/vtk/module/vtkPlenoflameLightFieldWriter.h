/**
 * @class   vtkPlenoflameLightFieldWriter
 * @brief   writes a light field as EXR
 *
 * The input comes from vtkPlenoflameLightFieldSource or vtkPlenoflameLightFieldReader; its values
 * may have been changed. Call Write().
 */
#ifndef vtkPlenoflameLightFieldWriter_h
#define vtkPlenoflameLightFieldWriter_h

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameLightFieldWriter : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameLightFieldWriter* New();
  vtkTypeMacro(vtkPlenoflameLightFieldWriter, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the EXR file; a file that is there is replaced when the new one is complete.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * Update the input and write it. False after an error event.
   */
  bool Write();

 protected:
  vtkPlenoflameLightFieldWriter();
  ~vtkPlenoflameLightFieldWriter() override;

  char* FileName = nullptr;

 private:
  vtkPlenoflameLightFieldWriter(const vtkPlenoflameLightFieldWriter&) = delete;
  void operator=(const vtkPlenoflameLightFieldWriter&) = delete;
};

#endif
