// Flames between VTK and OpenVDB: origin, last layer and rotation survive.
#include <vtkCallbackCommand.h>
#include <vtkDataArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkPointData.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "events.h"
#include "plenoflame/media/layered_medium.h"
#include "plenoflame/volumes/grid_file.h"
#include "plenoflame/volumes/grid_writer.h"
#include "support/approx.h"
#include "support/open_files.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameFlameReader.h"
#include "vtkPlenoflameFlameSource.h"
#include "vtkPlenoflameFlameWriter.h"
#include "vtkPlenoflameScene.h"

namespace plenoflame::test::flame_test {
namespace {

float temperature_at(int i, int j, int k) {
  return static_cast<float>(1000 + i + 20 * j + 300 * k);
}
float absorption_at(int i, int j, int k) {
  return static_cast<float>(1 + 0.5 * i + 4 * j + 32 * k);
}

/// A box that is no multiple of 8 long, turned and moved.
vtkNew<vtkImageData> turned_box() {
  vtkNew<vtkImageData> image;
  image->SetExtent(2, 12, -3, 6, 5, 17);
  image->SetOrigin(0.3, -0.2, 0.1);
  image->SetSpacing(1e-3, 2e-3, 0.5e-3);
  const double c = std::cos(0.4), s = std::sin(0.4);
  image->SetDirectionMatrix(c, -s, 0, s, c, 0, 0, 0, 1);
  vtkNew<vtkFloatArray> temperature, absorption;
  temperature->SetName("temperature");
  absorption->SetName("absorption");
  for (int k = 5; k <= 17; ++k)
    for (int j = -3; j <= 6; ++j)
      for (int i = 2; i <= 12; ++i) {
        temperature->InsertNextValue(temperature_at(i, j, k));
        absorption->InsertNextValue(absorption_at(i - 2, j + 3, k - 5));
      }
  image->GetPointData()->AddArray(temperature);
  image->GetPointData()->AddArray(absorption);
  return image;
}

bool write(vtkImageData* image, const std::string& path) {
  vtkNew<vtkPlenoflameFlameWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  return writer->Write();
}

TEST(Flame, RoundTripKeepsOriginLastLayerAndRotation) {
  const TemporaryFolder folder;
  const vtkNew<vtkImageData> image = turned_box();
  ASSERT_TRUE(write(image, folder.file("a.vdb")));
  vtkNew<vtkPlenoflameFlameReader> reader;
  reader->SetFileName(folder.file("a.vdb").c_str());
  reader->Update();
  vtkImageData* const back = reader->GetOutput();
  ASSERT_EQ(back->GetNumberOfPoints(), image->GetNumberOfPoints());
  for (vtkIdType n = 0; n < image->GetNumberOfPoints(); ++n) {
    double expected[3], actual[3];
    image->GetPoint(n, expected);
    back->GetPoint(n, actual);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(within(actual[k], expected[k], 1e-13, 0.3));
    for (const char* name : {"temperature", "absorption"})
      ASSERT_EQ(back->GetPointData()->GetArray(name)->GetTuple1(n),
                image->GetPointData()->GetArray(name)->GetTuple1(n))
          << name << " at " << n;
  }
}

TEST(Flame, FileHoldsTheTransform) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write(turned_box(), folder.file("a.vdb")));
  // Seen through the volumes library alone: the last sample, where the turned box has its corner.
  const VoxelField field = read_voxel_field(folder.file("a.vdb"), "absorption");
  const Vec3 corner = field.index_to_world.point({10, 9, 12});
  const double c = std::cos(0.4), s = std::sin(0.4), u = 12e-3, v = 12e-3;
  EXPECT_TRUE(relative(corner.x, 0.3 + c * u - s * v, 1e-12));
  EXPECT_TRUE(relative(corner.y, -0.2 + s * u + c * v, 1e-12));
  EXPECT_TRUE(relative(corner.z, 0.1 + 17 * 0.5e-3, 1e-12));
  for (const GridInfo& grid : list_grids(folder.file("a.vdb")))
    if (grid.name == "absorption") {
      EXPECT_EQ(grid.maximum, absorption_at(10, 9, 12));
      EXPECT_EQ(grid.unit, "1/m");
    }
}

