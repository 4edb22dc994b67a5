// Ray paths in VTK: summed over a pixel they are its flux, and files read back give the same.
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkExecutive.h>
#include <vtkIdList.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "events.h"
#include "plenoflame/render/ray_paths.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameRayPathSource.h"
#include "vtkPlenoflameScene.h"

namespace plenoflame::test::ray_path_source_test {
namespace {

Scene example() {
  return small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
}

class RayPathSource : public ::testing::Test {
 protected:
  RayPathSource() {
    scene_->SetScene(example());
    source_->SetInputDataObject(scene_);
    source_->SetRaysPerPixel(16);
  }
  vtkPolyData* output() {
    source_->Update();
    return source_->GetOutput();
  }
  static double cell(vtkPolyData* data, const char* name, vtkIdType i, int component = 0) {
    return data->GetCellData()->GetArray(name)->GetComponent(i, component);
  }
  vtkNew<vtkPlenoflameScene> scene_;
  vtkNew<vtkPlenoflameRayPathSource> source_;
};

TEST_F(RayPathSource, SumOverAPixelIsItsFlux) {
  RenderSettings settings;
  settings.samples = 16;
  settings.precision = Precision::double_precision;
  const LightField field = render(compile(example()), settings).light_field;
  const Image& image = field.channels[0].flux;
  // The first, the middle and the last of the bright ones.
  const float bright = 0.5f * *std::max_element(image.pixels.begin(), image.pixels.end());
  std::vector<Pixel> all;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column)
      if (image.at(column, row) > bright) all.push_back({column, row});
  ASSERT_GT(all.size(), 10u);
  const std::vector<Pixel> pixels{all.front(), all[all.size() / 2], all.back()};
  for (const Pixel pixel : pixels) source_->AddPixel(pixel.column, pixel.row);
  vtkPolyData* const rays = output();
  std::map<std::pair<int, int>, double> sums;
  for (vtkIdType i = 0; i < rays->GetNumberOfLines(); ++i)
    sums[{static_cast<int>(cell(rays, "pixel", i, 0)),
          static_cast<int>(cell(rays, "pixel", i, 1))}] +=
        cell(rays, "weight", i) * cell(rays, "radiance", i);
  ASSERT_EQ(sums.size(), 3U);
  for (const Pixel pixel : pixels) {
    const double flux = static_cast<double>(image.at(pixel.column, pixel.row));
    EXPECT_GT(flux, 0);
    // The image is kept in single precision.
    EXPECT_TRUE(relative(sums[{pixel.column, pixel.row}], flux, 1.2e-7));
  }
}

TEST_F(RayPathSource, FileReadByVtkIsTheSourcesOutput) {
  const TemporaryFolder folder;
  const CompiledScene scene = compile(example());
  RayPaths paths = empty_ray_paths(scene);
  paths.flame_samples = 4;
  RenderSettings settings;
  settings.samples = 16;
  settings.seed = scene.scene.render.seed;
  add_pixel_rays(scene, settings, {{30, 29}}, {}, paths);
  add_object_rays(scene, {1, 0.002, -0.001}, 30, paths);
  add_chief_rays(scene, paths);
  write_ray_paths(folder.file("r.vtp"), paths);
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(folder.file("r.vtp").c_str());
  const Events errors(reader);
  reader->Update();
  ASSERT_EQ(errors.size(), 0U) << errors.all();
  vtkPolyData* const read = reader->GetOutput();
  source_->AddPixel(30, 29);
  source_->AddObjectPoint(1, 0.002, -0.001);
  source_->SetRaysPerPoint(30);
  source_->ChiefRaysOn();
  source_->SetFlameSamples(4);
  vtkPolyData* const made = output();
  ASSERT_EQ(read->GetNumberOfLines(), made->GetNumberOfLines());
  ASSERT_EQ(read->GetNumberOfPoints(), made->GetNumberOfPoints());
  ASSERT_EQ(read->GetCellData()->GetNumberOfArrays(), made->GetCellData()->GetNumberOfArrays());
  ASSERT_EQ(read->GetPointData()->GetNumberOfArrays(), made->GetPointData()->GetNumberOfArrays());
  vtkNew<vtkIdList> a, b;
  for (vtkIdType i = 0; i < made->GetNumberOfLines(); ++i) {
    read->GetCellPoints(i, a);
    made->GetCellPoints(i, b);
    ASSERT_EQ(a->GetNumberOfIds(), b->GetNumberOfIds());
    ASSERT_EQ(a->GetId(0), b->GetId(0));
  }
  const auto same = [](vtkDataArray* x, vtkDataArray* y) {
    ASSERT_NE(x, nullptr);
    ASSERT_EQ(x->GetNumberOfTuples(), y->GetNumberOfTuples());
    ASSERT_EQ(x->GetNumberOfComponents(), y->GetNumberOfComponents());
    for (vtkIdType i = 0; i < y->GetNumberOfTuples(); ++i)
      for (int k = 0; k < y->GetNumberOfComponents(); ++k)
        ASSERT_EQ(x->GetComponent(i, k), y->GetComponent(i, k)) << y->GetName() << " " << i;
  };
  for (int k = 0; k < made->GetCellData()->GetNumberOfArrays(); ++k)
    same(read->GetCellData()->GetArray(made->GetCellData()->GetArrayName(k)),
         made->GetCellData()->GetArray(k));
  for (int k = 0; k < made->GetPointData()->GetNumberOfArrays(); ++k)
    same(read->GetPointData()->GetArray(made->GetPointData()->GetArrayName(k)),
         made->GetPointData()->GetArray(k));
  same(read->GetPoints()->GetData(), made->GetPoints()->GetData());
}

TEST_F(RayPathSource, StatusAndTypeAreSelected) {
  source_->SetNumberOfRandomPixels(40);
  const vtkIdType all = output()->GetNumberOfLines();
  std::map<int, vtkIdType> by_status, by_type;
  for (vtkIdType i = 0; i < all; ++i) {
    ++by_status[static_cast<int>(cell(source_->GetOutput(), "status", i))];
    ++by_type[static_cast<int>(cell(source_->GetOutput(), "type", i))];
  }
  ASSERT_GT(by_status[1], 0);
  ASSERT_GT(by_type[2], 0);
  source_->SetStatusSelected(0, false);
  EXPECT_EQ(output()->GetNumberOfLines(), all - by_status[0]);
  source_->SetStatusSelected(0, true);
  source_->SetSelectedType(2);
  EXPECT_EQ(output()->GetNumberOfLines(), by_type[2]);
  source_->SetSelectedType(-1);
  source_->SetMaximumNumberOfRays(25);
  EXPECT_EQ(output()->GetNumberOfLines(), 25);
}

TEST_F(RayPathSource, ProgressRisesToOne) {
  source_->SetNumberOfRandomPixels(300);
  source_->SetRaysPerPixel(64);
  std::vector<double> seen;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&seen);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* list, void*) {
    static_cast<std::vector<double>*>(list)->push_back(
        vtkAlgorithm::SafeDownCast(caller)->GetProgress());
  });
  source_->AddObserver(vtkCommand::ProgressEvent, callback);
  EXPECT_GT(output()->GetNumberOfLines(), 1000);
  ASSERT_GE(seen.size(), 2U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 1);
}

