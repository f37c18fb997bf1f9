// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/fusion_kernel.hpp"

namespace pcavr {

FusionKernel fusion_kernel() {
#ifdef PCAVR_HAS_AVX2_KERNEL
  if (__builtin_cpu_supports("avx2")) return fuse_block_avx2;
#endif
  return fuse_block_baseline;
}

}  // namespace pcavr
