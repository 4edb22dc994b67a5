/**
 * @class   vtkPlenoflameComparison
 * @brief   error and bias of one light field against another
 *
 * Inputs: the light field to judge (port 0), the one that it should equal (port 1). Update() makes
 * the figures.
 */
#ifndef vtkPlenoflameComparison_h
#define vtkPlenoflameComparison_h

#include <string>  // for names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

class VTKPLENOFLAME_EXPORT vtkPlenoflameComparison : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameComparison* New();
  vtkTypeMacro(vtkPlenoflameComparison, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Channel by its name; empty (default): the first of the reference.
   */
  vtkSetStdStringFromCharMacro(Channel);
  vtkGetCharFromStdStringMacro(Channel);
  ///@}

  /**
   * The figures of the last run by the names that `plenoflame compare --json` gives them.
   */
  vtkGetMacro(FiguresAsJson, std::string);

 protected:
  vtkPlenoflameComparison();
  ~vtkPlenoflameComparison() override = default;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  std::string Channel, FiguresAsJson;

 private:
  vtkPlenoflameComparison(const vtkPlenoflameComparison&) = delete;
  void operator=(const vtkPlenoflameComparison&) = delete;
};

#endif
