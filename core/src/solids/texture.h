#pragma once
#include <string>
#include <vector>

#include "plenoflame/math/vector.h"
#include "plenoflame/scene/solid_spec.h"

namespace plenoflame {

/// The reflectivity over a surface, compiled.
class Texture {
 public:
  Texture() = default;
  /// @param light reflectivity where the pattern is not dark   @param folder of the scene file
  /// @throws FileError when an image cannot be read, InputError when it is no picture
  Texture(const TextureSpec& spec, double light, const std::string& folder);

  /// @param at coordinates on the surface [m], the pattern's centre at 0
  double reflectivity(Vec2 at) const;
  /// Corners of a checkerboard inside of it, or centres of dots, row by row from the top left.
  struct Mark {
    int column, row;
    Vec2 at;  ///< [m]
  };
  std::vector<Mark> marks() const;
  /// Smallest length over which the pattern varies [m]; infinite for none.
  double feature_size() const;

 private:
  bool dark(Vec2 at) const;
  bool dark_bar(Vec2 at) const;
  double image_value(Vec2 at) const;

  TextureSpec spec_;
  double light_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<float> pixels_;  ///< of an image, proportional to light, 0 to 1
};

}  // namespace plenoflame
