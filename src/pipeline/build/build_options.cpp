// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "pcavr/base/core/options.hpp"
#include "pcavr/pipeline/build_scene.hpp"

namespace pcavr {
namespace {

constexpr auto kBuildFields = std::to_array<OptionField<BuildOptions>>({
    // Nearby frames see the same cells, and a planner needs no more than 10 Hz.
    {"occupancy_interval", &BuildOptions::occupancy_interval, 0.1, 0.0, 3600.0, "s",
     "time between the frames that carve free space",
     "lower: slower; higher: traces of moving things remain"},
    {"min_weight", &BuildOptions::min_weight, 2.0, 1.0, 15.0, "frames",
     "surface that fewer frames measured is left out",
     "lower: outliers remain; higher: what was seen briefly is missing"},
    // Chosen on held-out depth of seven_scenes, thinned, and franka_charuco: above 30 frames a
    // surface of single frames brings the median less than 0.1 mm.
    {"frames_per_weight", &BuildOptions::frames_per_weight, 30.0, 1.0, 1e6, "frames",
     "recordings with fewer than these for each of min_weight need fewer, where no frame "
     "contradicts",
     "lower: short recordings have holes; higher: outliers of single frames remain"},
    {"min_island", &BuildOptions::min_island, 4e-4, 0.0, 10.0, "m^2",
     "connected surfaces of less area are left out",
     "lower: specks remain; higher: small things are missing"},
    {"level_of_detail_error", &BuildOptions::level_of_detail_error, 0.5, 0.0, 100.0, "voxels",
     "error of the finest level of detail; each further level may have four times that",
     "lower: more triangles than a headset renders at 72 Hz; higher: edges are rounded"},
    {"max_surface_distance", &BuildOptions::max_surface_distance, 0.05, 0.001, 1.0, "m",
     "depth farther from the mesh is an outlier of the reported surface distance",
     "lower: the reported distance is too small; higher: moved things add to it"},
});
static_assert(are_valid_fields(kBuildFields));

}  // namespace

BuildOptions::BuildOptions() { set_defaults(*this, kBuildFields); }

BuildOptions::BuildOptions(double voxel_size, Parallelism parallelism_in) : BuildOptions() {
  fusion.voxel_size = voxel_size;
  parallelism = parallelism_in;
}

SurfaceEvidence surface_evidence(const BuildOptions& options, std::size_t frames) {
  const double weight = std::ceil(static_cast<double>(frames) / options.frames_per_weight);
  return {.min_weight = options.min_weight,
          .min_uncontradicted_weight = std::min(weight, options.min_weight)};
}

OptionSection section_of(BuildOptions& options) {
  return make_section("build", options, kBuildFields);
}

std::vector<OptionSection> sections_of(BuildOptions& options) {
  return {section_of(options.fusion),    section_of(options.outliers),
          section_of(options.occupancy), section_of(options.support_planes),
          section_of(options.texture),   section_of(options)};
}

}  // namespace pcavr
