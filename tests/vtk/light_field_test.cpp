// Light fields through the pipeline: the same numbers as core gives, rows upwards.
#include <vtkDataArray.h>
#include <vtkExecutive.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>

#include "events.h"
#include "plenoflame/lightfield/refocus.h"
#include "plenoflame/lightfield/views.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/render.h"
#include "plenoflame/scene/compile.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameLightFieldReader.h"
#include "vtkPlenoflameLightFieldSource.h"
#include "vtkPlenoflameLightFieldWriter.h"
#include "vtkPlenoflameRefocus.h"
#include "vtkPlenoflameScene.h"
#include "vtkPlenoflameViews.h"

namespace plenoflame::test::light_field_test {
namespace {

Scene example() {
  Scene scene = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
  scene.render.samples = 4;
  return scene;
}

/// The light field that core makes of it, at the same settings.
LightField rendered(const Scene& scene, PixelWindow window = {}) {
  const CompiledScene compiled = compile(scene);
  RenderSettings settings;
  settings.samples = scene.render.samples;
  settings.seed = scene.render.seed;
  settings.window = window;
  LightField field = render(compiled, settings).light_field;
  describe(compiled, field);
  return field;
}

double at(vtkImageData* image, const char* name, int column, int row_from_top) {
  const int* size = image->GetDimensions();
  return image->GetPointData()->GetArray(name)->GetTuple1(
      static_cast<vtkIdType>(size[1] - 1 - row_from_top) * size[0] + column);
}

void expect_same(vtkImageData* image, const char* name, const Image& expected) {
  ASSERT_EQ(image->GetDimensions()[0], expected.width);
  ASSERT_EQ(image->GetDimensions()[1], expected.height);
  for (int row = 0; row < expected.height; ++row)
    for (int column = 0; column < expected.width; ++column)
      ASSERT_EQ(at(image, name, column, row), static_cast<double>(expected.at(column, row)))
          << name << " at " << column << ", " << row;
}

class LightFieldPipeline : public ::testing::Test {
 protected:
  LightFieldPipeline() {
    scene_->SetScene(example());
    source_->SetInputDataObject(scene_);
  }
  vtkNew<vtkPlenoflameScene> scene_;
  vtkNew<vtkPlenoflameLightFieldSource> source_;
};

TEST_F(LightFieldPipeline, SourceGivesTheImageOfCore) {
  source_->Update();
  const LightField expected = rendered(example());
  expect_same(source_->GetOutput(), "total", expected.channels[0].flux);
  expect_same(source_->GetOutput(), "total.error", expected.channels[0].standard_error);
}

TEST_F(LightFieldPipeline, WindowKeepsItsPlaceOnTheSensor) {
  source_->SetWindow(20, 15, 24, 11);
  source_->Update();
  expect_same(source_->GetOutput(), "total",
              rendered(example(), {20, 15, 24, 11}).channels[0].flux);
  // Pixels are points at half numbers, from the lower left corner of the sensor of 60 rows.
  EXPECT_EQ(source_->GetOutput()->GetOrigin()[0], 20.5);
  EXPECT_EQ(source_->GetOutput()->GetOrigin()[1], 60 - 15 - 11 + 0.5);
}

TEST_F(LightFieldPipeline, PictureIsAnnounced) {
  // Filters of pictures, such as vtkImageMapToColors, ask for it before there is one.
  source_->UpdateInformation();
  vtkInformation* const said = source_->GetOutputInformation(0);
  EXPECT_EQ(vtkImageData::GetScalarType(said), VTK_FLOAT);
  EXPECT_EQ(vtkImageData::GetNumberOfScalarComponents(said), 1);
  EXPECT_EQ(said->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT())[1], 59);
}

TEST_F(LightFieldPipeline, RunsAgainOnlyWhenSomethingChanged) {
  source_->Update();
  const vtkMTimeType first = source_->GetOutput()->GetMTime();
  source_->Update();
  EXPECT_EQ(source_->GetOutput()->GetMTime(), first);
  scene_->SetValue("camera.sensor.columns", "40");
  source_->Update();
  EXPECT_EQ(source_->GetOutput()->GetDimensions()[0], 40);
}

TEST_F(LightFieldPipeline, ProgressRisesToOne) {
  std::vector<double> seen;
  vtkNew<vtkCallbackCommand> callback;
  callback->SetClientData(&seen);
  callback->SetCallback([](vtkObject* caller, unsigned long, void* list, void*) {
    static_cast<std::vector<double>*>(list)->push_back(
        vtkAlgorithm::SafeDownCast(caller)->GetProgress());
  });
  source_->AddObserver(vtkCommand::ProgressEvent, callback);
  source_->Update();
  ASSERT_GE(seen.size(), 2U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 1);
}

TEST_F(LightFieldPipeline, AbortEndsARunWithoutEnd) {
  // Would take days.
  source_->SetSamples(1 << 30);
  source_->SetNumberOfThreads(1);
  vtkNew<vtkCallbackCommand> callback;
  callback->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1);
  });
  source_->AddObserver(vtkCommand::ProgressEvent, callback);
  const Events errors(source_), of_executive(source_->GetExecutive());
  source_->SetTimeLimit(1e6);
  source_->Update();
  EXPECT_FALSE(source_->GetComplete());
  EXPECT_EQ(errors.size(), 0U) << errors.all();
}

