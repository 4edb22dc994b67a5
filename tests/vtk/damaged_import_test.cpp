// Damaged files of simulations end in one line, or in a flame that is consistent. VTK's readers
// stop the process for very few of them, which is why each is read by a process of its own, and
// those are counted. PLENOFLAME_DAMAGED_FILES=10000 tries so many of each kind; those that end
// otherwise are kept in the folder PLENOFLAME_KEEP_DAMAGED.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include "events.h"
#include "support/damaged_files.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameFlameImport.h"

namespace plenoflame::test::damaged_import_test {
namespace {

template <class Grid>
void add_fields(Grid& grid) {
  vtkNew<vtkDoubleArray> hot, soot;
  hot->SetName("T");
  soot->SetName("fv");
  for (vtkIdType i = 0; i < grid.GetNumberOfPoints(); ++i) {
    hot->InsertNextValue(1500.0 + static_cast<double>(i));
    soot->InsertNextValue(1e-6);
  }
  grid.GetPointData()->AddArray(hot);
  grid.GetPointData()->AddArray(soot);
}

enum class Coding { ascii, binary, appended };

template <class Writer, class Grid>
std::string written(Grid& grid, const std::string& path, Coding coding) {
  vtkNew<Writer> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(&grid);
  if (coding == Coding::ascii) writer->SetDataModeToAscii();
  if (coding == Coding::binary) writer->SetDataModeToBinary();
  if (coding == Coding::appended) writer->SetDataModeToAppended();
  EXPECT_EQ(writer->Write(), 1);
  return read_bytes(path);
}

std::string tetrahedra(const std::string& path, Coding coding) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  for (int k = 0; k < 8; ++k)
    points->InsertNextPoint(0.02 * (k & 1), 0.02 * (k >> 1 & 1), 0.02 * (k >> 2));
  grid->SetPoints(points);
  constexpr std::array<std::array<vtkIdType, 4>, 6> cells{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  for (const auto& cell : cells) grid->InsertNextCell(VTK_TETRA, 4, cell.data());
  add_fields(*grid);
  return written<vtkXMLUnstructuredGridWriter>(*grid, path, coding);
}

std::string lattice(const std::string& path, Coding coding) {
  vtkNew<vtkImageData> grid;
  grid->SetDimensions(5, 4, 6);
  grid->SetSpacing(0.004, 0.004, 0.004);
  add_fields(*grid);
  return written<vtkXMLImageDataWriter>(*grid, path, coding);
}

/// Exit status of a process of its own.
enum Result { kRead = 0, kRefused = 1, kInconsistent = 2, kUnclear = 3 };

/// Reads the file in a process of its own, with limits on memory and time.
/// @return how that ended: a Result, or minus the signal that ended it
int read_apart(const std::string& path) {
  const pid_t process = fork();
  if (process == 0) {
    const struct rlimit memory { rlim_t{4} << 30, rlim_t{4} << 30 };
#ifndef __SANITIZE_ADDRESS__  // which takes the whole address space for itself
    setrlimit(RLIMIT_AS, &memory);
#endif
    alarm(60);
    vtkNew<vtkPlenoflameFlameImport> import;
    const Events errors(import), of_executive(import->GetExecutive());
    import->SetFileName(path.c_str());
    import->SetSootArray("fv");
    import->SetVoxelSize(2e-3);
    import->Update();
    if (errors.size() > 0 || of_executive.size() > 0)
      _exit(errors.all().empty() && of_executive.all().empty() ? kUnclear : kRefused);
    vtkImageData* const image = import->GetOutput();
    vtkDataArray* const hot = image->GetPointData()->GetArray("temperature");
    if (!hot || hot->GetNumberOfTuples() != image->GetNumberOfPoints()) _exit(kInconsistent);
    for (vtkIdType i = 0; i < hot->GetNumberOfTuples(); ++i)
      if (!std::isfinite(hot->GetTuple1(i)) || hot->GetTuple1(i) < 0) _exit(kInconsistent);
    _exit(kRead);
  }
  int status = 0;
  waitpid(process, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

void try_damaged(const char* ending, std::string (*sample)(const std::string&, Coding)) {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string("a.") + ending);
  std::vector<std::string> samples;
  for (const Coding coding : {Coding::ascii, Coding::binary, Coding::appended}) {
    samples.push_back(sample(path, coding));
    ASSERT_EQ(read_apart(path), kRead);
  }
  std::vector<std::string> words = awkward_words();
  words.insert(words.end(), {"<Piece ", "/>", "</DataArray>", "Float32", "UInt8", "1000000000000"});
  std::mt19937_64 random(20261134);
  const int files = damaged_files_wanted(150);
  int read = 0, refused = 0, stopped = 0;
  for (int n = 0; n < files; ++n) {
    write_bytes(path, damage_text(samples[static_cast<std::size_t>(n) % 3], words, random));
    const int result = read_apart(path);
    read += result == kRead;
    refused += result == kRefused;
    stopped += result < 0;
    if (result == kRead || result == kRefused) continue;
    EXPECT_LT(result, 0) << "file " << n << " of ." << ending;
    if (const char* keep = std::getenv("PLENOFLAME_KEEP_DAMAGED"))  // NOLINT(concurrency-mt-unsafe)
      std::filesystem::copy_file(path,
                                 std::string(keep) + "/" + std::to_string(n) + "_" +
                                     std::to_string(-result) + "." + ending,
                                 std::filesystem::copy_options::overwrite_existing);
  }
  std::printf("simulations (.%s): %d files, %d read, %d refused, %d stopped the process\n", ending,
              files, read, refused, stopped);
  EXPECT_LE(stopped, files / 500);
  EXPECT_GE(read, files / 20);
  EXPECT_GE(refused, files / 5);
}

TEST(DamagedImport, UnstructuredGrids) {
  try_damaged("vtu", tetrahedra);
}

TEST(DamagedImport, Images) {
  try_damaged("vti", lattice);
}

}  // namespace
}  // namespace plenoflame::test::damaged_import_test
