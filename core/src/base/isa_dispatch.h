#pragma once

#include "plenoflame/base/isa.h"

/// Does the statements after `isa` with `kernels` as a name for the namespace in which the kernels
/// for that instruction set are: PLENOFLAME_DISPATCH(isa, return {kernels::add, kernels::sum};)
/// (A macro, as namespaces cannot be passed to a template.)
#if defined(__x86_64__)
#define PLENOFLAME_DISPATCH(isa, ...) \
  switch (isa) {                      \
    case Isa::avx512: {               \
      namespace kernels = avx512;     \
      __VA_ARGS__                     \
      break;                          \
    }                                 \
    case Isa::avx2: {                 \
      namespace kernels = avx2;       \
      __VA_ARGS__                     \
      break;                          \
    }                                 \
    default: {                        \
      namespace kernels = baseline;   \
      __VA_ARGS__                     \
    }                                 \
  }
#else
#define PLENOFLAME_DISPATCH(isa, ...) \
  switch (isa) {                      \
    default: {                        \
      namespace kernels = baseline;   \
      __VA_ARGS__                     \
    }                                 \
  }
#endif
