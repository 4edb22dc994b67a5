#pragma once
#include "plenoflame/math/vector.h"

/// The frame of a microlens: along the line from the optical axis to it, and across that.
namespace plenoflame {

/// A vector of camera x, y in that frame; `axis` is the unit vector along its first axis.
inline Vec2 to_local(Vec2 v, Vec2 axis) {
  return {v.x * axis.x + v.y * axis.y, v.y * axis.x - v.x * axis.y};
}

/// The way back.
inline Vec2 to_camera(Vec2 v, Vec2 axis) {
  return {v.x * axis.x - v.y * axis.y, v.x * axis.y + v.y * axis.x};
}

}  // namespace plenoflame
