// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#define PCAVR_KERNEL fuse_block_baseline
#include "reconstruction/fusion_kernel.inl"
