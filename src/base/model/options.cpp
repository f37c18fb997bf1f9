// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {
namespace {

constexpr auto kCadFields = std::to_array<OptionField<CadOptions>>({
    // 20 000 triangles approximate a curved body of 0.2 m to some 0.03 mm.
    {"max_triangles", &CadOptions::max_triangles, 20'000, 100, 100'000'000, "",
     "a CAD mesh with more triangles is simplified for tracking, contact and display",
     "lower: detail is lost up to max_error; higher: seconds and hundreds of megabytes more"},
    // Half the noise of a good tracked pose.
    {"max_error", &CadOptions::max_error, 5e-4, 0.0, 0.1, "m",
     "maximum rms error of the simplification; more triangles are kept to stay below it",
     "lower: bodies with fine detail stay large and slow; higher: edges are rounded"},
    {"max_volume_change", &CadOptions::max_volume_change, 0.02, 0.0, 1.0, "",
     "relative change of the volume above which the full mesh is used instead",
     "lower: thin bodies stay large and slow; higher: thin parts may vanish"},
});
static_assert(are_valid_fields(kCadFields));

}  // namespace

CadOptions::CadOptions() { set_defaults(*this, kCadFields); }

OptionSection section_of(CadOptions& options) {
  return make_section("model.cad", options, kCadFields);
}

}  // namespace pcavr
