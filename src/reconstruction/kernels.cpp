// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/kernels.hpp"

namespace pcavr {

extern const Kernels kBaselineKernels;
extern const Kernels kAvx2Kernels;

const Kernels& baseline_kernels() { return kBaselineKernels; }

const Kernels& kernels() {
#ifdef PCAVR_HAS_AVX2_KERNELS
  if (__builtin_cpu_supports("avx2")) return kAvx2Kernels;
#endif
  return kBaselineKernels;
}

}  // namespace pcavr
