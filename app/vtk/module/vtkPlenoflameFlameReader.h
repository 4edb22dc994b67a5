/**
 * @class   vtkPlenoflameFlameReader
 * @brief   reads a flame's grids from an OpenVDB file (.vdb)
 *
 * Output: a vtkImageData with the float point arrays "temperature" [K] and "absorption" [1/m].
 * Samples stand where the file's transform puts them: origin, spacing and direction matrix of the
 * image hold it, rotation and shear included. Outside of stored voxels the background is filled in.
 *
 * Much of VTK (volume mappers among it) ignores the direction matrix: with LocalFrame the image
 * stands unrotated at the origin, and GetLocalToWorld() is for vtkProp3D::SetUserMatrix().
 *
 * When the grids have different lattices the image has the first one's, and the other is
 * interpolated trilinearly (a warning event says so); read them one by one with SetGridName() to
 * keep both.
 */
#ifndef vtkPlenoflameFlameReader_h
#define vtkPlenoflameFlameReader_h

#include <string>  // for grid names

#include "vtkImageAlgorithm.h"
#include "vtkNew.h"               // for the matrix
#include "vtkPlenoflameModule.h"  // for export macro

class vtkMatrix4x4;

#ifndef __VTK_WRAP__
#include <memory>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameFlameReader : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameFlameReader* New();
  vtkTypeMacro(vtkPlenoflameFlameReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the .vdb file.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  ///@}

  ///@{
  /**
   * Any one grid by its name, values as stored; empty (default): temperature and absorption of the
   * flame, under their usual names, in K and 1/m; of a file with neither of them all grids as
   * stored.
   */
  vtkSetStdStringFromCharMacro(GridName);
  vtkGetCharFromStdStringMacro(GridName);
  ///@}

  ///@{
  /**
   * Whether the image stands in the grid's own frame (default: off).
   */
  vtkSetMacro(LocalFrame, bool);
  vtkGetMacro(LocalFrame, bool);
  vtkBooleanMacro(LocalFrame, bool);
  ///@}

  /**
   * Of the last file: from the coordinates of the local frame to the world.
   */
  vtkMatrix4x4* GetLocalToWorld();

 protected:
  vtkPlenoflameFlameReader();
  ~vtkPlenoflameFlameReader() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  char* FileName = nullptr;
  std::string GridName;
  bool LocalFrame = false;
  vtkNew<vtkMatrix4x4> LocalToWorld;

 private:
  vtkPlenoflameFlameReader(const vtkPlenoflameFlameReader&) = delete;
  void operator=(const vtkPlenoflameFlameReader&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
  bool Make(vtkImageData& image);
};

#endif
