#pragma once
#include <string>

#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/render/render.h"
#include "settings.h"

namespace plenoflame {

/// Sets the pixels that make a row of a linear problem.
/// @param bin N: blocks of N x N pixels; "micro-image"; "view": cells of each micro-image
/// @param cells of "view", along each side @throws UsageError
void rows_option(const SettingNames& names, const std::string& bin, int cells,
                 CameraRaySettings& rays);

/// The rows of settings that operators and reconstructions share.
template <class Request>
SettingRow<Request> rays_row() {
  return {"rays",
          "N",
          "Rays per pixel and microlens that covers it",
          &Request::rays,
          SettingKind::whole,
          {},
          2,
          kMostSamples};
}
template <class Request>
SettingRow<Request> bin_row() {
  return {"bin", "N|micro-image|view",
          "Pixels of a row: N for blocks of N x N, micro-image, or view: cells within each "
          "micro-image",
          &Request::bin};
}
template <class Request>
SettingRow<Request> cells_row() {
  return {"cells",
          "N",
          "Cells of a micro-image along each side, for view",
          &Request::cells,
          SettingKind::whole,
          {},
          1,
          100};
}

}  // namespace plenoflame
