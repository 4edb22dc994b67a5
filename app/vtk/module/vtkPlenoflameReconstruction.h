/**
 * @class   vtkPlenoflameReconstruction
 * @brief   the flame back from pictures of it
 *
 * What `plenoflame reconstruct` does, in memory. The output is an image of voxels with the arrays
 * that the command writes as grids ("temperature" [K], "absorption" [1/m], "emission", deviations,
 * "resolved"): a flame that can be given to a scene. GetField() gives the same at the unknowns.
 * When it is aborted, what was reached by then is the output.
 */
#ifndef vtkPlenoflameReconstruction_h
#define vtkPlenoflameReconstruction_h

#include <string>  // for options

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class vtkDoubleArray;
class vtkImageData;
class vtkPlenoflameScene;

#ifndef __VTK_WRAP__
#include <memory>  // for the result
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameReconstruction : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameReconstruction* New();
  vtkTypeMacro(vtkPlenoflameReconstruction, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Set an option by the name that it has for the command, without dashes: "unknowns", "solver";
   * flags ("truth") take true or false. False after an error event.
   */
  bool SetOption(const std::string& name, const std::string& value);

  /**
   * Add a camera, the one that the scene is about, with its picture: a light field, or electrons.
   * @param name of the picture in messages
   */
  void AddCamera(vtkPlenoflameScene* scene, vtkImageData* picture, const std::string& name);

  /**
   * A field of an earlier result at the same unknowns, in place of a file.
   * @param use "start" or "prior" @param field "emission", "temperature" or "absorption"
   */
  bool SetEarlierField(const std::string& use, const std::string& field, vtkDoubleArray* values);

  ///@{
  /**
   * Worker threads; 0 (default): one per processor. The result does not depend on it.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * After Update(): whether there is a result, and whether it is complete.
   */
  bool HasResult();
  bool IsComplete();
  ///@}

  /**
   * The figures by the names that `plenoflame reconstruct --json` gives them.
   */
  std::string GetFiguresAsJson();

  /**
   * The same for people, a line each.
   */
  std::string GetReport();

  /**
   * Unknowns along an axis, 0 to 2.
   */
  int GetShape(int axis);

  ///@{
  /**
   * What was found at the unknowns: the fields' names, and their values.
   */
  int GetNumberOfFields();
  std::string GetFieldName(int i);
  VTK_NEWINSTANCE vtkDoubleArray* GetField(int i);
  ///@}

  /**
   * Place of each unknown [m].
   */
  VTK_NEWINSTANCE vtkDoubleArray* GetPlaces();

  ///@{
  /**
   * Of each channel of each camera an image with the arrays "residual" and "explained" [W].
   */
  int GetNumberOfPictures();
  VTK_NEWINSTANCE vtkImageData* GetPicture(int i);
  ///@}

  /**
   * Write the grids as the command does (.vdb). False after an error event.
   */
  bool Write(const std::string& path);

 protected:
  vtkPlenoflameReconstruction();
  ~vtkPlenoflameReconstruction() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int NumberOfThreads = 0;

 private:
  vtkPlenoflameReconstruction(const vtkPlenoflameReconstruction&) = delete;
  void operator=(const vtkPlenoflameReconstruction&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
