// Scenes as data objects: what is read is what core reads, and errors are events with its messages.
#include <vtkAlgorithm.h>
#include <vtkExecutive.h>

#include "events.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/compile.h"
#include "plenoflame/scene/scene_file.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameScene.h"
#include "vtkPlenoflameSceneReader.h"

namespace plenoflame::test::scene_reader_test {
namespace {

Scene example() {
  return small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
}

TEST(SceneReader, GivesTheSceneOfTheFile) {
  const TemporaryFolder folder;
  write_scene_file(folder.file("a.toml"), example());
  vtkNew<vtkPlenoflameSceneReader> reader;
  reader->SetFileName(folder.file("a.toml").c_str());
  reader->Update();
  Scene expected = example();
  expected.file = folder.file("a.toml");
  EXPECT_TRUE(reader->GetOutput()->GetScene() == expected);
}

TEST(SceneReader, MessageIsThatOfTheCommandLine) {
  const TemporaryFolder folder;
  write_file(folder.file("bad.toml"), "[camera]\npreset = \"paper-plenoptic2\"\nsensr = 3\n");
  std::string message;
  try {
    read_scene_file(folder.file("bad.toml"));
  } catch (const InputError& error) {
    message = error.what();
  }
  ASSERT_NE(message.find("bad.toml:3:"), std::string::npos);
  vtkNew<vtkPlenoflameSceneReader> reader;
  reader->SetFileName(folder.file("bad.toml").c_str());
  const Events errors(reader), of_executive(reader->GetExecutive());
  reader->Update();
  EXPECT_TRUE(errors.one_with(message)) << errors.all();
}

TEST(SceneReader, MissingFileIsAnErrorEvent) {
  vtkNew<vtkPlenoflameSceneReader> reader;
  const Events errors(reader), of_executive(reader->GetExecutive());
  reader->Update();  // no name at all
  EXPECT_EQ(errors.size(), 1U);
  reader->SetFileName("/nowhere/at/all.toml");
  reader->Update();
  EXPECT_EQ(errors.size(), 2U);
  EXPECT_NE(errors.all().find("/nowhere/at/all.toml"), std::string::npos);
}

TEST(SceneObject, ValuesAreSetByPath) {
  vtkNew<vtkPlenoflameScene> scene;
  scene->SetScene(example());
  const vtkMTimeType before = scene->GetMTime();
  EXPECT_TRUE(scene->SetValue("camera.lens.surfaces[0].radius", "250 mm"));
  EXPECT_GT(scene->GetMTime(), before);
  EXPECT_TRUE(relative(scene->GetScene().camera.lens.surfaces[0].radius, 0.25, 1e-15));
  EXPECT_EQ(scene->GetValue("camera.lens.surfaces[0].radius"), "250 mm");
  EXPECT_EQ(scene->GetListSize("flames"), 1);
}

TEST(SceneObject, RefusedValueChangesNothing) {
  vtkNew<vtkPlenoflameScene> scene;
  scene->SetScene(example());
  const vtkMTimeType before = scene->GetMTime();
  const Events errors(scene);
  EXPECT_FALSE(scene->SetValue("camera.sensor.pixel_pitch", "3"));  // no unit
  EXPECT_TRUE(errors.one_with("unit")) << errors.all();
  EXPECT_EQ(scene->GetMTime(), before);
  EXPECT_TRUE(scene->GetScene() == example());
}

TEST(SceneObject, CopyIsIndependent) {
  vtkNew<vtkPlenoflameScene> scene, copy;
  scene->SetScene(example());
  copy->DeepCopy(scene);
  copy->SetValue("camera.sensor.columns", "17");
  EXPECT_EQ(copy->GetNumberOfColumns(), 17);
  EXPECT_EQ(scene->GetNumberOfColumns(), 60);
}

TEST(SceneObject, CompiledSceneIsKeptUntilModified) {
  vtkNew<vtkPlenoflameScene> scene;
  scene->SetScene(example());
  const auto first = scene->Compile({});
  EXPECT_EQ(scene->Compile({}), first);
  scene->SetValue("camera.sensor.columns", "50");
  const auto second = scene->Compile({});
  EXPECT_NE(second, first);
  EXPECT_EQ(second->camera.spec().sensor.columns, 50);
}

}  // namespace
}  // namespace plenoflame::test::scene_reader_test
