#pragma once
#include "plenoflame/scene/scene.h"

namespace plenoflame::desktop {

/// Differences between two scenes, sorted by the results that have to be recomputed.
struct SceneChanges {
  bool camera = false;    ///< optics, windows included: rays, images, design
  bool flames = false;    ///< what a flame is or where it stands
  bool solids = false;    ///< surfaces and lights
  bool channels = false;  ///< wavelengths
  bool sampling = false;  ///< estimator, seed, reflections: the image's noise or content
  bool samples = false;   ///< how many rays
  bool develop = false;   ///< how the image is shown: nothing is rendered again
  bool names = false;     ///< labels only
  bool opened = false;    ///< another document: nothing of the scene before is of use
  bool time = false;      ///< the same scene at another moment; its flames are others

  bool compiled() const { return camera || flames || solids || channels; }
  bool image() const { return compiled() || sampling || samples; }
  bool any() const { return image() || develop || names; }
  static SceneChanges all() { return {true, true, true, true, true, true, true, true, false}; }
};

SceneChanges changes_between(const Scene& a, const Scene& b);

}  // namespace plenoflame::desktop
