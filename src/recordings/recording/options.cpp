// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {
namespace {

constexpr auto kReadFields = std::to_array<OptionField<ReadOptions>>({
    // The recording format specifies 20 ms.
    {"max_pair_gap", &ReadOptions::max_pair_gap, 0.02, 0.0, 10.0, "s",
     "maximum time between a colour and a depth image of one frame",
     "lower: frames of cameras without synchronisation are left out; higher: tags and depth of "
     "moving things disagree"},
});
static_assert(are_valid_fields(kReadFields));

}  // namespace

ReadOptions::ReadOptions() { set_defaults(*this, kReadFields); }

OptionSection section_of(ReadOptions& options) {
  return make_section("recording", options, kReadFields);
}

}  // namespace pcavr
