#include <vtkAppendPolyData.h>
#include <vtkExecutive.h>
#include <vtkImageData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <iostream>
#include <string>
#include <vector>

#include "error_log.h"
#include "plenoflame/base/printable.h"
#include "plenoflame/image/atomic_file.h"
#include "vtkPlenoflameLightFieldReader.h"
#include "vtkPlenoflameRayPathSource.h"
#include "vtkPlenoflameScene.h"
#include "vtkPlenoflameScenePicture.h"
#include "vtk_commands.h"

namespace plenoflame {
namespace {

void update(vtkAlgorithm* algorithm, ErrorLog& log) {
  log.watch(algorithm);
  log.watch(algorithm->GetExecutive());
  algorithm->Update();
  log.check();
}

/// Rays of one camera, which the scene names.
vtkSmartPointer<vtkPolyData> traced_rays(const PictureRequest& request, vtkPlenoflameScene* scene,
                                         ErrorLog& log) {
  vtkNew<vtkPlenoflameRayPathSource> source;
  source->SetInputDataObject(scene);
  for (const auto& pixel : request.pixels) source->AddPixel(pixel[0], pixel[1]);
  for (const auto& lens : request.microlenses) source->AddMicrolens(lens[0], lens[1]);
  for (const auto& point : request.points) source->AddObjectPoint(point[0], point[1], point[2]);
  source->SetChiefRays(request.chief);
  source->SetNumberOfRandomPixels(request.random);
  source->SetRaysPerPixel(request.rays);
  source->SetRaysPerPoint(request.rays);
  source->SetMaximumNumberOfRays(request.most);
  update(source, log);
  return source->GetOutput();
}

vtkSmartPointer<vtkPolyData> rays_of(const PictureRequest& request, vtkPlenoflameScene* scene,
                                     ErrorLog& log) {
  if (!request.rays_file.empty()) {
    static_cast<void>(read_file(request.rays_file));  // a message of ours when it is not there
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->SetFileName(request.rays_file.c_str());
    update(reader, log);
    return reader->GetOutput();
  }
  if (request.pixels.empty() && request.microlenses.empty() && request.points.empty() &&
      !request.chief && request.random == 0)
    return vtkSmartPointer<vtkPolyData>::New();
  std::vector<std::string> cameras = request.cameras;
  if (cameras.empty())
    for (int i = 0; i < scene->GetNumberOfCameras(); ++i)
      cameras.push_back(scene->GetCameraName(i));
  const std::string chosen = scene->GetCamera();
  vtkNew<vtkAppendPolyData> all;
  for (const std::string& camera : cameras) {
    scene->SetCamera(camera);
    log.check();
    all->AddInputData(traced_rays(request, scene, log));
  }
  scene->SetCamera(chosen);
  all->Update();
  return all->GetOutput();
}

}  // namespace
}  // namespace plenoflame

extern "C" __attribute__((visibility("default"))) void plenoflame_make_picture(
    const plenoflame::PictureRequest& request) {
  using namespace plenoflame;
  using namespace plenoflame;
  if (!vtkPlenoflameScenePicture::CanRender())
    throw InputError(vtkPlenoflameScenePicture::GetWhyNot());
  Execution execution;
  execution.message = [](Severity, const std::string& text) {
    std::cerr << "plenoflame: warning: " << printable(text) << '\n';
  };
  ErrorLog log(execution);
  vtkNew<vtkPlenoflameScene> scene;
  log.watch(scene);
  if (request.values)
    scene->SetScene(*request.values);
  else
    scene->ReadFile(request.scene);
  log.check();
  if (!request.cameras.empty()) scene->SetCamera(request.cameras.front());
  log.check();
  vtkNew<vtkPlenoflameScenePicture> picture;
  log.watch(picture);
  picture->SetScene(scene);
  vtkNew<vtkPlenoflameLightFieldReader> reader;
  if (!request.image.empty()) {
    reader->SetFileName(request.image.c_str());
    update(reader, log);
    picture->SetSensorImage(reader->GetOutput());
  }
  const auto rays = rays_of(request, scene, log);
  picture->SetRays(rays);
  if (!request.pixels.empty())
    picture->SetPixel(request.pixels.front()[0], request.pixels.front()[1]);
  picture->SetView(request.view);
  picture->SetRayColoring(request.by_status ? vtkPlenoflameScenePicture::BY_STATUS
                                            : vtkPlenoflameScenePicture::BY_TYPE);
  picture->SetSize(request.size[0], request.size[1]);
  picture->SetShowFlame(request.flame);
  picture->SetShowSurfaces(request.surfaces);
  picture->SetShowInsets(request.insets);
  picture->SetShowAxes(request.axes);
  picture->WritePNG(request.output);
  log.check();
}
