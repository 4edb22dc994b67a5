#include "simulation_reader.h"

#include <vtkAMReXGridReader.h>
#include <vtkAlgorithm.h>
#include <vtkCGNSReader.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkCompositeDataIterator.h>
#include <vtkCompositeDataSet.h>
#include <vtkDataSet.h>
#include <vtkExecutive.h>
#include <vtkExodusIIReader.h>
#include <vtkGenericDataObjectReader.h>
#include <vtkGenericEnSightReader.h>
#include <vtkHDFReader.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkLogger.h>
#include <vtkMultiBlockPLOT3DReader.h>
#include <vtkNetCDFCFReader.h>
#include <vtkNew.h>
#include <vtkOpenFOAMReader.h>
#include <vtkOutputWindow.h>
#include <vtkPlot3DMetaReader.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkStringOutputWindow.h>
#include <vtkTecplotReader.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLGenericDataObjectReader.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "raw_bricks.h"

namespace plenoflame::simulation {
namespace {

/// Wants every array that the reader knows, whatever its functions for that are called.
template <class Reader>
void want_all_arrays(Reader& reader) {
  if constexpr (requires { reader.EnableAllCellArrays(); }) reader.EnableAllCellArrays();
  if constexpr (requires { reader.EnableAllPointArrays(); }) reader.EnableAllPointArrays();
  if constexpr (requires {
                  reader.GetNumberOfCellArrays();
                  reader.SetCellArrayStatus("", 1);
                })
    for (int i = 0; i < reader.GetNumberOfCellArrays(); ++i)
      reader.SetCellArrayStatus(reader.GetCellArrayName(i), 1);
  if constexpr (requires {
                  reader.GetNumberOfPointArrays();
                  reader.SetPointArrayStatus("", 1);
                })
    for (int i = 0; i < reader.GetNumberOfPointArrays(); ++i)
      reader.SetPointArrayStatus(reader.GetPointArrayName(i), 1);
}

using Maker = std::function<vtkSmartPointer<vtkAlgorithm>(const std::string& path,
                                                          const std::string& second)>;

template <class Reader>
Maker maker(void (*prepare)(Reader&) = nullptr) {
  return [prepare](const std::string& path, const std::string&) {
    const auto reader = vtkSmartPointer<Reader>::New();
    if constexpr (requires { reader->SetCaseFileName(""); })
      reader->SetCaseFileName(path.c_str());
    else
      reader->SetFileName(path.c_str());
    if (prepare) prepare(*reader);
    reader->UpdateInformation();
    want_all_arrays(*reader);
    return vtkSmartPointer<vtkAlgorithm>(reader);
  };
}

vtkSmartPointer<vtkAlgorithm> plot3d(const std::string& path, const std::string& second) {
  if (second.empty())
    throw UsageError("'" + path + "' is a grid of PLOT3D: name the file of its solution (.q), too");
  const auto reader = vtkSmartPointer<vtkMultiBlockPLOT3DReader>::New();
  reader->SetXYZFileName(path.c_str());
  reader->SetQFileName(second.c_str());
  reader->AutoDetectFormatOn();
  reader->RemoveAllFunctions();
  for (const int function : {100, 110, 120}) reader->AddFunction(function);  // density, pressure, T
  return reader;
}

vtkSmartPointer<vtkAlgorithm> plot3d_metadata(const std::string& path, const std::string&) {
  const auto reader = vtkSmartPointer<vtkPlot3DMetaReader>::New();
  // It looks for the files that are named in the root folder when its own path has no folder.
  reader->SetFileName(std::filesystem::absolute(path).c_str());
  return reader;
}

struct Format {
  const char* name;
  std::vector<const char*> endings;
  Maker make;
};

std::vector<Format> formats() {
  return {
      {"VTK XML",
       {".vti", ".vtr", ".vts", ".vtu", ".vtm", ".pvti", ".pvtr", ".pvts", ".pvtu", ".vth"},
       maker<vtkXMLGenericDataObjectReader>()},
      {"VTK legacy", {".vtk"}, maker<vtkGenericDataObjectReader>()},
      {"OpenFOAM",
       {".foam", ".openfoam", "controlDict"},
       maker<vtkOpenFOAMReader>([](vtkOpenFOAMReader& r) { r.CreateCellToPointOn(); })},
      {"EnSight", {".case", ".encas"}, maker<vtkGenericEnSightReader>()},
      {"PLOT3D", {".xyz", ".x", ".grd"}, plot3d},
      {"PLOT3D with metadata", {".p3d"}, plot3d_metadata},
      {"CGNS", {".cgns"}, maker<vtkCGNSReader>([](vtkCGNSReader& r) {
         r.UpdateInformation();
         r.EnableAllBases();
       })},
      {"Exodus",
       {".e", ".exo", ".ex2", ".exii"},
       maker<vtkExodusIIReader>([](vtkExodusIIReader& r) {
         r.UpdateInformation();
         r.SetAllArrayStatus(vtkExodusIIReader::NODAL, 1);
         r.SetAllArrayStatus(vtkExodusIIReader::ELEM_BLOCK, 1);
       })},
      {"VTK HDF", {".hdf", ".vtkhdf"}, maker<vtkHDFReader>()},
      {"Tecplot", {".tec", ".dat", ".tp"}, maker<vtkTecplotReader>()},
      {"NetCDF", {".nc", ".ncdf"}, maker<vtkNetCDFCFReader>()},
  };
}

/// Formats that people try and this VTK has no reader for: what to do instead.
void refuse_unreadable(const std::string& path) {
  const auto refuse = [&](const std::string& what) { throw InputError("'" + path + "': " + what); };
  if (path.ends_with(".xdmf") || path.ends_with(".xmf"))
    refuse(
        "VTK is built without a reader of Xdmf here; save the data as .vtu, .vtm or .pvd (in "
        "ParaView: File, Save Data)");
  if (path.ends_with(".cas.h5") || path.ends_with(".dat.h5") || path.ends_with(".cas"))
    refuse("Fluent's own files are not read; export from Fluent as CGNS or EnSight");
  if (path.ends_with(".h5"))
    refuse(
        "files of CONVERGE are not read; export as EnSight, or save the data as .vtu or .vtm (in "
        "ParaView: File, Save Data)");
}

/// The steps of a .pvd file: its files by time, those of one time together.
std::map<double, std::vector<std::string>> read_series(const std::string& path) {
  std::istringstream text(read_file(path));
  vtkNew<vtkXMLDataParser> parser;
  vtkNew<vtkCallbackCommand> silent;  // what is wrong with the XML is said below
  silent->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  parser->AddObserver(vtkCommand::ErrorEvent, silent);
  parser->SetStream(&text);
  vtkXMLDataElement* const root = parser->Parse() ? parser->GetRootElement() : nullptr;
  vtkXMLDataElement* const collection =
      root ? root->FindNestedElementWithName("Collection") : nullptr;
  if (!collection) throw InputError("'" + path + "' is no .pvd file: it has no Collection");
  std::map<double, std::vector<std::string>> steps;
  for (int i = 0; i < collection->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* const entry = collection->GetNestedElement(i);
    if (!entry->GetName() || std::string(entry->GetName()) != "DataSet") continue;
    const char* const file = entry->GetAttribute("file");
    double time = 0;
    const bool timed = entry->GetAttribute("timestep");
    if (!file || (timed && entry->GetScalarAttribute("timestep", time) == 0))
      throw InputError("'" + path + "': DataSet " + std::to_string(i) +
                       " of its Collection has no file, or a timestep that is no number");
    if (std::string(file).ends_with(".pvd"))
      throw InputError("'" + path + "': its Collection names another one, '" + file + "'");
    steps[time].push_back((std::filesystem::path(path).parent_path() / file).string());
  }
  if (steps.empty()) throw InputError("'" + path + "': its Collection names no files");
  return steps;
}

double cell_size(vtkDataSet& data) {
  return data.GetNumberOfCells() > 0
             ? data.GetLength() / std::cbrt(static_cast<double>(data.GetNumberOfCells()))
             : 0;
}

void sort_by_cell_size(std::vector<vtkSmartPointer<vtkDataSet>>& parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return cell_size(*a) < cell_size(*b); });
}

}  // namespace

