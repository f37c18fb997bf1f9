// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "pipeline/input_faults.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> recordings_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const bool is_recording = entry.path().filename() == "recording.yaml";
    if (is_recording && fs::exists(entry.path().parent_path() / "tracked")) {
      found.push_back(entry.path().parent_path());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

IdentificationInput input_of(const fs::path& folder) {
  const Expected<Recording> recording = read_recording(folder);
  EXPECT_TRUE(recording.has_value()) << recording.error().to_string();
  Expected<IdentificationInput> input =
      identification_input(*recording, {.tracked = folder / "tracked"});
  EXPECT_TRUE(input.has_value()) << input.error().to_string();
  return *input;
}

/// Whether the exponent is stated or assumed, not identified.
bool is_exponent_given(const ObjectParameters& parameters) {
  return std::ranges::count(parameters.sources.given, "contact.exponent") > 0;
}

/// Expects no fault, and every identified exponent within 4 std.
void expect_sound(const fs::path& folder) {
  const auto found = identify(input_of(folder), IdentificationGoal::friction);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  for (const std::string& note : found->notes) EXPECT_FALSE(reports_fault(note)) << folder << note;
  const Expected<ParameterTable> truth = read_parameters(folder / "truth/parameters.yaml");
  if (!truth) return;
  for (const ObjectIdentification& object : found->objects) {
    const auto known = truth->find(object.name);
    const auto& exponent = object.parameters.contact_exponent;
    if (!exponent || known == truth->end() || !known->second.contact_exponent) continue;
    if (is_exponent_given(object.parameters)) continue;
    ASSERT_TRUE(exponent->std.has_value());
    EXPECT_LT(std::abs(exponent->value - known->second.contact_exponent->value),
              4.0 * *exponent->std)
        << folder << ": " << exponent->value << " +- " << *exponent->std;
  }
}

TEST(SharedRecordings, PushesOfRandomBodiesHaveNoFault) {
  PCAVR_NEEDS_SHARED_DATA("plants");
  for (const fs::path& folder : recordings_in(shared_data("plants"))) expect_sound(folder);
}

TEST(SharedRecordings, LaboratoryPushesHaveNoFault) {
  PCAVR_NEEDS_SHARED_DATA("real/push_mit_delrin");
  for (const fs::path& folder : recordings_in(shared_data("real/push_mit_delrin"))) {
    expect_sound(folder);
  }
  PCAVR_NEEDS_SHARED_DATA("real/push_cmu/recordings");
  for (const fs::path& folder : recordings_in(shared_data("real/push_cmu/recordings"))) {
    expect_sound(folder);
  }
}

TEST(SharedRecordings, FaultyCopiesAreReportedWithTheirFault) {
  PCAVR_NEEDS_SHARED_DATA("plants");
  for (const char* name : {"plants/probe-3", "plants/probe-4", "plants/offcentre-4"}) {
    const IdentificationInput sound = input_of(shared_data(name));
    for (const Fault& fault : faults()) {
      IdentificationInput input = sound;
      fault.apply(input);
      const auto found = identify(input, IdentificationGoal::friction);
      const std::string text = found ? "no error" : found.error().to_string();
      EXPECT_NE(text.find(fault.expected_text), std::string::npos)
          << name << ", " << fault.name << ": " << text;
    }
  }
}

}  // namespace
}  // namespace pcavr