/// A cube of samples that cannot be compressed.
vtkNew<vtkImageData> noisy_cube(int side) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(side, side, side);
  std::minstd_rand random(3);
  for (const char* name : {"temperature", "absorption"}) {
    vtkNew<vtkFloatArray> values;
    values->SetName(name);
    values->SetNumberOfValues(image->GetNumberOfPoints());
    for (vtkIdType n = 0; n < values->GetNumberOfValues(); ++n)
      values->SetValue(n, static_cast<float>(300 + random() % 100000));
    image->GetPointData()->AddArray(values);
  }
  return image;
}

TEST(Flame, WritingStopsWhereItIsAborted) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  ASSERT_TRUE(write(turned_box(), path));
  std::string before = read_bytes(path);
  vtkNew<vtkCallbackCommand> callback;
  std::string written_in = folder.path();
  callback->SetClientData(&written_in);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* data, void*) {
    if (open_in(*static_cast<std::string*>(data)) > 0)
      static_cast<vtkAlgorithm*>(caller)->AbortExecuteOn();
  });
  vtkNew<vtkPlenoflameFlameWriter> writer;
  writer->SetFileName(path.c_str());
  const unsigned long tag = writer->AddObserver(vtkCommand::ProgressEvent, callback);
  const Events errors(writer);
  // A file that was complete before its writing was seen is written again, larger.
  bool complete = true;
  for (int side = 64; side <= 512; side *= 2) {
    writer->SetInputData(noisy_cube(side));
    complete = writer->Write();
    if (!complete) break;
    ASSERT_TRUE(write(turned_box(), path));
    before = read_bytes(path);  // each file has an identifier of its own
  }
  EXPECT_FALSE(complete);
  EXPECT_EQ(errors.size(), 0U) << errors.all();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.vdb"});
  EXPECT_EQ(read_bytes(path), before);
  // The next time it is not stopped.
  writer->RemoveObserver(tag);
  writer->SetInputData(noisy_cube(8));
  EXPECT_TRUE(writer->Write());
  EXPECT_NE(read_bytes(path), before);
}

TEST(Flame, LocalFrameIsPlacedByItsMatrix) {
  const TemporaryFolder folder;
  const vtkNew<vtkImageData> image = turned_box();
  ASSERT_TRUE(write(image, folder.file("a.vdb")));
  vtkNew<vtkPlenoflameFlameReader> reader;
  reader->SetFileName(folder.file("a.vdb").c_str());
  reader->LocalFrameOn();
  reader->Update();
  vtkImageData* const local = reader->GetOutput();
  EXPECT_TRUE(local->GetDirectionMatrix()->IsIdentity());
  for (const vtkIdType n : {vtkIdType{0}, local->GetNumberOfPoints() - 1}) {
    double p[4] = {0, 0, 0, 1}, world[4], expected[3];
    local->GetPoint(n, p);
    reader->GetLocalToWorld()->MultiplyPoint(p, world);
    image->GetPoint(n, expected);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(within(world[k], expected[k], 1e-13, 0.3));
  }
}

