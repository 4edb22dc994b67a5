// Flames from simulations in C++: an analytic field on tetrahedra comes back exactly.
#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkCellType.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include "events.h"
#include "support/approx.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameFlameImport.h"

namespace plenoflame::test::flame_import_test {
namespace {

constexpr double kSide = 0.02;

double temperature_at(const double* p) {
  return 1500 + 8000 * p[0] - 6000 * p[1] + 3000 * p[2];
}
double soot_at(const double* p) {
  return 2e-6 + 3e-5 * p[0] + 1e-5 * p[1] + 2e-5 * p[2];
}

/// A cube of six tetrahedra around its diagonal, with linear fields.
void write_cube(const std::string& path) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> hot, soot;
  hot->SetName("T");
  soot->SetName("fv");
  for (int k = 0; k < 8; ++k) {
    const double p[3] = {kSide * (k & 1), kSide * (k >> 1 & 1), kSide * (k >> 2)};
    points->InsertNextPoint(p);
    hot->InsertNextValue(temperature_at(p));
    soot->InsertNextValue(soot_at(p));
  }
  grid->SetPoints(points);
  constexpr std::array<std::array<vtkIdType, 4>, 6> cells{
      {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};
  for (const auto& cell : cells) grid->InsertNextCell(VTK_TETRA, 4, cell.data());
  grid->GetPointData()->AddArray(hot);
  grid->GetPointData()->AddArray(soot);
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName(path.c_str());
  writer->SetInputData(grid);
  ASSERT_EQ(writer->Write(), 1);
}

class FlameImport : public ::testing::Test {
 protected:
  FlameImport() {
    write_cube(folder_.file("cube.vtu"));
    import_->SetFileName(folder_.file("cube.vtu").c_str());
    import_->SetSootArray("fv");
    import_->SetVoxelSize(1.1e-3);
  }
  TemporaryFolder folder_;
  vtkNew<vtkPlenoflameFlameImport> import_;
};

TEST_F(FlameImport, LinearFieldIsExact) {
  import_->Update();
  vtkImageData* const image = import_->GetOutput();
  vtkDataArray* const hot = image->GetPointData()->GetArray("temperature");
  vtkDataArray* const kappa = image->GetPointData()->GetArray("absorption");
  ASSERT_TRUE(hot && kappa);
  int inside = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
    double p[3];
    image->GetPoint(i, p);
    bool within = true;
    for (const double x : p) within = within && x > 1e-5 && x < kSide - 1e-5;
    if (!within) continue;
    ++inside;
    ASSERT_TRUE(relative(hot->GetTuple1(i), temperature_at(p), 1e-6));
    // kappa = 6 pi E(m) f_v / wavelength with the defaults 0.26 and 650 nm.
    ASSERT_TRUE(
        relative(kappa->GetTuple1(i), 6 * std::acos(-1.0) * 0.26 * soot_at(p) / 650e-9, 1e-6));
  }
  EXPECT_GT(inside, 4000);
}

/// Aborts an algorithm as soon as it tells more progress than that.
class AbortBeyond {
 public:
  AbortBeyond(vtkAlgorithm* algorithm, double fraction)
      : algorithm_(algorithm), fraction_(fraction) {
    callback_->SetClientData(this);
    callback_->SetCallback([](vtkObject* caller, unsigned long, void* self, void* progress) {
      auto& watch = *static_cast<AbortBeyond*>(self);
      watch.told_.push_back(*static_cast<double*>(progress));
      if (watch.told_.back() > watch.fraction_)
        static_cast<vtkAlgorithm*>(caller)->AbortExecuteOn();
    });
    algorithm->AddObserver(vtkCommand::ProgressEvent, callback_);
  }
  ~AbortBeyond() { leave(); }
  AbortBeyond(const AbortBeyond&) = delete;
  AbortBeyond& operator=(const AbortBeyond&) = delete;
  void leave() { algorithm_->RemoveObserver(callback_); }
  const std::vector<double>& told() const { return told_; }

 private:
  vtkNew<vtkCallbackCommand> callback_;
  vtkAlgorithm* algorithm_;
  double fraction_;
  std::vector<double> told_;
};

TEST_F(FlameImport, StopsWhereItIsAborted) {
  // A moment after the file was read: what follows comes to its next look at the flag.
  AbortBeyond watch(import_, 0.2);
  const Events errors(import_), of_executive(import_->GetExecutive());
  import_->Update();
  EXPECT_EQ(errors.size(), 0U) << errors.all();
  EXPECT_EQ(import_->GetOutput()->GetNumberOfPoints(), 0);
  ASSERT_FALSE(watch.told().empty());
  EXPECT_GT(watch.told().back(), 0.2);
  EXPECT_LE(watch.told().back(), 0.6);  // where the second array begins
  // An output that was stopped is not up to date.
  watch.leave();
  import_->Update();
  EXPECT_EQ(errors.size(), 0U) << errors.all();
  EXPECT_GT(import_->GetOutput()->GetNumberOfPoints(), 0);
}

TEST_F(FlameImport, StopsAmidTheSamplingOfAnArray) {
  import_->SetVoxelSize(kSide / 96);
  AbortBeyond watch(import_, 0.3);
  import_->Update();
  EXPECT_EQ(import_->GetOutput()->GetNumberOfPoints(), 0);
  ASSERT_FALSE(watch.told().empty());
  EXPECT_GT(watch.told().back(), 0.3);
  EXPECT_LT(watch.told().back(), 0.5);  // the first array takes from 0.2 to 0.6
}

// Large lattices are sampled in several goes: no layer is left out, doubled or moved.
TEST_F(FlameImport, LinearFieldIsExactOnManyVoxels) {
  import_->SetVoxelSize(kSide / 96);
  import_->Update();
  vtkImageData* const image = import_->GetOutput();
  ASSERT_EQ(image->GetNumberOfPoints(), 102 * 102 * 102);
  vtkDataArray* const temperature = image->GetPointData()->GetArray("temperature");
  vtkDataArray* const absorption = image->GetPointData()->GetArray("absorption");
  int inside = 0;
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i) {
    double p[3];
    image->GetPoint(i, p);
    const bool in = *std::min_element(p, p + 3) > 0 && *std::max_element(p, p + 3) < kSide;
    ASSERT_EQ(absorption->GetTuple1(i) > 0, in) << p[0] << " " << p[1] << " " << p[2];
    if (!in) continue;
    ++inside;
    ASSERT_TRUE(relative(temperature->GetTuple1(i), temperature_at(p), 1e-6));
  }
  EXPECT_EQ(inside, 96 * 96 * 96);
}

TEST_F(FlameImport, MissingArrayListsThosePresent) {
  import_->SetTemperatureArray("heat");
  const Events errors(import_), of_executive(import_->GetExecutive());
  import_->Update();
  EXPECT_TRUE(errors.one_with("has no array 'heat'; it has T, fv")) << errors.all();
}

TEST_F(FlameImport, UnknownFilesAreErrorEvents) {
  const Events errors(import_), of_executive(import_->GetExecutive());
  import_->SetFileName(folder_.file("none.vtu").c_str());
  import_->Update();
  EXPECT_TRUE(errors.one_with("none.vtu': No such file")) << errors.all();
}

}  // namespace
}  // namespace plenoflame::test::flame_import_test
