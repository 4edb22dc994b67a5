#include "widgets/scene/camera_body.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/schematic.h"

namespace plenoflame::desktop {
namespace {

constexpr int kSectors = 96;         ///< around the axis
constexpr double kTubeShare = 1.26;  ///< inner radius of the tube over that of the lens
constexpr double kWall = 0.07;       ///< thickness of walls over the radius
constexpr double kEdge = 25;         ///< [degree] between faces that have an edge of their own

using Bytes = std::array<unsigned char, 3>;
constexpr Bytes kOutside{74, 79, 88}, kInside{40, 43, 49}, kSection{176, 181, 190};

/// A cross-section of the wall: a circle or a rectangle. All [m].
struct Station {
  double outer_z, inner_z;  ///< in the camera's frame
  double half_width, half_height, wall;
  bool round = true;

  double reach(double angle, double by) const {
    if (round) return std::max(0.0, half_width - by);
    return std::min((half_width - by) / std::max(1e-9, std::fabs(std::cos(angle))),
                    (half_height - by) / std::max(1e-9, std::fabs(std::sin(angle))));
  }
};

/// From the front of the tube to the middle of the box's back.
std::vector<Station> stations_of(const Camera& camera) {
  const CameraOnAxis axis(camera);
  const auto& lens = camera.spec().lens;
  double diameter = lens.diameter;
  for (const SurfaceSpec& s : lens.surfaces) diameter = std::max(diameter, s.diameter);
  const SensorSpec& sensor = camera.spec().sensor;
  const double size = sensor.pixel_pitch * std::max(sensor.columns, sensor.rows);
  const double tube = kTubeShare * 0.5 * diameter, wall = kWall * tube;
  const double width = std::max(0.8 * size, 0.5 * tube), height = 0.93 * width;
  const double front = 0.15 * diameter, lens_end = axis.lens_back - 0.2 * diameter;
  const double box = axis.array_front + 0.9 * width;
  const double box_front = std::min(box, lens_end), back = axis.sensor - 0.5 * width;
  const double neck = 0.95 * height, box_wall = kWall * width;
  const double radius = tube + wall, ring = radius + wall;
  std::vector<Station> all;
  const auto round = [&](double z, double r) { all.push_back({z, z, r, r, r - tube}); };
  const auto along = [&](double share) { return front + share * (lens_end - front); };
  round(front, radius);  // with a ring to focus by
  round(along(0.3), radius);
  round(along(0.3), ring);
  round(along(0.75), ring);
  round(along(0.75), radius);
  round(lens_end, radius);
  all.push_back({box_front, box_front - box_wall, neck, neck, box_wall});
  all.push_back({box_front, box_front - box_wall, width, height, box_wall, false});
  all.push_back({back, back + box_wall, width, height, box_wall, false});
  all.push_back({back, back + box_wall, 0, 0, 0});
  return all;
}

/// Light of a room with windows all around, and of its ceiling, by the direction that the glass
/// mirrors.
constexpr const char* kMirror = R"(//VTK::Light::Impl
  vec3 toward = normalize(vertexVC.xyz);
  vec3 mirrored = reflect(toward, normalVCVSOutput);
  vec2 pane = vec2(fract(1.9 * atan(mirrored.x, mirrored.z)), 1.2 * mirrored.y) -
              vec2(0.5, 0.15);
  vec2 open = smoothstep(vec2(0.0), vec2(0.05), vec2(0.2, 0.24) - abs(pane)) *
              smoothstep(vec2(0.01), vec2(0.04), abs(pane));
  float grazing = pow(1.0 - abs(dot(toward, normalVCVSOutput)), 4.0);
  float light = (0.8 + 0.2 * grazing) * open.x * open.y +
                0.6 * grazing * (1.0 - open.x * open.y);
  gl_FragData[0] = vec4(mix(gl_FragData[0].rgb, vec3(0.92, 0.96, 1.0), light),
                        max(gl_FragData[0].a, light));
)";

}  // namespace

vtkSmartPointer<vtkPolyData> housing_of(const Camera& camera, bool half) {
  const std::vector<Station> stations = stations_of(camera);
  const auto count = static_cast<vtkIdType>(stations.size());
  const int sectors = half ? kSectors / 2 : kSectors;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> faces;
  vtkNew<vtkUnsignedCharArray> colours;
  colours->SetNumberOfComponents(3);
  for (int k = 0; k <= sectors; ++k) {
    const double angle = std::numbers::pi * (2.0 * k / kSectors - 0.5);
    for (const Station& s : stations)
      for (const bool inner : {false, true}) {
        const double r = s.reach(angle, inner ? s.wall : 0);
        const Vec3 p = camera.to_world().point(
            {r * std::cos(angle), r * std::sin(angle), inner ? s.inner_z : s.outer_z});
        points->InsertNextPoint(p.x, p.y, p.z);
      }
  }
  const auto id = [&](int sector, vtkIdType station, int inner) {
    return 2 * (sector * count + station) + inner;
  };
  const auto face = [&](std::array<vtkIdType, 4> corners, const Bytes& colour) {
    faces->InsertNextCell(4, corners.data());
    colours->InsertNextTypedTuple(colour.data());
  };
  for (int k = 0; k < sectors; ++k) {
    face({id(k, 0, 0), id(k + 1, 0, 0), id(k + 1, 0, 1), id(k, 0, 1)}, kSection);
    for (vtkIdType i = 0; i + 1 < count; ++i)
      for (const int inner : {0, 1})
        face({id(k, i, inner), id(k + 1, i, inner), id(k + 1, i + 1, inner), id(k, i + 1, inner)},
             inner == 0 ? kOutside : kInside);
  }
  for (const int k : {0, sectors})
    for (vtkIdType i = 0; i + 1 < count && half; ++i)
      face({id(k, i, 0), id(k, i + 1, 0), id(k, i + 1, 1), id(k, i, 1)}, kSection);
  vtkNew<vtkPolyData> housing;
  housing->SetPoints(points);
  housing->SetPolys(faces);
  housing->GetCellData()->SetScalars(colours);
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(housing);
  normals->SetFeatureAngle(kEdge);
  normals->Update();
  return normals->GetOutput();
}

void add_housing(vtkPolyData& housing, vtkRenderer& renderer) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(&housing);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetAmbient(0.35);
  actor->GetProperty()->SetDiffuse(0.75);
  actor->GetProperty()->SetSpecular(0.35);
  actor->GetProperty()->SetSpecularPower(25);
  renderer.AddActor(actor);
}

void mirror_a_room(vtkActor& part) {
  part.GetShaderProperty()->AddFragmentShaderReplacement("//VTK::Light::Impl", true, kMirror,
                                                         false);
}

}  // namespace plenoflame::desktop
