/**
 * @class   vtkPlenoflameViews
 * @brief   sub-aperture views of a light field
 *
 * Input: a light field (vtkPlenoflameLightFieldSource, vtkPlenoflameLightFieldReader). Output port
 * 0: a vtkMultiBlockDataSet with a vtkImageData for each view, row by row from the top left, named
 * "view_ROW_COLUMN"; array "radiance" [W/(m^2 sr)], or "flux" [W]. Port 1: all of them side by
 * side.
 */
#ifndef vtkPlenoflameViews_h
#define vtkPlenoflameViews_h

#include <string>  // for channel names

#include "vtkMultiBlockDataSetAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <memory>
#endif

class vtkImageData;

class VTKPLENOFLAME_EXPORT vtkPlenoflameViews : public vtkMultiBlockDataSetAlgorithm {
 public:
  static vtkPlenoflameViews* New();
  vtkTypeMacro(vtkPlenoflameViews, vtkMultiBlockDataSetAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum ResamplingType { NEAREST = 0, BARYCENTRIC = 1, PAPER9 = 2, PAPER10 = 3 };

  ///@{
  /**
   * Views along each side (default: 7).
   */
  vtkSetClampMacro(Grid, int, 1, 99);
  vtkGetMacro(Grid, int);
  ///@}

  ///@{
  /**
   * Side of the square that the views cover, in diameters of a micro-image, 0 to 1 (default: 0.7).
   */
  vtkSetMacro(Spread, double);
  vtkGetMacro(Spread, double);
  ///@}

  ///@{
  /**
   * From microlenses to square pixels (default: BARYCENTRIC).
   */
  vtkSetClampMacro(Resampling, int, NEAREST, PAPER10);
  vtkGetMacro(Resampling, int);
  ///@}

  ///@{
  /**
   * Whether vignetting is corrected (default: on), so that values are radiances.
   */
  vtkSetMacro(WhiteCorrection, bool);
  vtkGetMacro(WhiteCorrection, bool);
  vtkBooleanMacro(WhiteCorrection, bool);
  ///@}

  ///@{
  /**
   * Channel by its name; empty (default): the first.
   */
  vtkSetStdStringFromCharMacro(Channel);
  vtkGetCharFromStdStringMacro(Channel);
  ///@}

  ///@{
  /**
   * Worker threads; 0 (default): one per processor.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  /**
   * All views side by side: output port 1.
   */
  vtkImageData* GetContactSheet();

 protected:
  vtkPlenoflameViews();
  ~vtkPlenoflameViews() override;

  int FillInputPortInformation(int port, vtkInformation* information) override;
  int FillOutputPortInformation(int port, vtkInformation* information) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
                         vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  int Grid = 7;
  double Spread = 0.7;
  int Resampling = BARYCENTRIC;
  bool WhiteCorrection = true;
  std::string Channel;
  int NumberOfThreads = 0;

 private:
  vtkPlenoflameViews(const vtkPlenoflameViews&) = delete;
  void operator=(const vtkPlenoflameViews&) = delete;

  struct Internals;
  std::unique_ptr<Internals> Internal;
  bool Make(vtkImageData& sheet);
};

#endif