TEST(Flame, GridsWithTheirOwnLatticesAreInterpolated) {
  // A linear function of the world is interpolated exactly.
  const auto linear = [](Vec3 p) {
    return static_cast<float>(100 + 3000 * p.x + 500 * p.y + 70 * p.z);
  };
  const auto field = [&](const char* name, double size, Vec3 at) {
    VoxelField out;
    out.name = name;
    out.index_to_world = {Mat3{{{{size, 0, 0}, {0, size, 0}, {0, 0, size}}}}, at};
    for (int bi = 0; bi < 16; bi += 8)
      for (int bj = 0; bj < 16; bj += 8)
        for (int bk = 0; bk < 16; bk += 8) {
          out.brick_origins.push_back({bi, bj, bk});
          for (int n = 0; n < 512; ++n)
            out.values.push_back(linear(out.index_to_world.point(
                {bi + n / 64 + 0.0, bj + n / 8 % 8 + 0.0, bk + n % 8 + 0.0})));
        }
    return out;
  };
  const VoxelField temperature = field("temperature", 1e-3, {0.002, 0.002, 0.002});
  const VoxelField absorption = field("absorption", 1.5e-3, {0, 0, 0});
  const TemporaryFolder folder;
  const std::array<GridOutput, 2> grids{{{&temperature, "K"}, {&absorption, "1/m"}}};
  write_grids(folder.file("a.vdb"), grids);
  vtkNew<vtkPlenoflameFlameReader> reader;
  reader->SetFileName(folder.file("a.vdb").c_str());
  const Events warnings(reader, vtkCommand::WarningEvent);
  reader->Update();
  EXPECT_NE(warnings.all().find("lattice of its own"), std::string::npos) << warnings.all();
  vtkImageData* const image = reader->GetOutput();
  ASSERT_EQ(image->GetNumberOfPoints(), 16 * 16 * 16);
  for (vtkIdType n = 0; n < image->GetNumberOfPoints(); ++n) {
    const double* p = image->GetPoint(n);
    EXPECT_TRUE(relative(image->GetPointData()->GetArray("absorption")->GetTuple1(n),
                         static_cast<double>(linear({p[0], p[1], p[2]})), 1e-6));
  }
  reader->SetGridName("absorption");
  reader->Update();
  EXPECT_EQ(reader->GetOutput()->GetSpacing()[0], 1.5e-3);
}

TEST(Flame, MissingArrayListsThosePresent) {
  const vtkNew<vtkImageData> image = turned_box();
  vtkNew<vtkPlenoflameFlameWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName("never.vdb");
  writer->SetTemperatureArray("T");
  const Events errors(writer);
  EXPECT_FALSE(writer->Write());
  EXPECT_TRUE(errors.one_with("there is no array 'T'; the data has temperature, absorption"))
      << errors.all();
}

TEST(Flame, NaNIsRefusedWithItsPlace) {
  const vtkNew<vtkImageData> image = turned_box();
  image->GetPointData()->GetArray("absorption")->SetTuple1(11 * 10 * 4 + 11 * 3 + 2, std::nan(""));
  vtkNew<vtkPlenoflameFlameWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName("never.vdb");
  const Events errors(writer);
  EXPECT_FALSE(writer->Write());
  EXPECT_TRUE(errors.one_with("'absorption' is nan at (2, 3, 4)")) << errors.all();
}

TEST(Flame, SourceSamplesTheSceneInTheWorld) {
  const Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  vtkNew<vtkPlenoflameScene> input;
  input->SetScene(scene);
  vtkNew<vtkPlenoflameFlameSource> source;
  source->SetInputDataObject(input);
  source->SetResolution(40);
  source->Update();
  vtkImageData* const image = source->GetOutput();
  const FlameSpec& flame = scene.flames[0];
  int inside = 0;
  for (vtkIdType n = 0; n < image->GetNumberOfPoints(); ++n) {
    const double* p = image->GetPoint(n);
    // The first ellipsoid that holds the point.
    double expected = 0, margin = 1;
    for (const EllipsoidSpec& layer : flame.layers) {
      const Vec3 d = Vec3{p[0], p[1], p[2]} - flame.position - layer.centre;
      const double r =
          std::hypot(d.x / layer.semi_axes.x, d.y / layer.semi_axes.y, d.z / layer.semi_axes.z);
      margin = std::min(margin, std::fabs(r - 1));
      if (r < 1 && expected == 0) expected = layer.absorption;
    }
    if (margin < 1e-9) continue;
    inside += expected > 0;
    ASSERT_EQ(image->GetPointData()->GetArray("absorption")->GetTuple1(n), expected) << n;
  }
  EXPECT_GT(inside, 1000);
}

}  // namespace
}  // namespace plenoflame::test::flame_test
