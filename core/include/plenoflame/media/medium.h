#pragma once
#include <memory>
#include <string>
#include <vector>

#include "plenoflame/base/isa.h"
#include "plenoflame/math/ray_batch.h"
#include "plenoflame/math/vector.h"

namespace plenoflame {

/// Results for a RayBatch: arrays of batch.size entries. Overwritten, not added to.
template <class Real>
struct RadianceBatch {
  /// [W/(m^2 sr)] radiance that reaches t_near, channel c at radiance + c * stride.
  Real* radiance = nullptr;
  int stride = 0;
  Real* transmittance = nullptr;  ///< exp(-optical thickness) of the whole segment
  /// Channel c has its own at transmittance + c * transmittance_stride. 0: one for all; of a medium
  /// that is not grey, the first channel's.
  int transmittance_stride = 0;
};

/// The state of a participating medium at a point.
struct MediumSample {
  double temperature = 0;  ///< [K]
  double absorption = 0;   ///< [1/m]
};

/// Work that a medium left out or did; summed over batches by the caller.
struct MediumCounters {
  double rays = 0;              ///< rays that met the medium's bounds
  double cells = 0;             ///< quadrature intervals computed
  double skipped_empty = 0;     ///< empty bricks stepped over
  double skipped_constant = 0;  ///< bricks integrated in closed form
  double opaque_tails = 0;      ///< rays cut below the transmittance limit
  MediumCounters& operator+=(const MediumCounters& other) {
    rays += other.rays;
    cells += other.cells;
    skipped_empty += other.skipped_empty;
    skipped_constant += other.skipped_constant;
    opaque_tails += other.opaque_tails;
    return *this;
  }
};

/// The place of a flame's own frame in the world: lengths times `scale`, then turned and moved.
struct FlamePlacement {
  double scale = 1;
  RigidTransform frame = {};
};

struct MediumOptions {
  Isa isa = best_isa();
  bool skip = true;  ///< false: no empty, constant or opaque skipping (for comparison)
};

/// An emitting and absorbing medium, compiled and immutable; safe to use from many threads.
/// Emission and absorption follow dL/ds = -kappa_c L + kappa_c S_c(T) for each channel c with which
/// it was compiled, and are integrated deterministically. The channels of a medium are those of the
/// scene or, where absorption depends on wavelength, the wavelengths that stand for them.
class Medium {
 public:
  virtual ~Medium() = default;

  virtual int channel_count() const = 0;
  /// World box outside of which absorption is zero.
  virtual Box bounds() const = 0;
  /// World boxes that together hold every place with absorption; some thousand at most. Rays that
  /// miss all boxes see no absorption. The default is the bounds.
  virtual std::vector<Box> occupied() const { return {bounds()}; }
  /// Tells whether integrating a ray takes so much longer than tracing it through a camera that a
  /// table of radiance may pay.
  virtual bool is_costly() const { return false; }
  /// Tells whether absorption is the same in all channels.
  virtual bool is_grey() const { return true; }
  /// Absorption in a channel is nowhere above this [1/m]; infinite: not known.
  virtual double largest_absorption(int channel) const;
  /// The same of every channel, for what draws places by it.
  /// @throws InputError when the medium does not know it
  std::vector<double> majorants() const;
  /// Absorption in a world box is at most this share of largest_absorption(), in every channel; 1
  /// where nothing better is known.
  virtual double largest_share(const Box&) const { return 1; }
  /// Smallest length over which the medium varies (a voxel, a semi-axis) [m].
  virtual double feature_size() const = 0;

  virtual void integrate(const RayBatch<float>& rays, const MediumOptions& options,
                         RadianceBatch<float> out, MediumCounters& counters) const = 0;
  /// The same formulas in double precision: the reference for the single precision path.
  virtual void integrate(const RayBatch<double>& rays, const MediumOptions& options,
                         RadianceBatch<double> out, MediumCounters& counters) const = 0;

  virtual MediumSample sample(Vec3 world) const = 0;
  /// Source function of a channel [W/(m^2 sr)].
  virtual double source(int channel, double temperature) const = 0;
  /// Coefficients at a point. @param emission receives channel_count() values, absorption times
  /// source function [W/(m^3 sr)]. @return absorption in the first channel [1/m]. Made from
  /// sample(), absorptions() and source() unless a medium knows better: several in one place have
  /// no common temperature.
  virtual double coefficients(Vec3 world, double* emission) const;
  /// Absorption at a point in every channel [1/m]; that of sample() in all of them when grey.
  virtual void absorptions(Vec3 world, double* each) const;
  /// Scattering share of the extinction at a point. Media with such a field return their extinction
  /// as absorption. 0 for all others.
  virtual double albedo(Vec3) const { return 0; }
  /// A medium of one of the channels alone, which shares large data with this one. Media that are
  /// compiled as fast return nullptr.
  virtual std::shared_ptr<const Medium> single_channel(int) const { return nullptr; }
  /// The same flame with another placement, bit for bit as if compiled there. Media that are
  /// compiled as fast return nullptr.
  virtual std::shared_ptr<const Medium> placed(const FlamePlacement&) const { return nullptr; }
  /// Appends every t at which the medium's fields have a jump or a kink along the ray (layer
  /// surfaces, cell faces), unsorted. Between neighbouring values all fields are smooth.
  virtual void append_breakpoints(const Ray& ray, std::vector<double>& t) const = 0;
  /// One line for statistics and `info`.
  virtual std::string description() const = 0;
};

/// Reference integrator for any medium: adaptive Gauss-Kronrod between the breakpoints, in double.
/// Slow; for tests, and for media that overlap.
/// @return radiance per channel [W/(m^2 sr)], then the optical thickness (of the first channel) as
///         the last entry.
std::vector<double> integrate_reference(const Medium& medium, const Ray& ray, double t_near,
                                        double t_far, double relative_tolerance = 1e-10);

/// Several media as one: absorption and emission coefficients add where they overlap. Rays on which
/// the media's extents are disjoint are composed exactly from their own integrals.
std::shared_ptr<const Medium> make_composite_medium(
    std::vector<std::shared_ptr<const Medium>> media);

}  // namespace plenoflame
