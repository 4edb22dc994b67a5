// Pictures of scenes, drawn under a virtual X server.
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkIndent.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include "events.h"
#include "support/approx.h"
#include "support/small_scene.h"
#include "support/temporary_folder.h"
#include "vtkPlenoflameScene.h"
#include "vtkPlenoflameScenePicture.h"

namespace plenoflame::test::scene_picture_test {
namespace {

SolidSurfaceSpec solid(SolidShape shape, double reflectivity) {
  SolidSurfaceSpec spec;
  spec.shape = shape;
  spec.position = {1, 0, 0};
  spec.radius = 0.05;
  spec.height = 0.1;
  spec.size = {0.1, 0.1, 0.1};
  spec.extent = {0.1, 0.1};
  spec.material.reflectivity = reflectivity;
  return spec;
}

class ScenePicture : public ::testing::Test {
 protected:
  ScenePicture() {
    spec_ = small_scene(singlet(), large_array(Lattice::hexagonal, LensModel::real));
    spec_.flames.clear();
    picture_->SetSize(300, 200);
    picture_->SetView(vtkPlenoflameScenePicture::FLAME);
    picture_->SetShowAxes(false);
    picture_->SetScene(scene_);
  }
  vtkImageData* drawn(const std::vector<SolidSurfaceSpec>& surfaces) {
    spec_.surfaces = surfaces;
    scene_->SetScene(spec_);
    return picture_->RenderToImage();
  }
  static int value(vtkImageData* image, int column, int row, int channel = 0) {
    return static_cast<int>(image->GetScalarComponentAsDouble(column, row, 0, channel));
  }
  static constexpr int kBackground = 13;  ///< red of it
  /// Pixels that are not the background's colour, of 60000.
  static int inked(vtkImageData* image) {
    int count = 0;
    for (int row = 0; row < 200; ++row)
      for (int column = 0; column < 300; ++column)
        count += std::abs(value(image, column, row) - kBackground) > 6 ? 1 : 0;
    return count;
  }
  Scene spec_;
  vtkNew<vtkPlenoflameScene> scene_;
  vtkNew<vtkPlenoflameScenePicture> picture_;
};

// A ball that fills the height of the picture but for its margin is a disc there.
TEST_F(ScenePicture, BallIsADisc) {
  vtkImageData* const image = drawn({solid(SolidShape::sphere, 0.5)});
  ASSERT_TRUE(image);
  int across = 0, down = 0;
  for (int column = 0; column < 300; ++column)
    across += std::abs(value(image, column, 100) - kBackground) > 6 ? 1 : 0;
  for (int row = 0; row < 200; ++row)
    down += std::abs(value(image, 150, row) - kBackground) > 6 ? 1 : 0;
  EXPECT_GT(down, 80);
  EXPECT_TRUE(relative(across, down, 0.05)) << across << " x " << down;
  EXPECT_TRUE(relative(inked(image), 0.25 * std::acos(-1.0) * across * down, 0.05));
  // It is grey, and lit from the left and above: rows run upwards.
  for (int channel = 1; channel < 3; ++channel)
    EXPECT_EQ(value(image, 150, 100, channel), value(image, 150, 100, 0));
  EXPECT_GT(value(image, 150 - across / 4, 100 + down / 4),
            value(image, 150 + across / 4, 100 - down / 4) + 20);
}

TEST_F(ScenePicture, BrightnessFollowsTheReflectivity) {
  int before = 0;
  for (const double reflectivity : {0.02, 0.2, 0.5, 0.9}) {
    vtkImageData* const image = drawn({solid(SolidShape::sphere, reflectivity)});
    ASSERT_TRUE(image);
    EXPECT_GT(value(image, 150, 100), before + 15) << reflectivity;
    before = value(image, 150, 100);
  }
  // Emitting surfaces are yellow, whatever the light.
  SolidSurfaceSpec lamp = solid(SolidShape::sphere, 0);
  lamp.material.kind = MaterialKind::emitter;
  lamp.material.radiance = 10;
  vtkImageData* const image = drawn({lamp});
  ASSERT_TRUE(image);
  EXPECT_GT(value(image, 150, 100, 0), value(image, 150, 100, 2) + 60);
}

TEST_F(ScenePicture, EveryShapeIsDrawnAndCanBeLeftOut) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("a.obj")) << "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n"
                                         "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  for (const SolidShape shape :
       {SolidShape::sphere, SolidShape::cylinder, SolidShape::cone, SolidShape::disc,
        SolidShape::plane, SolidShape::box, SolidShape::mesh}) {
    SolidSurfaceSpec spec = solid(shape, 0.4);
    if (shape == SolidShape::mesh) spec.file = folder.file("a.obj");
    picture_->SetShowSurfaces(true);
    vtkImageData* const image = drawn({spec});
    ASSERT_TRUE(image);
    EXPECT_GT(inked(image), 2000) << static_cast<int>(shape);
  }
  // The whole scene, with a large ball beside the camera and without it.
  SolidSurfaceSpec ball = solid(SolidShape::sphere, 0.1);
  ball.radius = 0.4;
  picture_->SetView(vtkPlenoflameScenePicture::WHOLE_SCENE);
  picture_->SetShowInsets(false);
  const int with = inked(drawn({ball}));
  EXPECT_GT(with, 5000);
  picture_->SetView(vtkPlenoflameScenePicture::CAMERA);
  const int camera = inked(drawn({ball}));
  picture_->SetView(vtkPlenoflameScenePicture::WHOLE_SCENE);
  picture_->SetShowSurfaces(false);
  // Only the camera is left, as large as it fits.
  EXPECT_TRUE(relative(inked(drawn({ball})), camera, 0.1));
}

