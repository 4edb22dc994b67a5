#pragma once
#include <vtkBoundingBox.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <vector>

#include "plenoflame/math/vector.h"

class vtkRenderer;

namespace plenoflame {
struct Scene;
}

namespace plenoflame::views {

/// The solid surfaces of a scene as triangles with the colours that they are drawn in: grey as they
/// reflect, yellow where they emit.
struct SolidSurfaces {
  struct Part {
    vtkSmartPointer<vtkPolyData> data;
    bool flat = false;   ///< a plane or disc: its rim is drawn, too
    bool glows = false;  ///< not lit
  };
  std::vector<Part> parts;
  vtkBoundingBox bodies;  ///< of all but planes; invalid when there is none
  vtkBoundingBox all;     ///< planes without end not counted
};

/// @param others what else the picture shows; a plane without end reaches a little beyond it
/// @throws FileError, InputError of mesh and texture files
SolidSurfaces solid_surfaces(const Scene& scene, vtkBoundingBox others);

/// Adds them, and light from the upper left and from the eye.
void add_surfaces(const SolidSurfaces& surfaces, vtkRenderer& renderer);

}  // namespace plenoflame::views
