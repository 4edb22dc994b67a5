/**
 * @class   vtkPlenoflameOperator
 * @brief   the matrix from a flame's samples to the pixels' fluxes
 *
 * What `plenoflame operator` writes, in memory: Update() follows the rays of the scenes' cameras,
 * and with Stored makes the matrix. Without it Apply() follows the rays again each time.
 */
#ifndef vtkPlenoflameOperator_h
#define vtkPlenoflameOperator_h

#include <string>  // for options

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class vtkDoubleArray;
class vtkFloatArray;
class vtkIntArray;
class vtkPlenoflameScene;
class vtkTypeInt64Array;

#ifndef __VTK_WRAP__
#include <memory>  // for the problem
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameOperator : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameOperator* New();
  vtkTypeMacro(vtkPlenoflameOperator, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Set an option by the name that it has for the command, without dashes: "unknowns", "grid",
   * "rays". False after an error event.
   */
  bool SetOption(const std::string& name, const std::string& value);

  /**
   * Add a camera: the one that the scene is about. The scene must not change any more.
   */
  void AddCamera(vtkPlenoflameScene* scene);

  ///@{
  /**
   * Whether the matrix is made (default: off).
   */
  vtkSetMacro(Stored, bool);
  vtkGetMacro(Stored, bool);
  vtkBooleanMacro(Stored, bool);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor. The result does not depend on it.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * After Update(): rows (blocks of pixels that see the grid), columns (unknowns), rays, and the
   * bytes that a stored matrix takes, about.
   */
  vtkTypeInt64 GetNumberOfRows();
  vtkTypeInt64 GetNumberOfColumns();
  vtkTypeInt64 GetNumberOfRays();
  double GetMatrixBytes();
  ///@}

  /**
   * Whether samples are those of a source function [W/(m^2 sr)]; else of emission [W/(m^3 sr)].
   */
  bool IsOfSource();

  /**
   * Unknowns along an axis, 0 to 2.
   */
  int GetShape(int axis);

  ///@{
  /**
   * Of each row the first pixel of its block and the number of its camera; of each unknown its
   * place [m] and its volume [m^3].
   */
  VTK_NEWINSTANCE vtkIntArray* GetPixels();
  VTK_NEWINSTANCE vtkDoubleArray* GetPlaces();
  VTK_NEWINSTANCE vtkDoubleArray* GetVolumes();
  ///@}

  ///@{
  /**
   * The stored matrix in compressed sparse rows, without a copy: the arrays keep its memory.
   * Nothing where it is not stored.
   */
  VTK_NEWINSTANCE vtkTypeInt64Array* GetRowStarts();
  VTK_NEWINSTANCE vtkIntArray* GetColumnIndices();
  VTK_NEWINSTANCE vtkFloatArray* GetValues();
  ///@}

#ifndef __VTK_WRAP__
  /// y = A x, or x = A^T y. @throws plenoflame::Error
  void Apply(bool transpose, const double* in, double* out);
#endif

 protected:
  vtkPlenoflameOperator();
  ~vtkPlenoflameOperator() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  bool Stored = false;
  int NumberOfThreads = 0;

 private:
  vtkPlenoflameOperator(const vtkPlenoflameOperator&) = delete;
  void operator=(const vtkPlenoflameOperator&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
