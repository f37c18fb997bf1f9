// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/report/number_text.hpp"
#include "pcavr/pipeline/calibrate_objects.hpp"

#include "placement_fit.hpp"
#include "yaml_text.hpp"

namespace pcavr {
namespace {

constexpr std::array<const char*, kObjectParameters> kParameterNames{
    "x", "y", "z", "rotation about x", "rotation about y", "rotation about z", "scale"};

}  // namespace

std::string parameter_names(const CalibratedObject& found, bool observable) {
  std::string names;
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    if (found.is_observable[i] != observable) continue;
    names += (names.empty() ? "" : ", ") + std::string(kParameterNames[i]);
  }
  return names;
}

std::string describe_object(const CalibratedObject& found) {
  const double offset = found.from_stated.translation().norm();
  const double turn = rotation_distance(Pose(), found.from_stated);
  const std::string scale =
      found.scale == 1.0 ? "" : fmt::format(", of {:.4f} its size", found.scale);
  return fmt::format(
      "{} is {:.1f} mm and {:.1f} degrees from where the tracker has it{}; a contact is {} mm from "
      "its surface by the others",
      found.name, 1e3 * offset, turn / kRadPerDegree, scale, readable(1e3 * found.held_out_rms));
}

std::string format_objects(const std::vector<CalibratedObject>& found, const ObjectsInput& input) {
  std::string text =
      "format: pcavr-calibration/1\nkind: objects\nsource: " + quoted(input.recording.string()) +
      "\nobjects:\n";
  for (const CalibratedObject& object : found) {
    const Pose& T = object.T_tracked_object;
    text += "  - name: " + quoted(object.name) + '\n';
    text += fmt::format("    tracked_to_object: {{t: {}, q: {}}}  # m; x y z w\n",
                        number_list(T.translation()), number_list(T.rotation().coeffs()));
    text +=
        "    unit: " + shortest_decimal(object.mesh_unit) + "  # m, of the mesh's coordinates\n";
    text += "    std: {";
    for (std::size_t i = 0; i < kObjectParameters; ++i) {
      text += (i == 0 ? "" : ", ") + std::string(kParameterNames[i]) + ": " +
              (object.is_observable[i] ? shortest_decimal(object.stds[i]) : "~");
    }
    text += "}  # m, rad, 1 in the mesh's axes; ~: not observable, as stated\n";
    text += "    held_out_rms: " + shortest_decimal(object.held_out_rms) +
            "  # m, of each contact by the others\n";
  }
  return text;
}

}  // namespace pcavr
