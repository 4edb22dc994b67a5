#include "render/sampling/microlens_frame.h"

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
KernelFrame<Real> microlens_frame(const PupilTable& table, const PupilNode& node, Vec2 place,
                                  Vec2 field, bool ideal_array) {
  KernelFrame<Real> frame{};
  const Vec2 centre = node.centre * field;
  frame.centre_x = static_cast<Real>(centre.x);
  frame.centre_y = static_cast<Real>(centre.y);
  frame.lens_x = static_cast<Real>(place.x);
  frame.lens_y = static_cast<Real>(place.y);
  const ApertureDiscs& discs = table.discs;
  frame.near_radius = static_cast<Real>(discs.near_radius);
  frame.near_shift = static_cast<Real>(discs.near_shift);
  frame.far_radius = static_cast<Real>(discs.radius);
  frame.far_shift = static_cast<Real>(discs.shift);
  frame.far_growth = static_cast<Real>(discs.growth);
  frame.far_bend = static_cast<Real>(discs.bend);
  const ApertureSides& sides = table.sides;
  frame.side_pairs = sides.pairs;
  for (int k = 0; k < sides.pairs; ++k) {
    const auto pair = static_cast<std::size_t>(k);
    frame.side_x[k] = static_cast<Real>(sides.normals[pair].x);
    frame.side_y[k] = static_cast<Real>(sides.normals[pair].y);
    frame.near_half[k] = static_cast<Real>(sides.near_half[pair]);
    frame.far_half[k] = static_cast<Real>(sides.far_half[pair]);
  }
  // An ideal microlens has a single aperture, which is the near disc.
  frame.finds_far = node.far_reach > 0 && !ideal_array;
  frame.finds_stop = node.stop.known();
  frame.per_unit = static_cast<Real>(1 / table.at_pupil.unit);
  if (frame.finds_far) {
    set_crossing(table.at_far_face, frame.at_far);
    frame.far_reach = static_cast<Real>(node.far_reach);
  }
  if (!frame.finds_stop) return frame;
  set_crossing(table.at_pupil, frame.at_pupil);
  frame.field_x = static_cast<Real>(field.x);
  frame.field_y = static_cast<Real>(field.y);
  frame.stop_reach = static_cast<Real>(node.stop.reach);
  for (std::size_t k = 0; k < node.stop.along.size(); ++k)
    frame.along[k] = static_cast<Real>(node.stop.along[k]);
  for (std::size_t k = 0; k < node.stop.across.size(); ++k)
    frame.across[k] = static_cast<Real>(node.stop.across[k]);
  return frame;
}

template <class Real>
void add_faces(const Camera& camera, int type, KernelFrame<Real>& frame) {
  if (frame.side_pairs == 0 || camera.ideal_array() || camera.misaligned()) return;
  const MicrolensAperture& aperture = camera.aperture();
  const Microlens& lens = camera.microlenses()[static_cast<std::size_t>(type)];
  frame.finds_sides = true;
  for (int k = 0; k < aperture.pairs(); ++k)
    frame.face_half[k] = static_cast<Real>(aperture.half_width(k));
  frame.near_curvature = static_cast<Real>(1 / lens.radius_back);
  frame.per_far_radius = static_cast<Real>(1 / aperture.radius());
}

CutColumn whole_aperture(double bound) {
  const auto b = static_cast<float>(bound);
  return constant_cut({2 * b, 2 * b, 100 * b, 100 * b});
}

template void add_faces(const Camera&, int, KernelFrame<float>&);
template void add_faces(const Camera&, int, KernelFrame<double>&);
template KernelFrame<float> microlens_frame(const PupilTable&, const PupilNode&, Vec2, Vec2, bool);
template KernelFrame<double> microlens_frame(const PupilTable&, const PupilNode&, Vec2, Vec2, bool);

}  // namespace plenoflame
