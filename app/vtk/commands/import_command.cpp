#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkExecutive.h>
#include <vtkNew.h>

#include <cstdio>
#include <filesystem>

#include "error_log.h"
#include "plenoflame/image/atomic_file.h"
#include "vtkPlenoflameFlameImport.h"
#include "vtkPlenoflameFlameWriter.h"
#include "vtk_commands.h"

namespace plenoflame {
namespace {

constexpr double kReading = 0.9;  ///< of the work on one flame, the rest is writing

/// "flame.vdb" -> "flame_0003.vdb".
std::string numbered(const std::string& path, int number) {
  const std::filesystem::path p(path);
  char digits[16];
  std::snprintf(digits, sizeof digits, "_%04d", number);
  return (p.parent_path() / (p.stem().string() + digits + p.extension().string())).string();
}

/// Passes the progress of an algorithm on, and the wish to stop the other way.
class ProgressWatch {
 public:
  ProgressWatch(const Execution& execution, vtkAlgorithm& algorithm) : execution_(execution) {
    callback_->SetClientData(this);
    callback_->SetCallback([](vtkObject* caller, unsigned long, void* self, void* fraction) {
      const auto& watch = *static_cast<ProgressWatch*>(self);
      if (watch.execution_.stop.stop_requested())
        static_cast<vtkAlgorithm*>(caller)->AbortExecuteOn();
      if (!watch.execution_.progress) return;
      Progress progress;
      progress.fraction = watch.from_ + (watch.to_ - watch.from_) * *static_cast<double*>(fraction);
      watch.execution_.progress(progress);
    });
    algorithm.AddObserver(vtkCommand::ProgressEvent, callback_);
  }
  /// Sets the share of the whole that the algorithm's next run is.
  void stand_for(double from, double to) {
    from_ = from;
    to_ = to;
  }

 private:
  const Execution& execution_;
  vtkNew<vtkCallbackCommand> callback_;
  double from_ = 0, to_ = 1;
};

}  // namespace
}  // namespace plenoflame

extern "C" __attribute__((visibility("default"))) void plenoflame_import_flames(
    const plenoflame::FlameImportRequest& request, const plenoflame::Execution& execution,
    std::vector<plenoflame::ImportedFlame>& written) {
  using namespace plenoflame;
  using namespace plenoflame;
  int number = 0;
  for (const std::string& file : request.files) {
    ErrorLog log(execution);
    vtkNew<vtkPlenoflameFlameImport> source;
    log.watch(source);
    log.watch(source->GetExecutive());
    ProgressWatch watch(execution, *source);
    source->SetFileName(file.c_str());
    if (!request.solution.empty()) source->SetSolutionFileName(request.solution.c_str());
    source->SetTemperatureArray(request.temperature.c_str());
    source->SetTemperatureUnit(request.temperature_unit.c_str());
    source->SetTemperatureScale(request.temperature_scale);
    source->SetAbsorptionArray(request.absorption.c_str());
    source->SetAbsorptionUnit(request.absorption_unit.c_str());
    source->SetSootArray(request.soot.c_str());
    source->SetConstantAbsorption(request.constant);
    source->SetSootFunction(request.soot_function);
    source->SetWavelength(request.wavelength);
    source->SetVoxelSize(request.voxel_size);
    source->SetLengthScale(request.length_scale);
    auto bounds = request.bounds;
    source->SetBounds(bounds.data());
    const int steps = source->GetNumberOfTimeSteps();
    log.check();
    if (request.step >= steps)
      throw UsageError("--step: '" + file + "' has " + std::to_string(steps) +
                       " time steps, counted from 0");
    const bool series = request.files.size() > 1 || (steps > 1 && request.step < 0);
    const int first = request.step < 0 ? 0 : request.step;
    const int last = request.step < 0 ? steps - 1 : request.step;
    for (int step = first; step <= last; ++step) {
      const std::string output = series ? numbered(request.output, number++) : request.output;
      check_writable(output);
      source->SetTimeStep(step);
      const double flames = static_cast<double>(request.files.size()) * (last - first + 1);
      const auto whole = [&, done = static_cast<double>(written.size())](double share) {
        return (done + share) / flames;
      };
      watch.stand_for(whole(0), whole(kReading));
      source->Update();
      log.check();
      if (execution.stop.stop_requested()) throw Cancelled();
      vtkNew<vtkPlenoflameFlameWriter> writer;
      log.watch(writer);
      writer->SetInputConnection(source->GetOutputPort());
      writer->SetFileName(output.c_str());
      writer->SetHalf(request.half);
      ProgressWatch watch_writing(execution, *writer);
      watch_writing.stand_for(whole(kReading), whole(1));
      const bool is_written = writer->Write();
      log.check();
      if (!is_written) throw Cancelled();
      written.push_back({output, source->GetTime(step)});
    }
  }
}

extern "C" __attribute__((visibility("default"))) void plenoflame_list_simulation_arrays(
    const std::string& file, const plenoflame::Execution& execution,
    std::vector<plenoflame::SimulationArray>& arrays) {
  using namespace plenoflame;
  ErrorLog log(execution);
  vtkNew<vtkPlenoflameFlameImport> source;
  log.watch(source);
  ProgressWatch watch(execution, *source);
  source->SetFileName(file.c_str());
  source->ListArrays([&](const std::string& name, double lowest, double highest, bool of_cells) {
    arrays.push_back({name, lowest, highest, of_cells});
  });
}
