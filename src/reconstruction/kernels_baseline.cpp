// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "reconstruction/find_surfaces.inl"
#include "reconstruction/fuse_block.inl"

namespace pcavr {

extern const Kernels kBaselineKernels;
const Kernels kBaselineKernels = {find_surfaces, fuse_block};

}  // namespace pcavr
