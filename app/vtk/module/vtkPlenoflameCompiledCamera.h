/**
 * @class   vtkPlenoflameCompiledCamera
 * @brief   a camera whose rays have been found once
 *
 * What `plenoflame compile` writes, in memory: Update() finds the rays of the scene's camera,
 * Read() takes them from a file. vtkPlenoflameLightFieldSource::SetCompiledCamera() renders by
 * them.
 */
#ifndef vtkPlenoflameCompiledCamera_h
#define vtkPlenoflameCompiledCamera_h

#include <string>  // for figures

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class vtkPlenoflameScene;

#ifndef __VTK_WRAP__
#include <memory>  // for the rays
namespace plenoflame {
struct CompiledCamera;
}
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameCompiledCamera : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameCompiledCamera* New();
  vtkTypeMacro(vtkPlenoflameCompiledCamera, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The scene whose camera it is: the one that the scene is about.
   */
  void SetScene(vtkPlenoflameScene* scene);

  ///@{
  /**
   * Relative RMSE over lit pixels that pictures of a flame in layers are to have (default: 0.005).
   */
  vtkSetMacro(Error, double);
  vtkGetMacro(Error, double);
  ///@}

  ///@{
  /**
   * Rays per pixel and microlens from which the few are found, and how many are kept, 1 to 7; 0
   * (default): as Error needs.
   */
  vtkSetClampMacro(Samples, int, 0, 65536);
  vtkGetMacro(Samples, int);
  vtkSetClampMacro(Level, int, 0, 7);
  vtkGetMacro(Level, int);
  ///@}

  ///@{
  /**
   * Seed of the rays (default: 1).
   */
  vtkSetMacro(Seed, vtkTypeInt64);
  vtkGetMacro(Seed, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Part of the sensor: first column and row from the top left, width, height. Width 0 (default):
   * all of it.
   */
  vtkSetVector4Macro(Window, int);
  vtkGetVector4Macro(Window, int);
  ///@}

  ///@{
  /**
   * World box in which all flames will be [m]: lower x, y, z, upper x, y, z; all zero (default):
   * around the flames of the scene. Margin is added on all sides.
   */
  vtkSetVector6Macro(Region, double);
  vtkGetVector6Macro(Region, double);
  vtkSetMacro(Margin, double);
  vtkGetMacro(Margin, double);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor. The rays do not depend on it.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * Take the rays from a file (.bundle), or write them. False after an error event.
   */
  bool Read(const std::string& path);
  bool Write(const std::string& path);
  ///@}

  /**
   * Figures of the rays; empty where there are none yet.
   */
  std::string GetFiguresAsJson();

#ifndef __VTK_WRAP__
  /// The rays; nullptr: none yet.
  std::shared_ptr<const plenoflame::CompiledCamera> GetRays() const;
#endif

 protected:
  vtkPlenoflameCompiledCamera();
  ~vtkPlenoflameCompiledCamera() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  double Error = 0.005;
  int Samples = 0, Level = 0;
  vtkTypeInt64 Seed = 1;
  int Window[4] = {0, 0, 0, 0};
  double Region[6] = {0, 0, 0, 0, 0, 0};
  double Margin = 0;
  int NumberOfThreads = 0;

 private:
  vtkPlenoflameCompiledCamera(const vtkPlenoflameCompiledCamera&) = delete;
  void operator=(const vtkPlenoflameCompiledCamera&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
