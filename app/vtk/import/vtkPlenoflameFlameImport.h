/**
 * @class   vtkPlenoflameFlameImport
 * @brief   a flame from a simulation, on voxels
 *
 * Reads what VTK reads (VTK XML, legacy and HDF, OpenFOAM, EnSight, PLOT3D, AMReX, CGNS, Exodus,
 * Tecplot, NetCDF; raw bricks with a JSON file) and samples it on a
 * regular lattice. Output: a vtkImageData with the float arrays "temperature" [K] and "absorption"
 * [1/m], as vtkPlenoflameFlameWriter writes it. Outside of the mesh absorption is 0; temperature
 * goes on for three voxels, so that interpolation mixes in none of the surroundings, and is ambient
 * beyond.
 */
#ifndef vtkPlenoflameFlameImport_h
#define vtkPlenoflameFlameImport_h

#include <string>  // for array names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameImportModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <functional>
#include <memory>
#endif

class VTKPLENOFLAMEIMPORT_EXPORT vtkPlenoflameFlameImport : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameFlameImport* New();
  vtkTypeMacro(vtkPlenoflameFlameImport, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The file, or the folder of an AMReX plotfile; and the solution (.q) of a PLOT3D grid.
   */
  vtkSetFilePathMacro(FileName);
  vtkGetFilePathMacro(FileName);
  vtkSetFilePathMacro(SolutionFileName);
  vtkGetFilePathMacro(SolutionFileName);
  ///@}

  ///@{
  /**
   * Array of the temperature (default: "T"), its unit "K" (default) or "degC", and a factor on its
   * values before that.
   */
  vtkSetStdStringFromCharMacro(TemperatureArray);
  vtkGetCharFromStdStringMacro(TemperatureArray);
  vtkSetStdStringFromCharMacro(TemperatureUnit);
  vtkGetCharFromStdStringMacro(TemperatureUnit);
  vtkSetMacro(TemperatureScale, double);
  vtkGetMacro(TemperatureScale, double);
  ///@}

  ///@{
  /**
   * Absorption, one of: an array and its unit "1/m" (default), "1/cm" or "1/mm"; an array of soot
   * volume fraction, kappa = 6 pi E(m) f_v / wavelength; a constant [1/m] within the mesh.
   */
  vtkSetStdStringFromCharMacro(AbsorptionArray);
  vtkGetCharFromStdStringMacro(AbsorptionArray);
  vtkSetStdStringFromCharMacro(AbsorptionUnit);
  vtkGetCharFromStdStringMacro(AbsorptionUnit);
  vtkSetStdStringFromCharMacro(SootArray);
  vtkGetCharFromStdStringMacro(SootArray);
  vtkSetMacro(ConstantAbsorption, double);
  vtkGetMacro(ConstantAbsorption, double);
  ///@}

  ///@{
  /**
   * Absorption function E(m) of soot (default: 0.26) and wavelength [m] (default: 650e-9).
   */
  vtkSetMacro(SootFunction, double);
  vtkGetMacro(SootFunction, double);
  vtkSetMacro(Wavelength, double);
  vtkGetMacro(Wavelength, double);
  ///@}

  ///@{
  /**
   * Edge of a voxel [m]; 0 (default): a 128th of the longest side, or the data's own lattice if it
   * has one.
   */
  vtkSetMacro(VoxelSize, double);
  vtkGetMacro(VoxelSize, double);
  ///@}

  ///@{
  /**
   * Part to import [m]: x low, x high, y low, ...; empty (default): all of the mesh.
   */
  vtkSetVector6Macro(Bounds, double);
  vtkGetVector6Macro(Bounds, double);
  ///@}

  ///@{
  /**
   * Metre per unit of the mesh (default: 1).
   */
  vtkSetMacro(LengthScale, double);
  vtkGetMacro(LengthScale, double);
  ///@}

  ///@{
  /**
   * Step of a series, from 0 (default). Their number and times are known once the file was opened.
   */
  vtkSetMacro(TimeStep, int);
  vtkGetMacro(TimeStep, int);
  int GetNumberOfTimeSteps();
  double GetTime(int step);
  ///@}

  ///@{
  /**
   * Temperature outside [K] (default: 293.15).
   */
  vtkSetMacro(AmbientTemperature, double);
  vtkGetMacro(AmbientTemperature, double);
  ///@}

#ifndef __VTK_WRAP__
  /**
   * Arrays of single numbers at the present step, with their ranges: name, lowest, highest, whether
   * of cells. Throws what is wrong with the file.
   */
  void ListArrays(const std::function<void(const std::string&, double, double, bool)>& take);
#endif

 protected:
  vtkPlenoflameFlameImport();
  ~vtkPlenoflameFlameImport() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  char* FileName = nullptr;
  char* SolutionFileName = nullptr;
  std::string TemperatureArray = "T", TemperatureUnit = "K", AbsorptionArray,
              AbsorptionUnit = "1/m", SootArray;
  double TemperatureScale = 1, ConstantAbsorption = 0, SootFunction = 0.26, Wavelength = 650e-9;
  double VoxelSize = 0, LengthScale = 1, AmbientTemperature = 293.15;
  double Bounds[6] = {0, 0, 0, 0, 0, 0};
  int TimeStep = 0;

 private:
  vtkPlenoflameFlameImport(const vtkPlenoflameFlameImport&) = delete;
  void operator=(const vtkPlenoflameFlameImport&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
  void Open();
  void Fill(vtkImageData* image);
};

#endif
