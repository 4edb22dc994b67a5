#pragma once

class vtkInformation;
class vtkInformationVector;
class vtkPlenoflameScene;

/// For algorithms whose first input is a scene.
namespace plenoflame::pipeline {

/// Says in FillInputPortInformation that a port wants a vtkPlenoflameScene.
void want_scene(vtkInformation& port);

/// The scene that the pipeline passed to port 0; never null in RequestData.
vtkPlenoflameScene* scene_of(vtkInformationVector** inputs);

}  // namespace plenoflame::pipeline
