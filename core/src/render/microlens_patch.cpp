#include "render/microlens_patch.h"

namespace plenoflame {
namespace {

template <class Real>
void set_crossing(const RayCrossing& from, KernelCrossing<Real>& to) {
  for (std::size_t k = 0; k < RayCrossing::kTerms; ++k) {
    to.of_sensor[k] = static_cast<Real>(from.of_sensor[k]);
    to.of_aim[k] = static_cast<Real>(from.of_aim[k]);
  }
}

}  // namespace

template <class Real>
KernelPatch<Real> microlens_patch(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array) {
  KernelPatch<Real> patch{};
  const Vec2 centre = node.centre * field;
  patch.centre_x = static_cast<Real>(centre.x);
  patch.centre_y = static_cast<Real>(centre.y);
  patch.lens_x = static_cast<Real>(place.x);
  patch.lens_y = static_cast<Real>(place.y);
  const ApertureDiscs& discs = table.discs;
  patch.near_radius = static_cast<Real>(discs.near_radius);
  patch.near_shift = static_cast<Real>(discs.near_shift);
  patch.far_radius = static_cast<Real>(discs.radius);
  patch.far_shift = static_cast<Real>(discs.shift);
  patch.far_growth = static_cast<Real>(discs.growth);
  patch.far_bend = static_cast<Real>(discs.bend);
  // An ideal microlens has one aperture, which the near disc is.
  patch.finds_far = node.far_reach > 0 && !ideal_array;
  patch.finds_stop = node.stop.known();
  patch.searches_stop = patch.finds_stop && table.sharp_stop;
  patch.per_unit = static_cast<Real>(1 / table.at_pupil.unit);
  if (patch.finds_far) {
    set_crossing(table.at_far_face, patch.at_far);
    patch.far_reach = static_cast<Real>(node.far_reach);
  }
  if (!patch.finds_stop) return patch;
  set_crossing(table.at_pupil, patch.at_pupil);
  patch.field_x = static_cast<Real>(field.x);
  patch.field_y = static_cast<Real>(field.y);
  patch.stop_reach = static_cast<Real>(node.stop.reach);
  for (std::size_t k = 0; k < node.stop.along.size(); ++k)
    patch.along[k] = static_cast<Real>(node.stop.along[k]);
  for (std::size_t k = 0; k < node.stop.across.size(); ++k)
    patch.across[k] = static_cast<Real>(node.stop.across[k]);
  return patch;
}

CutColumn whole_aperture(double bound) {
  const auto b = static_cast<float>(bound);
  return constant_cut({2 * b, 2 * b, 100 * b, 100 * b});
}

template KernelPatch<float> microlens_patch(const PupilTable&, const PupilNode&, Vec2, Vec2, bool);
template KernelPatch<double> microlens_patch(const PupilTable&, const PupilNode&, Vec2, Vec2, bool);

}  // namespace plenoflame
