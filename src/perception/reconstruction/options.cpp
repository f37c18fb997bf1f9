// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/perception/reconstruction/cloud_filter.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

namespace pcavr {
namespace {

constexpr auto kFusionFields = std::to_array<OptionField<TsdfOptions>>({
    {"voxel_size", &TsdfOptions::voxel_size, 0.005, ranges::kVoxel.min, ranges::kVoxel.max, "m",
     "edge of a voxel of the fused surface",
     "lower: half costs four times the memory and shows noise; higher: detail is lost"},
    // Both defaults by held-out depth of a Kinect and a RealSense (pcavr_bench_held_out).
    {"truncation_voxels", &TsdfOptions::truncation_voxels, 3.0, 2.0, 20.0, "voxels",
     "distance from a surface up to which its signed distance is stored",
     "lower: noise causes holes; higher: thin walls and edges thicken"},
    {"truncation_std", &TsdfOptions::truncation_std, 2.0, 0.0, 10.0, "std",
     "the same distance in standard deviations of depth; the larger of the two is used",
     "lower: noise causes several surfaces behind one another; higher: far surfaces are blurred"},
    // The voxels' counters have four bits.
    {"frames_to_clear", &TsdfOptions::frames_to_clear, 3, 1, 15, "",
     "minimum frames that must see a voxel as free to remove what as many or fewer measured there",
     "lower: single bad frames cause holes; higher: traces of moved objects remain"},
});
static_assert(are_valid_fields(kFusionFields));

constexpr auto kOutlierFields = std::to_array<OptionField<OutlierOptions>>({
    {"neighbours", &OutlierOptions::neighbours, 12, 1, 1000, "",
     "nearest neighbours of a point whose mean distance is tested",
     "lower: pairs of outliers remain; higher: slower, and small surfaces vanish"},
    {"std_multiplier", &OutlierOptions::std_multiplier, 4.0, 0.1, 100.0, "std",
     "distance above the cloud's mean from which a point is an outlier",
     "lower: boundaries of sparse surfaces are eroded; higher: outliers remain"},
});
static_assert(are_valid_fields(kOutlierFields));

}  // namespace

TsdfOptions::TsdfOptions() { set_defaults(*this, kFusionFields); }

TsdfOptions::TsdfOptions(double voxel_size_in) : TsdfOptions() { voxel_size = voxel_size_in; }

OutlierOptions::OutlierOptions() { set_defaults(*this, kOutlierFields); }

OptionSection section_of(TsdfOptions& options) {
  return make_section("reconstruction.fusion", options, kFusionFields);
}

OptionSection section_of(OutlierOptions& options) {
  return make_section("reconstruction.outliers", options, kOutlierFields);
}

}  // namespace pcavr
