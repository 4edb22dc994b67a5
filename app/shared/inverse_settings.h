#pragma once
#include <string>

#include "plenoflame/base/error.h"
#include "plenoflame/inverse/operator_problem.h"
#include "plenoflame/render/render.h"
#include "settings.h"

/// The settings of operators and reconstructions by name and text.
namespace plenoflame {

template <>
std::span<const SettingRow<UnknownsRequest>> setting_rows();
template <>
std::span<const SettingRow<OperatorRequest>> setting_rows();

/// Sets a setting of a request, or of its unknowns, by its name; flags take true or false. Repeated
/// settings are added. @throws UsageError for an unknown name and for numbers out of range
template <class Request>
void set_option(Request& request, const std::string& name, const std::string& text) {
  const SettingNames names = request.unknowns.names;
  if (!set_setting(request, names, name, text) && !set_setting(request.unknowns, names, name, text))
    throw UsageError("there is no setting " + names(name));
}

/// The rows that operators and reconstructions share.
template <class Request>
SettingRow<Request> rays_row() {
  return {"rays", "N", "Rays per pixel and microlens that covers it", &Request::rays,
          between(2, kMostSamples)};
}
template <class Request>
SettingRow<Request> bin_row() {
  return {
      "bin",
      "N|micro-image|view",
      "Pixels of a row: N for blocks of N x N, micro-image, or view: cells within each micro-image",
      &Request::bin,
      any_of("micro-image", "view"),
      between(1, 10000)};
}
template <class Request>
SettingRow<Request> cells_row() {
  return {"cells", "N", "Cells of a micro-image along each side, for view", &Request::cells,
          between(1, 100)};
}

}  // namespace plenoflame
