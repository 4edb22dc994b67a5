#pragma once
#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <vector>

#include "model/image_display.h"
#include "model/schematic.h"
#include "plenoflame/camera/camera.h"
#include "plenoflame/scene/scene.h"
#include "surface_props.h"

class vtkRenderer;

namespace plenoflame::desktop {

inline Vec3 vec(const double* p) {
  return {p[0], p[1], p[2]};
}

/// All that is drawn of a scene in 3-D; made on any thread.
struct SceneGeometry {
  vtkSmartPointer<vtkImageData> flame;
  /// Between which nearly all of its emission lies [K].
  std::array<double, 2> temperatures{0, 0};

  struct Drawn {
    Camera optics;
    vtkSmartPointer<vtkMultiBlockDataSet> parts;  ///< all but the array
    vtkSmartPointer<vtkPolyData> plate;           ///< as which the array is seen from afar
    vtkSmartPointer<vtkImageData> plate_texture;
    std::array<vtkSmartPointer<vtkPolyData>, 2> housings;  ///< cut open, closed
  };
  std::vector<Drawn> drawn;           ///< the camera that everything is about, then the others
  std::vector<CameraOnAxis> cameras;  ///< the same
  views::SolidSurfaces solids;
  std::vector<std::vector<Vec3>> windows;  ///< their outlines

  /// The cameras; nothing before them yet.
  explicit SceneGeometry(Scene scene, const std::vector<CameraSpec>& others = {});
  /// The solid surfaces and windows of the scene, once its flame is there.
  /// @throws FileError, InputError of mesh and texture files
  void add_surroundings(const Scene& scene);
  /// Adds the scene's camera, as a whole.
  void add(const Scene& scene);
  /// The things that the cameras look at.
  std::vector<ThingSeen> things() const;
};

/// A camera as it is drawn.
vtkSmartPointer<vtkMultiBlockDataSet> placed(vtkMultiBlockDataSet& camera,
                                             const Schematic& schematic);
/// Points of the world where they are drawn; the data's own where nothing is moved.
vtkSmartPointer<vtkPolyData> placed(vtkPolyData* data, const Schematic& schematic);

/// Hot and dense everywhere, in some points.
vtkSmartPointer<vtkImageData> small_flame();

/// A light field as it is seen on the sensor; made on any thread.
vtkSmartPointer<vtkImageData> picture_on_sensor(const ImagePyramid& light);

/// The near plane follows the distance to the objects. The depth buffer's 24 bits then separate
/// surfaces from the whole scene down to a microlens. The far plane holds everything, which costs
/// no depth resolution.
void fit_clipping(vtkRenderer& renderer);

}  // namespace plenoflame::desktop
