// Exponentials for emission and absorption in the vector kernels: branch-free templates over float
// and double, compiled once per instruction set (see kernel_math.h).
//
// Reduction: x = n ln 2 + r, |r| <= (ln 2)/2. Source: Cody and Waite, Software Manual for the
// Elementary Functions, 1980, chapter 6. With a Chebyshev fit q, e^r - 1 = r + r^2 q(r). Then e^x =
// 2^n + 2^n (e^r - 1) and e^x - 1 = (2^n - 1) + 2^n (e^r - 1). One reduction gives both, and
// neither cancels. NaN counts as "nothing": no exponential here returns NaN.
#pragma once

#include "math/kernel_math.h"

namespace plenoflame::PLENOFLAME_ISA {

namespace exp_detail {

// (e^r - 1 - r) / r^2 on |r| <= (ln 2)/2; absolute errors 1.4e-9 (float) and 1.4e-18 (double).
PLENOFLAME_INLINE float quotient(float r) {
  return 0.5f + r * (0.16666666681623f +
                     r * (0.041666464925286f +
                          r * (0.0083333109254809f +
                               r * (0.00139336499963093f + r * 0.000198909908246737f))));
}
PLENOFLAME_INLINE double quotient(double r) {
  return 0.5 + r * (0.16666666666666670991 +
                    r * (0.041666666666666669755 +
                         r * (0.0083333333333261351258 +
                              r * (0.0013888888888883748305 +
                                   r * (0.00019841269874820625271 +
                                        r * (0.000024801587325547741216 +
                                             r * (2.755725540020642443e-6 +
                                                  r * (2.7557273643110295328e-7 +
                                                       r * (2.5105217004720745164e-8 +
                                                            r * 2.0914686968087677233e-9)))))))));
}

// (1 - e^-t - t e^-t) / t^2 on 0 <= t <= 1.5; relative errors 5.4e-9 and 9.7e-20.
PLENOFLAME_INLINE float far_series(float t) {
  return 0.5f + t * (-0.33333324164f +
                     t * (0.124998708108f +
                          t * (-0.0333263576652f +
                               t * (0.00692579272144f +
                                    t * (-0.00116302360204f +
                                         t * (0.000150636025838f + t * -1.13943346758e-5f))))));
}
PLENOFLAME_INLINE double far_series(double t) {
  const double high =
      2.4801506939344303835e-6 +
      t * (-2.5050966677566747076e-7 +
           t * (2.2952694461587946994e-8 +
                t * (-1.9184030370270019201e-9 +
                     t * (1.4458848725596930265e-10 +
                          t * (-9.1006250297391295131e-12 + t * 3.5700269786712745143e-13)))));
  return 0.5 + t * (-0.33333333333333332762 +
                    t * (0.12499999999999971522 +
                         t * (-0.033333333333327728352 +
                              t * (0.0069444444443866293852 +
                                   t * (-0.0011904761901167511746 +
                                        t * (0.00017361110965113204477 +
                                             t * (-0.000022045851307760905 + t * high)))))));
}

// 2^f - 1 on |f| <= 1/2: f ln 2 + (f ln 2)^2 q(f ln 2).
PLENOFLAME_INLINE float power_minus_one(float f) {
  return f * (0.693147181f +
              f * (0.240226507f +
                   f * (0.0555041087f +
                        f * (0.00961808254f +
                             f * (0.00133335223f + f * (0.000154531729f + f * 1.52909562e-5f))))));
}
PLENOFLAME_INLINE double power_minus_one(double f) {
  const double r = f * 0.69314718055994530942;
  return r + r * r * quotient(r);
}

// At this number of halvings power_of_two() returns 0 for 2^-n.
PLENOFLAME_INLINE float most_halvings(float) {
  return 127.0f;
}
PLENOFLAME_INLINE double most_halvings(double) {
  return 1023.0;
}

// 2^n for whole n, given as n + kRound: the low bits of that sum are n in two's complement.
PLENOFLAME_INLINE float power_of_two(float shifted) {
  return __builtin_bit_cast(float, (__builtin_bit_cast(unsigned, shifted) << 23) + 0x3F800000u);
}
PLENOFLAME_INLINE double power_of_two(double shifted) {
  return __builtin_bit_cast(
      double, (__builtin_bit_cast(unsigned long, shifted) << 52) + 0x3FF0000000000000ul);
}

// The constants that differ between the two precisions.
PLENOFLAME_INLINE float round_shift(float) {
  return 12582912.0f;
}  // 1.5 * 2^23
PLENOFLAME_INLINE double round_shift(double) {
  return 6755399441055744.0;
}  // 1.5 * 2^52
PLENOFLAME_INLINE float lowest_exponent(float) {
  return -87.3f;
}  // e^x still a normal number
PLENOFLAME_INLINE double lowest_exponent(double) {
  return -708.3;
}
PLENOFLAME_INLINE float highest_exponent(float) {
  return 88.0f;
}  // 2^n still finite
PLENOFLAME_INLINE double highest_exponent(double) {
  return 709.0;
}
// ln 2 in two parts; n * high is exact.
PLENOFLAME_INLINE float ln2_high(float) {
  return 0x1.62ep-1f;
}
PLENOFLAME_INLINE double ln2_high(double) {
  return 0x1.62e42fefa38p-1;
}
PLENOFLAME_INLINE float ln2_low(float) {
  return 0x1.0bfbe8e7bcd5ep-15f;
}
PLENOFLAME_INLINE double ln2_low(double) {
  return 0x1.ef35793c76730p-45;
}

template <class Real>
struct Reduced {
  Real shifted;    // n + round_shift
  Real minus_one;  // e^r - 1
};

template <class Real>
PLENOFLAME_INLINE Reduced<Real> reduce(Real x) {
  const Real shift = round_shift(Real());
  const Real shifted = x * Real(1.44269504088896340736) + shift;
  const Real n = shifted - shift;
  const Real r = (x - n * ln2_high(Real())) - n * ln2_low(Real());
  return {shifted, r + r * r * quotient(r)};
}

template <class Real>
PLENOFLAME_INLINE Real into_range(Real x) {
  return clamp(x, lowest_exponent(Real()), highest_exponent(Real()));
}

}  // namespace exp_detail

/// e^x to 1 ulp. Below the smallest normal number (x < -87.3 or -708.3), and for NaN: 0. Above e^88
/// (e^709) it saturates there.
template <class Real>
PLENOFLAME_INLINE Real exponential(Real x) {
  const auto reduced = exp_detail::reduce(exp_detail::into_range(x));
  const Real scale = exp_detail::power_of_two(reduced.shifted);
  const Real value = scale + scale * reduced.minus_one;
  return x >= exp_detail::lowest_exponent(Real()) ? value : Real(0);
}

/// e^x - 1 to 2 ulp, also near 0; -1 for very negative x and NaN; saturates like exponential().
template <class Real>
PLENOFLAME_INLINE Real exponential_minus_one(Real x) {
  const auto reduced = exp_detail::reduce(exp_detail::into_range(x));
  const Real scale = exp_detail::power_of_two(reduced.shifted);
  return (scale - Real(1)) + scale * reduced.minus_one;
}

/// Transmittance and emissivity of an optical thickness.
template <class Real>
struct Attenuation {
  Real transmittance;  ///< e^-tau
  Real emissivity;     ///< 1 - e^-tau, without cancellation
};

/// The attenuation that belongs to a reduced exponent.
template <class Real>
PLENOFLAME_INLINE Attenuation<Real> attenuation(const exp_detail::Reduced<Real>& reduced) {
  const Real scale = exp_detail::power_of_two(reduced.shifted);
  const Real scaled = scale * reduced.minus_one;
  return {scale + scaled, (Real(1) - scale) - scaled};
}

/// @param tau >= 0; negative and NaN count as 0, infinity gives {0, 1}. Transmittances just below
/// the smallest normal number are subnormal; smaller ones are 0.
template <class Real>
PLENOFLAME_INLINE Attenuation<Real> attenuation(Real tau) {
  const Real t = least(greatest(tau, Real(0)),
                       exp_detail::most_halvings(Real()) * Real(0.69314718055994530942));
  return attenuation(exp_detail::reduce(-t));
}

/// The same of an optical thickness in units of ln 2 (half-value layers), which spares part of the
/// reduction.
template <class Real>
PLENOFLAME_INLINE Attenuation<Real> attenuation_of_halvings(Real halvings) {
  const Real t = least(greatest(halvings, Real(0)), exp_detail::most_halvings(Real()));
  const Real shift = exp_detail::round_shift(Real());
  const Real shifted = shift - t;
  return attenuation(
      exp_detail::Reduced<Real>{shifted, exp_detail::power_minus_one((shift - shifted) - t)});
}

/// One interval whose source function is linear in optical thickness:
/// L_out = L_in transmittance + far_weight S_far + near_weight S_near,
/// with psi = (1 - e^-tau)/tau, far_weight = psi - e^-tau, near_weight = 1 - psi.
template <class Real>
struct LinearTransfer {
  Real transmittance;
  Real far_weight;   ///< of the source function where the light enters (away from the camera)
  Real near_weight;  ///< of the source function where it leaves (towards the camera)
};

/// All three are relatively accurate for every tau >= 0 (negative and NaN count as 0). The weights
/// add up to the emissivity. near_weight is the emissivity less far_weight. The latter is at most
/// half of it, so nothing cancels, and one polynomial below tau = 1.5 serves both.
template <class Real>
PLENOFLAME_INLINE LinearTransfer<Real> linear_transfer(Real tau) {
  const Real t = greatest(tau, Real(0));
  const Attenuation<Real> a = attenuation(t);
  const Real small = t * exp_detail::far_series(t);
  const Real large = a.emissivity / greatest(t, Real(1)) - a.transmittance;
  const Real far_weight = t < Real(1.5) ? small : large;
  return {a.transmittance, far_weight, a.emissivity - far_weight};
}

/// One quadrature node of Planck's function, weight / (e^(exponent/T) - 1). Its error is about (1 +
/// exponent/T) ulp, the limit for this argument. There is no overflow or underflow on the way. The
/// result is 0 only when it is below the smallest normal number, or T is not above 0 (or NaN).
/// @param exponent hc/(lambda k) [K]
/// @param temperature [K]
template <class Real>
PLENOFLAME_INLINE Real planck_term(Real exponent, Real weight, Real temperature) {
  const Real lowest = exp_detail::lowest_exponent(Real());
  const bool emits = temperature > Real(0);
  const Real x = -exponent / (emits ? least(temperature, Real(1e12)) : Real(1));
  // e^x in two factors around the weight, so that e^x itself may lie below the smallest number.
  const auto reduced = exp_detail::reduce(greatest(x, Real(2) * lowest));
  const Real shift = exp_detail::round_shift(Real());
  const Real n = reduced.shifted - shift;
  const Real half_shifted = Real(0.5) * n + shift;
  const Real rest_shifted = (n - (half_shifted - shift)) + shift;
  const Real half = exp_detail::power_of_two(half_shifted);
  const Real rest = exp_detail::power_of_two(rest_shifted);
  const Real whole = half * rest;  // 2^n; 0 when e^x is lost beside 1
  const Real scaled = whole * reduced.minus_one;
  const Real emissivity = (Real(1) - whole) - scaled;
  const Real value = weight * half * (Real(1) + reduced.minus_one) * rest / emissivity;
  return emits && x > Real(2) * lowest ? value : Real(0);
}

/// sigma T^4 / pi [W/(m^2 sr)]; 0 for T below 0 or NaN.
template <class Real>
PLENOFLAME_INLINE Real total_radiance(Real temperature) {
  const Real t = greatest(temperature, Real(0));
  const Real squared = t * t;
  return Real(1.8049362359900739e-8) * squared * squared;
}

/// Source function S(T) of one channel, for kernels: plain arrays made from
/// SourceFunction::nodes().
template <class Real>
struct SourceTable {
  const Real* exponents;
  const Real* weights;
  int count;  ///< 0: sigma T^4 / pi
};

/// out[i] = S(temperature[i]) for i < size.
template <class Real>
PLENOFLAME_INLINE void evaluate_source(const SourceTable<Real>& source,
                                       const Real* __restrict temperature, Real* __restrict out,
                                       int size) {
  if (source.count == 0) {
    for (int i = 0; i < size; ++i) out[i] = total_radiance(temperature[i]);
    return;
  }
  for (int i = 0; i < size; ++i)
    out[i] = planck_term(source.exponents[0], source.weights[0], temperature[i]);
  for (int k = 1; k < source.count; ++k) {
    const Real exponent = source.exponents[k], weight = source.weights[k];
    for (int i = 0; i < size; ++i) out[i] += planck_term(exponent, weight, temperature[i]);
  }
}

}  // namespace plenoflame::PLENOFLAME_ISA
