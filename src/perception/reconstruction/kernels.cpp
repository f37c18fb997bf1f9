// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/kernels.hpp"

namespace pcavr {

extern const Kernels kBaselineKernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;

std::vector<const Kernels*> supported_kernels() {
  std::vector<const Kernels*> supported = {&kBaselineKernels};
#ifdef PCAVR_HAS_X86_KERNELS
  if (__builtin_cpu_supports("avx2")) supported.push_back(&kAvx2Kernels);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
    supported.push_back(&kAvx512Kernels);
  }
#endif
  return supported;
}

const Kernels& kernels() {
  static const Kernels& fastest = *supported_kernels().back();
  return fastest;
}

}  // namespace pcavr
