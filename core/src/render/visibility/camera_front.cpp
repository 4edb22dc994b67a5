#include "render/visibility/camera_front.h"

#include "render/visibility/aperture_cone.h"

namespace plenoflame {

CameraFront::CameraFront(const Camera& camera)
    : axis_(camera.to_world().direction({0, 0, 1})), vertex_(camera.to_world().translation) {
  if (!camera.spec().lens.surfaces.empty()) distance_ = ApertureCone(camera).front();
}

}  // namespace plenoflame
