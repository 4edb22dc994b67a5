// The text that PrintSelf of every class prints.
#include <sstream>
#include <string>
#include <vector>

#include <vtkIndent.h>
#include <vtkNew.h>

#include <gtest/gtest.h>
#include "vtkPlenoflameCameraSource.h"
#include "vtkPlenoflameFlameImport.h"
#include "vtkPlenoflameFlameReader.h"
#include "vtkPlenoflameFlameSource.h"
#include "vtkPlenoflameFlameWriter.h"
#include "vtkPlenoflameLightFieldReader.h"
#include "vtkPlenoflameLightFieldSource.h"
#include "vtkPlenoflameLightFieldWriter.h"
#include "vtkPlenoflameRayPathSource.h"
#include "vtkPlenoflameRefocus.h"
#include "vtkPlenoflameScene.h"
#include "vtkPlenoflameSceneReader.h"
#include "vtkPlenoflameViews.h"

namespace plenoflame::test::print_self_test {
namespace {

/// Every line of `lines` must be printed as it stands, behind the indent, and what VTK's own
/// classes print as well.
void expect_printed(vtkObject* object, const std::vector<std::string>& lines) {
  std::ostringstream out;
  object->PrintSelf(out, vtkIndent(4));
  const std::string text = out.str();
  EXPECT_NE(text.find("\n    Reference Count: "), std::string::npos) << object->GetClassName();
  for (const std::string& line : lines)
    EXPECT_NE(text.find("\n    " + line + "\n"), std::string::npos)
        << object->GetClassName() << " does not print '" << line << "':\n"
        << text;
}

TEST(PrintSelf, Files) {
  vtkNew<vtkPlenoflameSceneReader> scene;
  scene->SetFileName("a.toml");
  expect_printed(scene, {"FileName: a.toml"});
  vtkNew<vtkPlenoflameLightFieldReader> reader;
  expect_printed(reader, {"FileName: (none)"});
  vtkNew<vtkPlenoflameLightFieldWriter> writer;
  writer->SetFileName("a.exr");
  expect_printed(writer, {"FileName: a.exr"});
  vtkNew<vtkPlenoflameFlameReader> flame;
  flame->SetGridName("soot");
  flame->SetLocalFrame(true);
  expect_printed(flame, {"FileName: (none)", "GridName: soot", "LocalFrame: 1", "LocalToWorld:"});
  vtkNew<vtkPlenoflameFlameWriter> out;
  out->SetTemperatureArray("hot");
  out->SetAbsorptionArray("kappa");
  out->SetAmbientTemperature(310);
  out->SetHalf(true);
  expect_printed(out, {"TemperatureArray: hot", "AbsorptionArray: kappa", "AmbientTemperature: 310",
                       "Half: 1"});
}

TEST(PrintSelf, Sources) {
  vtkNew<vtkPlenoflameCameraSource> camera;
  camera->SetLevelOfDetail(vtkPlenoflameCameraSource::WINDOW);
  camera->SetWindow(3, 4, 50, 60);
  camera->SetMaximumNumberOfMicrolenses(77);
  camera->SetLensResolution(21);
  camera->SetMicrolensResolution(9);
  expect_printed(camera, {"LevelOfDetail: 2", "Window: 3 4 50 60", "MaximumNumberOfMicrolenses: 77",
                          "LensResolution: 21", "MicrolensResolution: 9"});
  vtkNew<vtkPlenoflameFlameSource> flame;
  flame->SetResolution(33);
  expect_printed(flame, {"Resolution: 33"});
  vtkNew<vtkPlenoflameLightFieldSource> field;
  field->SetSamples(12);
  field->SetSeed(5);
  field->SetEstimator(vtkPlenoflameLightFieldSource::FORWARD);
  field->SetTargetError(0.25);
  field->SetTimeLimit(7);
  field->SetWindow(1, 2, 3, 4);
  field->SetNumberOfThreads(6);
  expect_printed(field, {"Samples: 12", "Seed: 5", "Estimator: 2", "TargetError: 0.25",
                         "TimeLimit: 7", "Window: 1 2 3 4", "NumberOfThreads: 6"});
  vtkNew<vtkPlenoflameRayPathSource> rays;
  rays->AddPixel(1, 2);
  rays->AddPixel(1, 3);
  rays->AddMicrolens(0, 0);
  rays->AddObjectPoint(1, 0, 0);
  rays->SetNumberOfRandomPixels(8);
  rays->SetChiefRays(true);
  rays->SetRaysPerPixel(17);
  rays->SetRaysPerPoint(19);
  rays->SetFlameSamples(23);
  rays->SetSelectedType(1);
  rays->SetMaximumNumberOfRays(999);
  expect_printed(rays, {"Pixels: 2", "Microlenses: 1", "ObjectPoints: 1", "NumberOfRandomPixels: 8",
                        "ChiefRays: 1", "RaysPerPixel: 17", "RaysPerPoint: 19", "FlameSamples: 23",
                        "SelectedType: 1", "MaximumNumberOfRays: 999"});
}

TEST(PrintSelf, Filters) {
  vtkNew<vtkPlenoflameViews> views;
  views->SetGrid(9);
  views->SetSpread(0.5);
  views->SetResampling(vtkPlenoflameViews::NEAREST);
  views->SetWhiteCorrection(false);
  expect_printed(views, {"Grid: 9", "Spread: 0.5", "WhiteCorrection: 0"});
  vtkNew<vtkPlenoflameRefocus> refocus;
  refocus->SetDepth(1.5);
  refocus->SetWidth(300);
  refocus->SetAperture(0.25);
  expect_printed(refocus, {"Depth: 1.5", "Width: 300", "Aperture: 0.25"});
  vtkNew<vtkPlenoflameFlameImport> flames;
  flames->SetFileName("run.vtu");
  flames->SetSootArray("fv");
  flames->SetVoxelSize(0.125);
  flames->SetTimeStep(3);
  expect_printed(flames, {"FileName: run.vtu", "SolutionFileName: (none)", "SootArray: fv",
                          "VoxelSize: 0.125", "TimeStep: 3"});
}

TEST(PrintSelf, Scene) {
  vtkNew<vtkPlenoflameScene> scene;
  expect_printed(scene, {"File: (none)", "Flames: 0"});
}

}  // namespace
}  // namespace plenoflame::test::print_self_test