// Some hundred million rays: without the abort the test would not end in its time.
TEST_F(RayPathSource, AbortEndsItWithoutRays) {
  source_->SetNumberOfRandomPixels(3000);
  source_->SetRaysPerPixel(16384);
  source_->SetNumberOfThreads(1);
  vtkNew<vtkCallbackCommand> callback;
  callback->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
  });
  const unsigned long tag = source_->AddObserver(vtkCommand::ProgressEvent, callback);
  const Events errors(source_), of_executive(source_->GetExecutive());
  EXPECT_EQ(output()->GetNumberOfLines(), 0);
  EXPECT_EQ(errors.size(), 0U) << errors.all();
  // The source can be used again.
  source_->RemoveObserver(tag);
  source_->SetNumberOfRandomPixels(10);
  source_->SetRaysPerPixel(8);
  EXPECT_GT(output()->GetNumberOfLines(), 0);
}

TEST_F(RayPathSource, WrongPixelIsAnErrorEvent) {
  source_->AddPixel(60, 0);
  const Events errors(source_), of_executive(source_->GetExecutive());
  source_->Update();
  EXPECT_TRUE(errors.one_with("pixel 60,0 is outside of the sensor of 60 x 60 pixels"))
      << errors.all();
}

}  // namespace
}  // namespace plenoflame::test::ray_path_source_test
