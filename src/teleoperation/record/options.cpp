// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include "pcavr/teleoperation/record/recorder.hpp"

namespace pcavr {
namespace {

constexpr auto kRecorderFields = std::to_array<OptionField<RecorderOptions>>({
    // Together with the time of a write it is below the half second that a crash may lose.
    {"flush_interval", &RecorderOptions::flush_interval, 0.1, 0.001, 0.4, "s",
     "time after which a message is in the file: what a crash loses",
     "lower: many small chunks in the file; higher: a crash loses more"},
    // Two seconds of a raw colour and depth camera (640 x 480, 30 Hz).
    {"queue_size", &RecorderOptions::queue_size, 64.0, 1.0, 4096.0, "MiB",
     "messages of one source that wait for the file, rounded up to a power of two",
     "lower: a slow disk loses messages; higher: memory"},
    {"tag_interval", &RecorderOptions::tag_interval, 1.0, 0.1, 60.0, "s",
     "time between two images that are searched for declared tags",
     "lower: computing time; higher: tags out of view are noticed late"},
});
static_assert(are_valid_fields(kRecorderFields));

}  // namespace

RecorderOptions::RecorderOptions() { set_defaults(*this, kRecorderFields); }

OptionSection section_of(RecorderOptions& options) {
  return make_section("record", options, kRecorderFields);
}

}  // namespace pcavr
