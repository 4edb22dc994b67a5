/**
 * @class   vtkPlenoflameRayPathSource
 * @brief   the paths of rays through a scene
 *
 * Input: a vtkPlenoflameScene. Output: a vtkPolyData with one polyline a ray, from the sensor to
 * the scene (rays of object points: the other way), in the world, in double precision; the arrays
 * of docs/rays.md. The rays of pixels and microlenses are those that the image is made of: weight x
 * radiance, summed over a pixel's rays, is its flux.
 *
 * Bundles are added to one another; without any the output is empty.
 */
#ifndef vtkPlenoflameRayPathSource_h
#define vtkPlenoflameRayPathSource_h

#include "vtkPlenoflameModule.h"  // for export macro
#include "vtkPolyDataAlgorithm.h"

#ifndef __VTK_WRAP__
#include <memory>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameRayPathSource : public vtkPolyDataAlgorithm {
 public:
  static vtkPlenoflameRayPathSource* New();
  vtkTypeMacro(vtkPlenoflameRayPathSource, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * All rays of a pixel: column and row from the top left.
   */
  void AddPixel(int column, int row);
  ///@}

  /**
   * All rays through the microlens (q, r), from every pixel that it lights.
   */
  void AddMicrolens(int q, int r);

  /**
   * Rays from a point of the world [m] towards the camera: RaysPerPoint of them.
   */
  void AddObjectPoint(double x, double y, double z);

  /**
   * Take away what the three functions above added.
   */
  void RemoveAllBundles();

  ///@{
  /**
   * All rays of so many pixels drawn at random (default: 0).
   */
  vtkSetClampMacro(NumberOfRandomPixels, int, 0, VTK_INT_MAX);
  vtkGetMacro(NumberOfRandomPixels, int);
  ///@}

  ///@{
  /**
   * The chief ray of every microlens (default: off).
   */
  vtkSetMacro(ChiefRays, bool);
  vtkGetMacro(ChiefRays, bool);
  vtkBooleanMacro(ChiefRays, bool);
  ///@}

  ///@{
  /**
   * Rays per pixel and microlens that covers it (default: 64), and per object point (default: 64).
   */
  vtkSetClampMacro(RaysPerPixel, int, 2, VTK_INT_MAX);
  vtkGetMacro(RaysPerPixel, int);
  vtkSetClampMacro(RaysPerPoint, int, 1, VTK_INT_MAX);
  vtkGetMacro(RaysPerPoint, int);
  ///@}

  ///@{
  /**
   * Points on each ray between entering and leaving the flames' bounds (default: 0), with point
   * data "temperature" and "absorption".
   */
  vtkSetClampMacro(FlameSamples, int, 0, 100000);
  vtkGetMacro(FlameSamples, int);
  ///@}

  ///@{
  /**
   * Seed; -1 (default): the scene's.
   */
  vtkSetMacro(Seed, vtkTypeInt64);
  vtkGetMacro(Seed, vtkTypeInt64);
  ///@}

  ///@{
  /**
   * Which rays to keep by how they ended (default: all). 0 reached the scene, 1 vignetted, 2 total
   * internal reflection, 3 missed a surface.
   */
  void SetStatusSelected(int status, bool selected);
  bool GetStatusSelected(int status);
  ///@}

  ///@{
  /**
   * Which rays to keep by the type of their microlens; -1 (default): all.
   */
  vtkSetClampMacro(SelectedType, int, -1, VTK_INT_MAX);
  vtkGetMacro(SelectedType, int);
  ///@}

  ///@{
  /**
   * At most so many rays, drawn evenly from all (default: 0: all). Sums over rays are no fluxes
   * then.
   */
  vtkSetClampMacro(MaximumNumberOfRays, int, 0, VTK_INT_MAX);
  vtkGetMacro(MaximumNumberOfRays, int);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

 protected:
  vtkPlenoflameRayPathSource();
  ~vtkPlenoflameRayPathSource() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                          vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int NumberOfRandomPixels = 0;
  bool ChiefRays = false;
  int RaysPerPixel = 64, RaysPerPoint = 64, FlameSamples = 0;
  vtkTypeInt64 Seed = -1;
  bool StatusSelected[4] = {true, true, true, true};
  int SelectedType = -1, MaximumNumberOfRays = 0, NumberOfThreads = 0;

 private:
  vtkPlenoflameRayPathSource(const vtkPlenoflameRayPathSource&) = delete;
  void operator=(const vtkPlenoflameRayPathSource&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
};

#endif
