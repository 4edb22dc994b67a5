// Real corners and centres of a Raytrix R12, found by libpleno. They are not part of this project:
// the test runs where PLENOFLAME_REAL_CAMERAS names a folder whose r12-a holds libpleno's
// examples/config/intrinsics.js and examples/obs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "plenoflame/calibration/geometry_calibration.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/camera/camera_import.h"
#include "support/approx.h"

namespace plenoflame::test::real_raytrix_test {
namespace {

/// Every n-th row of numbers of a table with a heading.
std::vector<std::vector<double>> rows_of(const std::string& path, std::size_t n) {
  std::ifstream file(path);
  std::string line, word;
  std::getline(file, line);
  std::vector<std::vector<double>> rows;
  for (std::size_t k = 0; std::getline(file, line); ++k) {
    if (k % n != 0) continue;
    std::istringstream words(line);
    std::vector<double>& row = rows.emplace_back();
    while (std::getline(words, word, ',')) row.push_back(std::stod(word));
  }
  return rows;
}

TEST(GeometryCalibration, RealRaytrixR12) {
  const char* const folder = std::getenv("PLENOFLAME_REAL_CAMERAS");
  if (!folder) GTEST_SKIP() << "PLENOFLAME_REAL_CAMERAS is not set";
  const std::string path = std::string(folder) + "/r12-a/", boards = path + "bap-R12-A.csv";
  if (!std::filesystem::exists(boards)) GTEST_SKIP() << boards << " does not exist";
  CameraSpec start = import_camera({path + "intrinsics.js"}, {}).camera;
  const Camera camera(start);
  const double scale =
      camera.lens_distance() / (camera.lens_distance() + start.array.sensor_distance);
  // Columns of the boards: k,l,u,v,rho,cluster,frame. The board has 9 x 5 corners, 10 mm apart.
  std::vector<CornerObservation> corners;
  for (const std::vector<double>& row : rows_of(boards, 12)) {
    const int corner = static_cast<int>(row[5]);
    corners.push_back({static_cast<int>(row[6]),
                       {0.01 * (corner % 9), 0.01 * (corner / 9)},
                       {row[2] + 0.5, row[3] + 0.5},
                       {}});
  }
  std::vector<CentreObservation> centres;
  for (const std::vector<double>& row : rows_of(path + "center-R12-A.csv", 40)) {
    const Vec2 pixel{row[2] + 0.5, row[3] + 0.5}, s = camera.sensor_point(pixel.x, pixel.y);
    centres.push_back(
        {camera.lattice().nearest(camera.foot() + scale * (s - camera.foot())), pixel});
  }
  ASSERT_GT(corners.size(), 1200u);
  const GeometryCalibration found = calibrate_geometry(start, corners, centres);
  std::printf("Raytrix R12: %.3f pixel RMS of %zu corners, %.3f of centres\n", found.corner_rms,
              found.corners, found.centre_rms);
  for (const CalibratedValue& value : found.values) {
    std::printf("%s %.6g +- %.2g\n", value.key.c_str(), value.value, value.error);
    // The lens' name, and libpleno's distance of the sensor.
    if (value.key == "camera.lens.focal_length") {
      EXPECT_TRUE(within_standard_errors(value.value, 0.05, value.error, 2));
    }
    if (value.key == "camera.array.sensor_distance") {
      EXPECT_TRUE(within_standard_errors(value.value, 0.339e-3, value.error, 3));
    }
  }
  // libpleno's corners lie outwards, by another part in each type.
  EXPECT_GT(found.outwards_scatter, 0.01);
  EXPECT_EQ(found.poses.size(), 16u);
  EXPECT_LT(found.corner_rms, 0.97);  // libpleno's
}

}  // namespace
}  // namespace plenoflame::test::real_raytrix_test
