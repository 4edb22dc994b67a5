#pragma once
#include <string>

#include "plenoflame/base/constants.h"
#include "plenoflame/math/vector.h"

/// Solid surfaces as plain values (scene.h).
namespace plenoflame {

/// Shapes in their own frame: bodies stand on the plane z = 0, a sphere is centred.
enum class SolidShape {
  sphere,    ///< around the origin
  cylinder,  ///< around z, from z = 0 to the height
  cone,      ///< base in z = 0, tip at the height
  disc,      ///< in z = 0, its front towards +z
  plane,     ///< the same, a rectangle or without end
  box,       ///< from z = 0 upwards, centred in x and y
  mesh,      ///< triangles of a file
};

enum class MaterialKind {
  lambertian,  ///< reflects diffusely
  black,       ///< absorbs everything, emits nothing
  blackbody,   ///< absorbs everything, emits at a temperature
  emitter,     ///< absorbs everything, emits a given radiance in all directions
};

/// The sides of a surface that have its material; the other one is black and dark.
enum class MaterialSides { both, front };

enum class TextureKind { none, checkerboard, dots, siemens_star, bars, image };

/// Patterns of the reflectivity over a surface (docs/surfaces.md has pictures). Coordinates u, v of
/// the shapes are lengths on the surface [m]; those of a mesh are its texture coordinates times
/// `size`.
struct TextureSpec {
  TextureKind kind = TextureKind::none;
  double dark = 0;    ///< reflectivity of dark parts; bright parts have the material's
  double cell = 0;    ///< [m] square, spacing of dots, period of the coarsest bars
  int columns = 8;    ///< squares or dots across; pairs of sectors of the star; groups of bars
  int rows = 6;       ///< squares or dots down
  double fill = 0.5;  ///< diameter of a dot over the spacing
  Vec2 size{1, 1};    ///< [m] of the image, or of the square of a star
  std::string file;   ///< image: PNG, relative to the scene file
  friend bool operator==(const TextureSpec&, const TextureSpec&) = default;
};

struct MaterialSpec {
  MaterialKind kind = MaterialKind::lambertian;
  double reflectivity = 0.5;  ///< lambertian
  double temperature = 0;     ///< [K] blackbody
  double radiance = 0;        ///< [W/(m^2 sr)] emitter, in every channel
  MaterialSides sides = MaterialSides::both;
  TextureSpec texture;
  friend bool operator==(const MaterialSpec&, const MaterialSpec&) = default;
};

/// A solid surface of the scene (those of the main lens are SurfaceSpec).
struct SolidSurfaceSpec {
  SolidShape shape = SolidShape::sphere;
  std::string name;
  Vec3 position;                      ///< [m] world place of the origin of its own frame
  Vec3 rotation;                      ///< [rad] about x, then y, then z of the world
  double radius = 0;                  ///< [m] sphere, cylinder, cone, disc
  double height = 0;                  ///< [m] cylinder, cone
  bool caps = true;                   ///< whether cylinder and cone are closed
  Vec2 extent{kInfinity, kInfinity};  ///< [m] plane: full sides along its x and y
  Vec3 size;                          ///< [m] box: full sides
  std::string file;                   ///< mesh: OBJ, PLY or STL, relative to the scene file
  double file_unit = 1;               ///< [m] mesh: what a length of 1 in the file is
  MaterialSpec material;
  friend bool operator==(const SolidSurfaceSpec&, const SolidSurfaceSpec&) = default;
};

}  // namespace plenoflame
