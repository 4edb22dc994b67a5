#pragma once
#include <vtkSmartPointer.h>

#include <memory>
#include <string>
#include <vector>

#include "watched_algorithm.h"

class vtkAlgorithm;
class vtkDataSet;

namespace plenoflame::simulation {

/// Any file of a simulation that VTK reads, and series of them in a .pvd file.
class SimulationReader {
 public:
  /// Chooses the reader by the name's ending; a folder with a file Header is an AMReX plotfile.
  /// @param second a further file that the format needs: the solution (.q) of a PLOT3D grid
  /// @throws FileError (not there), InputError (no reader for this ending; lists those there are)
  SimulationReader(const std::string& path, const std::string& second);
  ~SimulationReader();

  /// Times of the steps in the file; a single 0 without times.
  const std::vector<double>& times() const { return times_; }
  /// The parts of the mesh at a step, the finest cells first. @throws InputError, Cancelled
  std::vector<vtkSmartPointer<vtkDataSet>> read(std::size_t step, const Watcher& watcher);
  /// "OpenFOAM".
  const std::string& format() const { return format_; }

 private:
  std::string path_, format_;
  vtkSmartPointer<vtkAlgorithm> reader_;
  std::vector<std::vector<std::string>> series_;  ///< files of each step of a .pvd
  vtkSmartPointer<vtkDataSet> raw_;
  std::vector<double> times_;
  class ErrorLog;
  std::unique_ptr<ErrorLog> errors_;
};

}  // namespace plenoflame::simulation