/// Keeps VTK's error messages from the terminal, for one of our own.
class SimulationReader::ErrorLog {
 public:
  ErrorLog() {
    callback_->SetClientData(this);
    callback_->SetCallback([](vtkObject*, unsigned long, void* self, void* text) {
      auto& log = *static_cast<ErrorLog*>(self);
      if (log.first_.empty()) log.first_ = static_cast<const char*>(text);
    });
  }
  void watch(vtkAlgorithm& reader) {
    reader.AddObserver(vtkCommand::ErrorEvent, callback_);
    reader.GetExecutive()->AddObserver(vtkCommand::ErrorEvent, callback_);
  }
  /// Keeps the messages of readers within the reader, which have no observer.
  void add(const std::string& output) {
    if (const auto at = output.find("ERROR:"); first_.empty() && at != std::string::npos)
      first_ = output.substr(at);
  }
  /// @throws InputError when there was an error
  void check(const std::string& path, const std::string& format) const {
    if (first_.empty()) return;
    std::string text = first_;
    if (const auto at = text.find("): "); at != std::string::npos) text = text.substr(at + 3);
    text = text.substr(0, text.find('\n'));
    throw InputError("'" + path + "' cannot be read as " + format + ": " + text);
  }

 private:
  vtkNew<vtkCallbackCommand> callback_;
  std::string first_;
};

