/**
 * @class   vtkPlenoflameExport
 * @brief   writes a light field as the files of another tool
 *
 * Input: a light field. Update() writes the files into a folder, all of them or none; progress
 * events and errors as those of a filter. The formats are those of `plenoflame export`.
 */
#ifndef vtkPlenoflameExport_h
#define vtkPlenoflameExport_h

#include <string>  // for names

#include "vtkImageAlgorithm.h"
#include "vtkPlenoflameModule.h"  // for export macro

#ifndef __VTK_WRAP__
#include <vector>
#endif

class VTKPLENOFLAME_EXPORT vtkPlenoflameExport : public vtkImageAlgorithm {
 public:
  static vtkPlenoflameExport* New();
  vtkTypeMacro(vtkPlenoflameExport, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Folder for the files; made when missing, else it must be empty.
   */
  vtkSetStdStringFromCharMacro(Folder);
  vtkGetCharFromStdStringMacro(Folder);
  ///@}

  ///@{
  /**
   * Name of the format (default: npz).
   */
  vtkSetStdStringFromCharMacro(Format);
  vtkGetCharFromStdStringMacro(Format);
  ///@}

  ///@{
  /**
   * Stem of the files' names (default: lightfield).
   */
  vtkSetStdStringFromCharMacro(Stem);
  vtkGetCharFromStdStringMacro(Stem);
  ///@}

  ///@{
  /**
   * Views along each side, for formats of views; 0 (default): as the tool expects.
   */
  vtkSetMacro(Grid, int);
  vtkGetMacro(Grid, int);
  ///@}

  ///@{
  /**
   * Channel of grey pictures by its name; empty (default): the first.
   */
  vtkSetStdStringFromCharMacro(Channel);
  vtkGetCharFromStdStringMacro(Channel);
  ///@}

  ///@{
  /**
   * Channels of red, green and blue of colour pictures, with commas between; empty (default): the
   * scene's colour channels, where it has some, no Channel is set and the tool knows colour.
   */
  vtkSetStdStringFromCharMacro(Channels);
  vtkGetCharFromStdStringMacro(Channels);
  ///@}

  ///@{
  /**
   * Names of all formats.
   */
  static int GetNumberOfFormats();
  static std::string GetFormatName(int i);
  ///@}

  ///@{
  /**
   * Of the last run: names of the files within the folder, and what the user should know.
   */
  int GetNumberOfFiles();
  std::string GetWrittenFile(int i);
  int GetNumberOfNotes();
  std::string GetNote(int i);
  ///@}

 protected:
  vtkPlenoflameExport();
  ~vtkPlenoflameExport() override = default;

  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
                  vtkInformationVector* outputs) override;

  std::string Folder, Format = "npz", Stem = "lightfield", Channel, Channels;
  int Grid = 0;

 private:
  vtkPlenoflameExport(const vtkPlenoflameExport&) = delete;
  void operator=(const vtkPlenoflameExport&) = delete;

#ifndef __VTK_WRAP__
  std::vector<std::string> Files, Notes;
#endif
};

#endif
