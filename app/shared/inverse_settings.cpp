#include "inverse_settings.h"

#include <fmt/format.h>

#include <algorithm>

namespace plenoflame {
namespace {

std::string absorption_text(const UnknownsRequest& request) {
  if (request.absorption_of_scene) return "scene";
  return request.absorption > 0 ? fmt::format("{} 1/m", request.absorption) : "";
}

void set_absorption(UnknownsRequest& request, const SettingReader& value) {
  request.absorption_of_scene = value.text() == "scene";
  request.absorption = 0;
  if (value.text().empty() || value.text() == "none" || request.absorption_of_scene) return;
  request.absorption = value.quantity(Dimension::absorption);
  if (!(request.absorption > 0)) throw UsageError(value.setting() + " must be above 0, or none");
}

}  // namespace

template <>
std::span<const SettingRow<UnknownsRequest>> setting_rows() {
  using R = UnknownsRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"unknowns", "KIND",
       "voxels; rings x heights around an axis; ellipsoidal layers that fill the block",
       setting_choice<&R::kind, R>(), any_of("voxels", "rings", "layers")},
      {"grid", "N[,N,N]",
       "Voxels along the longest side or along all three, NX,NY,NZ (32); rings and heights, N,M "
       "(40,80); layers (10)",
       &R::grid, between(1, 100000)},
      {"center", "X,Y,Z",
       "Middle of the block, \"1 m, 0 m, 5 mm\"; without it, that of the scene's flames",
       &R::centre, lengths},
      {"size", "X,Y,Z",
       "Its sides, \"40 mm, 40 mm, 60 mm\", or auto: those of the scene's flames, or by the "
       "pictures (auto)",
       &R::size, any_of("auto"), lengths},
      {"axis", "X,Y,Z",
       "Direction of the rings' axis through the block's middle (\"0 m, 0 m, 1 m\"), or fit: place "
       "and direction by the pictures",
       SettingText<R>{[](const R& r) {
                        return r.axis ? setting_text(*r.axis)
                                      : std::string(r.fits_axis ? "fit" : "");
                      },
                      [](R& r, const SettingReader& value) {
                        r.fits_axis = value.text() == "fit";
                        r.axis.reset();
                        if (!r.fits_axis && !value.text().empty()) r.axis = value.lengths();
                      }},
       lengths},
      {"basis", "KIND", "Of voxels: trilinear or constant", setting_choice<&R::basis, R>(),
       any_of("trilinear", "constant")},
      {"absorption", "WHICH",
       "Known absorption: none (no temperature is found), a value like \"8 1/m\" everywhere, or "
       "scene: that of the scene's flames (none)",
       SettingText<R>{absorption_text, set_absorption}}};
  return rows;
}

template <>
std::span<const SettingRow<OperatorRequest>> setting_rows() {
  using R = OperatorRequest;
  using enum SettingKind;
  static const std::vector<SettingRow<R>> rows{
      {"channel", "NAME", "Channel of the rays' wavelengths; without it, the first", &R::channel},
      rays_row<R>(),
      bin_row<R>(),
      cells_row<R>(),
      {"seed", "N", "Seed of the rays (default: the scene's)", &R::seed},
      {"form", "FORM", "rays: kept in memory; drawn: a part at a time; auto: kept if they fit",
       SettingChoice<R>{
           [](const R& r) { return std::max(static_cast<int>(r.form) - 1, 0); },
           [](R& r, int n) { r.form = static_cast<OperatorForm>(n == 0 ? 0 : n + 1); }},
       any_of("auto", "rays", "drawn")}};
  return rows;
}

}  // namespace plenoflame
