// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <immintrin.h>
#define PCAVR_KERNEL fuse_block_avx2
#include "reconstruction/fusion_kernel.inl"
