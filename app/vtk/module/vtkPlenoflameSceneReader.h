/**
 * @class   vtkPlenoflameSceneReader
 * @brief   reads a scene file (.toml)
 *
 * The output is a vtkPlenoflameScene. What is wrong with the file is told by an error event,
 * "file:line:column: ..."; what is probably not meant, by the algorithms that use it.
 */
#ifndef vtkPlenoflameSceneReader_h
#define vtkPlenoflameSceneReader_h

#include "vtkAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class vtkPlenoflameScene;

class VTKPLENOFLAME_EXPORT vtkPlenoflameSceneReader : public vtkAlgorithm {
 public:
  static vtkPlenoflameSceneReader* New();
  vtkTypeMacro(vtkPlenoflameSceneReader, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the scene file.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  /**
   * The scene; call Update() first.
   */
  vtkPlenoflameScene* GetOutput();

 protected:
  vtkPlenoflameSceneReader();
  ~vtkPlenoflameSceneReader() override;

  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                             vtkInformationVector* outputs) override;
  int FillOutputPortInformation(int port, vtkInformation* information) override;

  char* FileName = nullptr;

 private:
  vtkPlenoflameSceneReader(const vtkPlenoflameSceneReader&) = delete;
  void operator=(const vtkPlenoflameSceneReader&) = delete;
};

#endif
