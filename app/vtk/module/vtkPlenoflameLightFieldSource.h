/**
 * @class   vtkPlenoflameLightFieldSource
 * @brief   renders the light field of a scene
 *
 * Input: a vtkPlenoflameScene. Output: a vtkImageData with one float array per channel, flux per
 * pixel [W], and its standard error, "NAME.error". Rows run upwards, as VTK shows images. The field
 * data holds the scene and all else that later steps need ("plenoflame.scene", ...).
 *
 * Progress events come on the thread that called Update(); AbortExecute ends the run early, with
 * what was rendered until then (GetComplete() tells).
 */
#ifndef vtkPlenoflameLightFieldSource_h
#define vtkPlenoflameLightFieldSource_h

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameLightFieldSource : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameLightFieldSource* New();
  vtkTypeMacro(vtkPlenoflameLightFieldSource, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum EstimatorType { SCENE_ESTIMATOR = 0, BACKWARD = 1, FORWARD = 2 };

  ///@{
  /**
   * Rays per pixel and microlens (backward), energy bundles in all (forward); 0 (default): as the
   * scene says.
   */
  vtkSetClampMacro(Samples, int, 0, VTK_INT_MAX);
  vtkGetMacro(Samples, int);
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
   * SCENE_ESTIMATOR (default), BACKWARD or FORWARD.
   */
  vtkSetClampMacro(Estimator, int, SCENE_ESTIMATOR, FORWARD);
  vtkGetMacro(Estimator, int);
  ///@}

  ///@{
  /**
   * Relative RMSE over lit pixels at which to stop; 0 (default): none. With it or a time limit
   * Samples is the most that a pixel gets.
   */
  vtkSetMacro(TargetError, double);
  vtkGetMacro(TargetError, double);
  ///@}

  ///@{
  /**
   * Seconds after which to stop; 0 (default): none.
   */
  vtkSetMacro(TimeLimit, double);
  vtkGetMacro(TimeLimit, double);
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
   * Worker threads; 0 (default): one per processor. The image does not depend on it.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * Whether to estimate standard errors (default: on).
   */
  vtkSetMacro(StandardError, bool);
  vtkGetMacro(StandardError, bool);
  vtkBooleanMacro(StandardError, bool);
  ///@}

  ///@{
  /**
   * Whether to add the layers of ground truth, "truth.NAME", as `render --truth` (default: off).
   */
  vtkSetMacro(Truth, bool);
  vtkGetMacro(Truth, bool);
  vtkBooleanMacro(Truth, bool);
  ///@}

  ///@{
  /**
   * About the last run: false when it was aborted; the estimated relative RMSE over lit pixels (-1:
   * not known); rays sent.
   */
  vtkGetMacro(Complete, bool);
  vtkGetMacro(RelativeError, double);
  vtkGetMacro(NumberOfRays, double);
  ///@}

 protected:
  vtkPlenoflameLightFieldSource();
  ~vtkPlenoflameLightFieldSource() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
                          vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int Samples = 0;
  vtkTypeInt64 Seed = -1;
  int Estimator = SCENE_ESTIMATOR;
  double TargetError = 0, TimeLimit = 0;
  int Window[4] = {0, 0, 0, 0};
  int NumberOfThreads = 0;
  bool StandardError = true;
  bool Truth = false;
  bool Complete = true;
  double RelativeError = -1, NumberOfRays = 0;

 private:
  vtkPlenoflameLightFieldSource(const vtkPlenoflameLightFieldSource&) = delete;
  void operator=(const vtkPlenoflameLightFieldSource&) = delete;
};

#endif
