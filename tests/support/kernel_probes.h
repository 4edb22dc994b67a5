#pragma once
#include <type_traits>
#include <vector>

#include "plenoflame/base/isa.h"

/// The functions of math/kernel_exp.h over arrays, for every instruction set: what
/// tests/core/math/exp_probe_kernel.inl.h defines, which a test that uses this has among its
/// kernels.
namespace plenoflame {

#define PLENOFLAME_DECLARE_PROBES(isa)                                                             \
  namespace isa {                                                                                  \
  void probe_exp_float(const float*, int, float*, float*, float*, float*, float*, float*);         \
  void probe_exp_double(const double*, int, double*, double*, double*, double*, double*, double*); \
  void probe_halvings_float(const float*, int, float*, float*);                                    \
  void probe_halvings_double(const double*, int, double*, double*);                                \
  void probe_source_float(const float*, const float*, int, const float*, float*, int);             \
  void probe_source_double(const double*, const double*, int, const double*, double*, int);        \
  }
PLENOFLAME_DECLARE_PROBES(baseline)
#if defined(__x86_64__)
PLENOFLAME_DECLARE_PROBES(avx2)
PLENOFLAME_DECLARE_PROBES(avx512)
#endif
#undef PLENOFLAME_DECLARE_PROBES

namespace test {

/// Applies math/kernel_exp.h to each number of an array.
template <class Real>
struct Exponentials {
  std::vector<Real> exp, expm1, transmittance, emissivity, far_weight, near_weight;
};

template <class Real>
class KernelProbe {
 public:
  using Exp = void (*)(const Real*, int, Real*, Real*, Real*, Real*, Real*, Real*);
  using Halvings = void (*)(const Real*, int, Real*, Real*);
  using Source = void (*)(const Real*, const Real*, int, const Real*, Real*, int);
  KernelProbe(Isa isa, Exp exp_of, Halvings halvings_of, Source source_of)
      : isa_(isa), exp_(exp_of), halvings_(halvings_of), source_(source_of) {}

  Isa instruction_set() const { return isa_; }
  Exponentials<Real> exponentials(const std::vector<Real>& in) const {
    const std::vector<Real> zero(in.size());
    Exponentials<Real> r{zero, zero, zero, zero, zero, zero};
    exp_(in.data(), static_cast<int>(in.size()), r.exp.data(), r.expm1.data(),
         r.transmittance.data(), r.emissivity.data(), r.far_weight.data(), r.near_weight.data());
    return r;
  }
  /// Transmittance and emissivity of optical thicknesses in units of ln 2; nothing else.
  Exponentials<Real> of_halvings(const std::vector<Real>& in) const {
    const std::vector<Real> zero(in.size());
    Exponentials<Real> r{{}, {}, zero, zero, {}, {}};
    halvings_(in.data(), static_cast<int>(in.size()), r.transmittance.data(), r.emissivity.data());
    return r;
  }
  /// Sum over the terms of weight / (e^(exponent / t) - 1); without terms sigma t^4 / pi.
  std::vector<Real> source(const std::vector<Real>& exponents, const std::vector<Real>& weights,
                           const std::vector<Real>& t) const {
    std::vector<Real> out(t.size());
    source_(exponents.data(), weights.data(), static_cast<int>(exponents.size()), t.data(),
            out.data(), static_cast<int>(t.size()));
    return out;
  }

 private:
  Isa isa_;
  Exp exp_;
  Halvings halvings_;
  Source source_;
};

/// One for each instruction set that the processor has.
template <class Real>
std::vector<KernelProbe<Real>> kernel_probes() {
  std::vector<KernelProbe<Real>> list;
  const auto add = [&](Isa isa, auto ef, auto ed, auto hf, auto hd, auto sf, auto sd) {
    if (!is_supported(isa)) return;
    if constexpr (std::is_same_v<Real, float>)
      list.emplace_back(isa, ef, hf, sf);
    else
      list.emplace_back(isa, ed, hd, sd);
  };
#define PLENOFLAME_ADD(name)                                                                \
  add(Isa::name, name::probe_exp_float, name::probe_exp_double, name::probe_halvings_float, \
      name::probe_halvings_double, name::probe_source_float, name::probe_source_double)
  PLENOFLAME_ADD(baseline);
#if defined(__x86_64__)
  PLENOFLAME_ADD(avx2);
  PLENOFLAME_ADD(avx512);
#endif
#undef PLENOFLAME_ADD
  return list;
}

}  // namespace test
}  // namespace plenoflame
