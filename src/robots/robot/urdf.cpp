// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/urdf.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/robots/robot/transmissions.hpp"

#include "robots/robot/urdf_builder.hpp"
#include "robots/robot/urdf_structure.hpp"
#include "robots/robot/urdfdom_model.hpp"

namespace pcavr {
namespace {

/// Descriptions have some 100 kB; meshes are in files of their own.
constexpr std::uintmax_t kMaxSize = 16'000'000;

/// Whether urdfdom left out shapes. Where it does not understand a part of a link, it leaves out
/// the link's further parts, too. Its other errors, such as a material that is not defined, cost
/// nothing that is read here.
bool lost_shapes(const robot::UrdfdomResult& result) {
  return std::ranges::any_of(result.errors, [](const std::string& message) {
    return message.find("Could not parse") != std::string::npos;
  });
}

/// urdfdom names links and joints in its messages, but no lines; the detail comes before the name.
Error error_of(const robot::UrdfdomResult& result, const robot::UrdfStructure& structure,
               const std::filesystem::path& file) {
  Error error{"is not a valid robot description", file.string(), 0, "",
              "check it by check_urdf of Debian's liburdfdom-tools"};
  const auto find_in = [&](const std::string& message, const auto& elements, const char* kind) {
    for (const auto& element : elements) {
      const bool is_named = message.find("[" + element.name + "]") != std::string::npos ||
                            message.find("'" + element.name + "'") != std::string::npos;
      if (!is_named || error.line != 0) continue;
      error.line = element.line;
      error.place = fmt::format("{} '{}'", kind, element.name);
    }
  };
  for (const std::string& message : result.errors) {
    if (error.line != 0) break;
    error.message = &message == &result.errors.front() ? message : error.message + "; " + message;
    find_in(message, structure.joints, "joint");
    find_in(message, structure.links, "link");
  }
  return error;
}

/// The rotors' inertias, as the joints see them.
Expected<void> add_rotors(const std::string& text, const std::filesystem::path& file,
                          RobotModel& model) {
  const Expected<std::vector<JointTransmission>> transmissions = parse_transmissions(text, file);
  if (!transmissions) return transmissions.error();
  for (const JointTransmission& transmission : *transmissions) {
    for (RobotJoint& joint : model.joints) {
      if (joint.name != transmission.joint || joint.mimics) continue;
      joint.armature = transmission.reflected_inertia().value_or(0.0);
    }
  }
  return {};
}

}  // namespace

Expected<RobotModel> read_urdf(const std::filesystem::path& file, const UrdfOptions& options) {
  const Expected<std::uintmax_t> size = regular_file_size(file);
  if (!size) return size.error();
  if (*size > kMaxSize) {
    return Error{fmt::format("has {} bytes; at most {} are read", *size, kMaxSize), file.string(),
                 0, "", "a robot description in URDF is expected"};
  }
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_urdf(*text, file, options);
}

Expected<RobotModel> parse_urdf(const std::string& text, const std::filesystem::path& file,
                                const UrdfOptions& options) {
  const Expected<robot::UrdfStructure> structure = robot::parse_urdf_structure(text, file);
  if (!structure) return structure.error();
  const robot::UrdfdomResult parsed = robot::parse_by_urdfdom(text);
  if (!parsed.model || lost_shapes(parsed)) return error_of(parsed, *structure, file);
  Expected<RobotModel> model = robot::build_robot(*parsed.model, *structure, file, options);
  if (!model) return model;
  if (const Expected<void> added = add_rotors(text, file, *model); !added) return added.error();
  if (options.ignores_inertia) return model;
  robot::InertiaFindings inertias = robot::check_inertias(*model, *structure);
  if (options.requires_inertia && !inertias.faults.empty()) return inertias.faults.front();
  for (std::vector<Error>* list : {&inertias.faults, &inertias.doubts}) {
    for (Error& finding : *list) model->warnings.push_back(std::move(finding));
  }
  return model;
}

}  // namespace pcavr