TEST_F(ScenePicture, PlaneWithoutEndIsDrawnAroundTheRest) {
  SolidSurfaceSpec floor = solid(SolidShape::plane, 0.5);
  floor.extent = {kInfinity, kInfinity};
  floor.position = {0, 0, -0.05};
  vtkImageData* const image = drawn({floor, solid(SolidShape::sphere, 0.5)});
  ASSERT_TRUE(image);
  EXPECT_GT(inked(image), 30000);
}

TEST_F(ScenePicture, SolidsDoNotHideTheLabelsOfTheAxes) {
  // A cone stands before the label of y. Each label has the colour of its own, which nothing else
  // has.
  picture_->SetSize(600, 400);
  picture_->SetShowAxes(true);
  SolidSurfaceSpec ball = solid(SolidShape::sphere, 0.4), cone = solid(SolidShape::cone, 0.4);
  ball.position = {1.1, 0.1, 0.05};
  vtkImageData* const image = drawn({cone, ball});
  ASSERT_TRUE(image);
  std::array<int, 3> of_colour{};
  for (int row = 0; row < 400; ++row)
    for (int column = 0; column < 600; ++column)
      for (int channel = 0; channel < 3; ++channel)
        of_colour[static_cast<std::size_t>(channel)] +=
            value(image, column, row, channel) >
            20 + std::max(value(image, column, row, (channel + 1) % 3),
                          value(image, column, row, (channel + 2) % 3));
  for (const int count : of_colour) EXPECT_GT(count, 280);
}

TEST_F(ScenePicture, LabelsOfTheAxesStandOnPlates) {
  // The sensor and the microlenses, behind the labels, are brighter than the plates that they stand
  // on.
  spec_.camera.sensor.columns = spec_.camera.sensor.rows = 400;
  picture_->SetSize(600, 400);
  picture_->SetView(vtkPlenoflameScenePicture::ARRAY);
  const auto dark = [&](bool axes) {
    picture_->SetShowAxes(axes);
    vtkImageData* const image = drawn({});
    int count = 0;
    for (int row = 0; row < 400; ++row)
      for (int column = 0; column < 600; ++column)
        count += value(image, column, row) < 80 && value(image, column, row, 1) < 80 &&
                 value(image, column, row, 2) < 80;
    return count;
  };
  const int without = dark(false);
  EXPECT_GT(dark(true), without + 1500);
}

TEST_F(ScenePicture, WrongInputIsAnErrorEvent) {
  {
    SolidSurfaceSpec mesh = solid(SolidShape::mesh, 0.5);
    mesh.file = "/none/a.obj";
    const Events errors(picture_);
    EXPECT_FALSE(drawn({mesh}));
    EXPECT_TRUE(errors.one_with("/none/a.obj")) << errors.all();
  }
  picture_->SetScene(nullptr);
  const Events errors(picture_);
  EXPECT_FALSE(picture_->RenderToImage());
  EXPECT_TRUE(errors.one_with("there is no scene")) << errors.all();
}

TEST_F(ScenePicture, IsWrittenAndPrinted) {
  const TemporaryFolder folder;
  drawn({solid(SolidShape::box, 0.5)});
  EXPECT_TRUE(picture_->WritePNG(folder.file("a.png")));
  std::ifstream file(folder.file("a.png"), std::ios::binary);
  std::array<char, 8> start{};
  file.read(start.data(), 8);
  EXPECT_EQ(std::string(start.data(), 8), "\x89PNG\r\n\x1a\n");
  const Events errors(picture_);
  EXPECT_FALSE(picture_->WritePNG(folder.file("none/a.png")));
  EXPECT_TRUE(errors.one_with("none/a.png")) << errors.all();
  std::ostringstream out;
  picture_->PrintSelf(out, vtkIndent(0));
  for (const char* line : {"View: 3", "Size: 300 200", "ShowSurfaces: 1", "ShowAxes: 0",
                           "RayColoring: 0", "Pixel: -1 -1", "FlameResolution: 96"})
    EXPECT_NE(out.str().find("\n" + std::string(line) + "\n"), std::string::npos) << line << " in\n"
                                                                                  << out.str();
}

}  // namespace
}  // namespace plenoflame::test::scene_picture_test
