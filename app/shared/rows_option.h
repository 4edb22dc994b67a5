#pragma once
#include <algorithm>

#include "plenoflame/inverse/camera_rays.h"
#include "plenoflame/render/render.h"
#include "settings.h"

namespace plenoflame {

/// Pixels of a row: N x N, or these.
inline constexpr int kMicroImage = -1, kView = -2;

/// Sets the pixels that make a row of a linear problem.
template <class Request>
void take_rows(const Request& request, CameraRaySettings& rays) {
  rays.bin = std::max(request.bin, 1);
  rays.cells = request.bin == kView ? request.cells : request.bin == kMicroImage ? 1 : 0;
}

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
  return {"bin",
          "N|micro-image|view",
          "Pixels of a row: N for blocks of N x N, micro-image, or view: cells within each "
          "micro-image",
          &Request::bin,
          SettingKind::text,
          {"micro-image", "view"},
          1,
          10000};
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
