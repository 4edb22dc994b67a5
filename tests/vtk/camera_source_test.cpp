// The camera's geometry: points lie on the surfaces of the prescription, in the world.
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkMath.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <set>

#include "events.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "vtkPlenoflameCameraSource.h"
#include "vtkPlenoflameScene.h"

namespace plenoflame::test::camera_source_test {
namespace {

using Source = vtkPlenoflameCameraSource;

class CameraSource : public ::testing::Test {
 protected:
  CameraSource() {
    Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    scene.camera.position = {0.25, -0.5, 0.125};
    scene.camera.look_direction = {1, 0, 0};
    scene_->SetScene(scene);
    source_->SetInputDataObject(scene_);
  }
  vtkPolyData* block(unsigned which) {
    source_->Update();
    return vtkPolyData::SafeDownCast(source_->GetOutput()->GetBlock(which));
  }
  /// World to camera for this camera: +z is the world's +x, x its -y, y its -z.
  static Vec3 in_camera(vtkPolyData* data, vtkIdType point) {
    const double* p = data->GetPoint(point);
    return {-(p[1] + 0.5), -(p[2] - 0.125), p[0] - 0.25};
  }
  vtkNew<vtkPlenoflameScene> scene_;
  vtkNew<Source> source_;
};

TEST_F(CameraSource, LensPointsLieOnTheSpheres) {
  vtkPolyData* const lens = block(Source::LENS_SURFACES);
  // The singlet of 24.26 mm with radii of 300 mm to both sides: centres at -R and at R - thickness.
  const std::array<double, 2> centres{-0.3, 0.3 - 0.02426};
  std::array<int, 2> seen{};
  for (vtkIdType cell = 0; cell < lens->GetNumberOfCells(); ++cell) {
    const auto surface =
        static_cast<std::size_t>(lens->GetCellData()->GetArray("surface")->GetTuple1(cell));
    ASSERT_LT(surface, 2U);
    ++seen[surface];
    vtkCell* const polygon = lens->GetCell(cell);
    for (vtkIdType k = 0; k < polygon->GetNumberOfPoints(); ++k) {
      const Vec3 p = in_camera(lens, polygon->GetPointId(static_cast<int>(k)));
      EXPECT_TRUE(relative(length(p - Vec3{0, 0, centres[surface]}), 0.3, 1e-12));
      EXPECT_LE(std::hypot(p.x, p.y), 0.06 * (1 + 1e-12));
    }
  }
  EXPECT_GT(seen[0], 1000);
  EXPECT_EQ(seen[0], seen[1]);
}

TEST_F(CameraSource, NormalsAreThoseOfTheSpheres) {
  vtkPolyData* const lens = block(Source::LENS_SURFACES);
  vtkDataArray* const normals = lens->GetPointData()->GetNormals();
  ASSERT_NE(normals, nullptr);
  for (vtkIdType cell = 0; cell < lens->GetNumberOfCells(); cell += 7) {
    const bool front = lens->GetCellData()->GetArray("surface")->GetTuple1(cell) == 0;
    const vtkIdType point = lens->GetCell(cell)->GetPointId(1);
    const Vec3 p = in_camera(lens, point);
    const Vec3 away = p - Vec3{0, 0, front ? -0.3 : 0.3 - 0.02426};
    const double* n = normals->GetTuple3(point);
    const Vec3 normal{-n[1], -n[2], n[0]};
    EXPECT_TRUE(relative(std::fabs(dot(normalize(away), normal)), 1, 1e-6));
  }
}

TEST_F(CameraSource, MicrolensesStandOnTheLattice) {
  source_->SetLevelOfDetail(Source::ALL_MICROLENSES);
  vtkPolyData* const lenses = block(Source::MICROLENSES);
  vtkDataArray* const index = lenses->GetCellData()->GetArray("microlens");
  vtkDataArray* const types = lenses->GetCellData()->GetArray("type");
  std::set<std::pair<int, int>> seen;
  for (vtkIdType cell = 0; cell < lenses->GetNumberOfCells(); ++cell) {
    const double* qr = index->GetTuple2(cell);
    seen.insert({static_cast<int>(qr[0]), static_cast<int>(qr[1])});
    // DESIGN: pitch * (q + r/2, r cos 30), turned by 0.05 rad, moved by 0.2, 0.1 mm.
    const double u = 1e-3 * (qr[0] + 0.5 * qr[1]), v = 1e-3 * qr[1] * std::sqrt(0.75);
    const Vec2 centre{u * std::cos(0.05) - v * std::sin(0.05) + 0.2e-3,
                      u * std::sin(0.05) + v * std::cos(0.05) + 0.1e-3};
    vtkCell* const polygon = lenses->GetCell(cell);
    for (vtkIdType k = 0; k < polygon->GetNumberOfPoints(); ++k) {
      const Vec3 p = in_camera(lenses, polygon->GetPointId(static_cast<int>(k)));
      EXPECT_LE(length(Vec2{p.x, p.y} - centre), 0.5e-3 * (1 + 1e-9));
    }
    const int type = static_cast<int>(qr[0] - qr[1]);
    EXPECT_EQ(types->GetTuple1(cell), (type % 3 + 3) % 3);
  }
  // A sensor of 12 mm covers 144 mm^2; a hexagonal cell has sqrt(3)/2 mm^2. One pitch around it,
  // too.
  EXPECT_GT(seen.size(), 144 / std::sqrt(0.75));
  EXPECT_LT(seen.size(), 15.0 * 15.0 / std::sqrt(0.75));
}

TEST_F(CameraSource, LevelsOfDetail) {
  source_->SetLevelOfDetail(Source::PLATE);
  EXPECT_EQ(block(Source::MICROLENSES)->GetNumberOfCells(), 0);
  EXPECT_EQ(block(Source::ARRAY_PLATE)->GetNumberOfCells(), 1);
  source_->SetLevelOfDetail(Source::ALL_MICROLENSES);
  const vtkIdType all = block(Source::MICROLENSES)->GetNumberOfCells();
  EXPECT_EQ(block(Source::ARRAY_PLATE)->GetNumberOfCells(), 0);
  source_->SetLevelOfDetail(Source::WINDOW);
  source_->SetWindow(20, 20, 10, 10);
  const vtkIdType some = block(Source::MICROLENSES)->GetNumberOfCells();
  EXPECT_GT(some, 0);
  EXPECT_LT(some, all / 4);
  EXPECT_EQ(block(Source::ARRAY_PLATE)->GetNumberOfCells(), 1);
  source_->SetLevelOfDetail(Source::AUTOMATIC);
  source_->SetMaximumNumberOfMicrolenses(10);
  EXPECT_EQ(block(Source::MICROLENSES)->GetNumberOfCells(), 0);
}

TEST_F(CameraSource, SensorCornersAreUprightInTheTexture) {
  vtkPolyData* const sensor = block(Source::SENSOR);
  ASSERT_EQ(sensor->GetNumberOfPoints(), 4);
  for (vtkIdType k = 0; k < 4; ++k) {
    const double* t = sensor->GetPointData()->GetTCoords()->GetTuple2(k);
    const Vec3 p = in_camera(sensor, k);
    // The picture is upright, the lens inverts: its right (t = 1) is the camera's -x, its top -y...
    // which is where the row number is lowest, and camera y points down: +y.
    EXPECT_TRUE(relative(p.x, t[0] > 0.5 ? -6e-3 : 6e-3, 1e-12));
    EXPECT_TRUE(relative(p.y, t[1] > 0.5 ? 6e-3 : -6e-3, 1e-12));
  }
}

}  // namespace
}  // namespace plenoflame::test::camera_source_test
