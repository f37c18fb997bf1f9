// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/kernels.hpp"

namespace pcavr {

extern const Kernels kBaselineKernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;

std::vector<const Kernels*> runnable_kernels() {
  std::vector<const Kernels*> runnable = {&kBaselineKernels};
#ifdef PCAVR_HAS_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) runnable.push_back(&kAvx2Kernels);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    runnable.push_back(&kAvx512Kernels);
  }
#endif
  return runnable;
}

const Kernels& kernels() {
  static const Kernels& fastest = *runnable_kernels().back();
  return fastest;
}

}  // namespace pcavr