TEST_F(LightFieldPipeline, MessageIsThatOfTheCommandLine) {
  source_->SetWindow(50, 0, 20, 20);
  const Events errors(source_), of_executive(source_->GetExecutive());
  source_->Update();
  EXPECT_TRUE(errors.one_with("window must lie inside the sensor of 60 x 60 pixels"))
      << errors.all();
}

TEST_F(LightFieldPipeline, FileKeepsEverything) {
  const TemporaryFolder folder;
  vtkNew<vtkPlenoflameLightFieldWriter> writer;
  writer->SetInputConnection(source_->GetOutputPort());
  writer->SetFileName(folder.file("a.exr").c_str());
  source_->SetWindow(20, 15, 24, 11);
  ASSERT_TRUE(writer->Write());
  // Read without VTK: what core would have written.
  const LightField expected = rendered(example(), {20, 15, 24, 11});
  const LightField written = read_light_field(folder.file("a.exr"));
  EXPECT_EQ(written.channels[0].flux.pixels, expected.channels[0].flux.pixels);
  EXPECT_EQ(written.scene_text, expected.scene_text);
  EXPECT_EQ(written.window, expected.window);
  EXPECT_EQ(written.numbers, expected.numbers);
  EXPECT_EQ(written.seed, expected.seed);
  vtkNew<vtkPlenoflameLightFieldReader> reader;
  reader->SetFileName(folder.file("a.exr").c_str());
  reader->Update();
  expect_same(reader->GetOutput(), "total", expected.channels[0].flux);
  EXPECT_EQ(reader->GetOutput()->GetOrigin()[1], 60 - 15 - 11 + 0.5);
}

TEST_F(LightFieldPipeline, FiltersGiveThePicturesOfCore) {
  const LightField field = rendered(example());
  const MicroImages micro(Camera(example().camera));
  vtkNew<vtkPlenoflameViews> views;
  views->SetInputConnection(source_->GetOutputPort());
  views->SetGrid(3);
  views->Update();
  ViewSettings view_settings;
  view_settings.grid = 3;
  const Views expected = extract_views(field, micro, view_settings);
  ASSERT_EQ(views->GetOutput()->GetNumberOfBlocks(), 9U);
  for (unsigned k = 0; k < 9; ++k)
    expect_same(vtkImageData::SafeDownCast(views->GetOutput()->GetBlock(k)), "radiance",
                expected.views[k].image);
  expect_same(views->GetContactSheet(), "radiance", contact_sheet(expected));

  vtkNew<vtkPlenoflameRefocus> refocus_filter;
  refocus_filter->SetInputConnection(source_->GetOutputPort());
  refocus_filter->SetDepth(0.95);
  refocus_filter->Update();
  RefocusSettings settings;
  settings.depth = 0.95;
  const RefocusedImage picture = refocus(field, micro, settings);
  expect_same(refocus_filter->GetOutput(), "radiance", picture.image);
  EXPECT_EQ(refocus_filter->GetPixelSize(), picture.pixel);
}

TEST(LightFieldFilters, OtherImagesAreRefused) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 4, 1);
  image->AllocateScalars(VTK_FLOAT, 1);
  vtkNew<vtkPlenoflameViews> views;
  views->SetInputDataObject(image);
  const Events errors(views), of_executive(views->GetExecutive());
  views->Update();
  EXPECT_TRUE(errors.one_with("the image is no light field")) << errors.all();
}

}  // namespace
}  // namespace plenoflame::test::light_field_test
