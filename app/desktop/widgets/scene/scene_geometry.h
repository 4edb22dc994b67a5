#pragma once
#include <vtkImageData.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <vector>

#include "model/schematic.h"
#include "plenoflame/image/image.h"
#include "plenoflame/scene/scene.h"
#include "surface_props.h"

class vtkRenderer;

namespace plenoflame::desktop {

/// All that is drawn of a scene in 3-D; made on any thread.
struct SceneGeometry {
  vtkSmartPointer<vtkMultiBlockDataSet> camera, detail;
  vtkSmartPointer<vtkImageData> plate_texture, flame;

  /// A camera beside the one that everything is about.
  struct Other {
    vtkSmartPointer<vtkMultiBlockDataSet> camera;
    vtkSmartPointer<vtkImageData> plate_texture;
  };
  std::vector<Other> others;
  std::vector<CameraOnAxis> cameras;  ///< the one that everything is about, then the others
  /// Bodies of the same cameras, cut open and closed.
  std::vector<std::array<vtkSmartPointer<vtkPolyData>, 2>> housings;
  views::SolidSurfaces solids;
  std::vector<std::vector<Vec3>> windows;  ///< their outlines

  /// The cameras, and the microlenses near a pixel; nothing before them yet.
  SceneGeometry(const Scene& scene, const std::array<int, 2>& pixel,
                const std::vector<CameraSpec>& others = {});
  /// The solid surfaces and windows of the scene, once its flame is there.
  /// @throws FileError, InputError of mesh and texture files
  void add_surroundings(const Scene& scene);
  /// Adds a camera, as a whole.
  void add(const CameraSpec& camera);
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

/// Pixels in the order of VTK, rows upwards.
vtkSmartPointer<vtkImageData> texture_of(const Image& image);

/// The near plane follows the distance to the objects. The depth buffer's 24 bits then separate
/// surfaces from the whole scene down to a microlens. The far plane holds everything, which costs
/// no depth resolution.
void fit_clipping(vtkRenderer& renderer);

}  // namespace plenoflame::desktop