namespace {

/// Collects what VTK would print, as long as it lives.
class CollectedOutput {
 public:
  CollectedOutput() {
    vtkOutputWindow::SetInstance(window_);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~CollectedOutput() {
    vtkLogger::SetStderrVerbosity(verbosity_);
    vtkOutputWindow::SetInstance(before_);
  }
  CollectedOutput(const CollectedOutput&) = delete;
  CollectedOutput& operator=(const CollectedOutput&) = delete;
  std::string text() { return window_->GetOutput(); }

 private:
  vtkSmartPointer<vtkOutputWindow> before_ = vtkOutputWindow::GetInstance();
  vtkLogger::Verbosity verbosity_ = vtkLogger::GetCurrentVerbosityCutoff();
  vtkNew<vtkStringOutputWindow> window_;
};

}  // namespace

SimulationReader::SimulationReader(const std::string& path, const std::string& second)
    : path_(path), errors_(std::make_unique<ErrorLog>()) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::exists(path, error))
    throw FileError("cannot read '" + path + "': No such file or folder");
  times_ = {0};
  if (path.ends_with(".json")) {
    format_ = "raw bricks";
    raw_ = read_raw_bricks(path);
    return;
  }
  if (path.ends_with(".pvd")) {
    format_ = "ParaView collection";
    times_.clear();
    for (auto& [time, files] : read_series(path)) {
      times_.push_back(time);
      series_.push_back(std::move(files));
    }
    return;
  }
  refuse_unreadable(path);
  CollectedOutput output;
  if (fs::is_directory(path, error)) {
    if (!fs::exists(fs::path(path) / "Header", error))
      throw InputError("'" + path +
                       "' is a folder without a file Header, and so no AMReX plotfile");
    format_ = "AMReX";
    const auto reader = vtkSmartPointer<vtkAMReXGridReader>::New();
    errors_->watch(*reader);
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    reader->SetMaxLevel(1 << 20);
    want_all_arrays(*reader);
    reader_ = reader;
  } else {
    std::string known;
    for (const Format& format : formats())
      for (const char* ending : format.endings) {
        if (!known.empty()) known += ' ';
        known += ending;
        if (reader_ || !path.ends_with(ending)) continue;
        format_ = format.name;
        reader_ = format.make(path, second);
      }
    if (!reader_)
      throw InputError("'" + path + "': there is no reader for this ending; known are " + known +
                       ", .pvd (series), .json (raw bricks) and the folder of an AMReX plotfile");
    errors_->watch(*reader_);
  }
  reader_->UpdateInformation();
  errors_->add(output.text());
  errors_->check(path_, format_);
  vtkInformation* const information = reader_->GetOutputInformation(0);
  if (information->Has(vtkStreamingDemandDrivenPipeline::TIME_STEPS()))
    times_.assign(information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS()),
                  information->Get(vtkStreamingDemandDrivenPipeline::TIME_STEPS()) +
                      information->Length(vtkStreamingDemandDrivenPipeline::TIME_STEPS()));
}

SimulationReader::~SimulationReader() = default;

std::vector<vtkSmartPointer<vtkDataSet>> SimulationReader::read(std::size_t step,
                                                                const Watcher& watcher) {
  if (step >= times_.size())
    throw InputError("'" + path_ + "' has " + std::to_string(times_.size()) +
                     " time steps; there is no step " + std::to_string(step) + " (counted from 0)");
  std::vector<vtkSmartPointer<vtkDataSet>> parts;
  if (raw_) return {raw_};
  if (!series_.empty()) {
    double done = 0;
    const auto count = static_cast<double>(series_[step].size());
    for (const std::string& file : series_[step]) {
      const auto part_watcher = [&](double part) { return watcher((done + part) / count); };
      for (auto& part : SimulationReader(file, "").read(0, part_watcher))
        parts.push_back(std::move(part));
      ++done;
    }
    sort_by_cell_size(parts);
    return parts;
  }
  {
    CollectedOutput output;
    update_watched(*reader_, watcher, [&] {
      if (times_.size() > 1)
        reader_->UpdateTimeStep(times_[step]);
      else
        reader_->Update();
    });
    errors_->add(output.text());
  }
  errors_->check(path_, format_);
  vtkDataObject* const output = reader_->GetOutputDataObject(0);
  if (auto* const single = vtkDataSet::SafeDownCast(output)) {
    parts.emplace_back(single);
  } else if (auto* const many = vtkCompositeDataSet::SafeDownCast(output)) {
    const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(many->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
      if (auto* const leaf = vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject()))
        parts.emplace_back(leaf);
  }
  if (parts.empty()) throw InputError("'" + path_ + "' holds no mesh");
  sort_by_cell_size(parts);
  return parts;
}

}  // namespace plenoflame::simulation
