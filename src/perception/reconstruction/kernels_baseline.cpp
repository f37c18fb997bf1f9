// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/reconstruction/find_surfaces.inl"
#include "perception/reconstruction/fuse_block.inl"
#include "perception/reconstruction/image_rows.inl"

namespace pcavr {

extern const Kernels kBaselineKernels;
const Kernels kBaselineKernels = {filter_row,  pool_min,      pool_depth,
                                  pool_colors, find_surfaces, fuse_block};

}  // namespace pcavr
