// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/arm/identified_arm.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using ReportJson = nlohmann::ordered_json;

constexpr char kReportFormat[] = "pcavr-identification/1";
constexpr std::string_view kPrefix = "joint.";
constexpr std::string_view kInertias = ".inertial_parameters";
constexpr int kBodyParameters = 10;

Error bad_report(const fs::path& file, const std::string& message) {
  return {.message = message,
          .file = file.string(),
          .hint = "give the report folder of pcavr identify robot for this arm"};
}

/// A finite number, or nothing.
std::optional<double> number_of(const ReportJson& json, const std::string& key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// The names of the joints, in the order of the report.
std::vector<std::string> joints_of(const ReportJson& json) {
  std::vector<std::string> names;
  for (const auto& [key, value] : json.items()) {
    if (!key.starts_with(kPrefix) || !key.ends_with(kInertias)) continue;
    names.push_back(key.substr(kPrefix.size(), key.size() - kPrefix.size() - kInertias.size()));
  }
  return names;
}

/// The terms of friction whose keys start with `prefix`.
std::vector<FittedTerm> terms_of(const ReportJson& json, const std::string& prefix) {
  std::vector<FittedTerm> terms;
  for (int i = 0; i < kFrictionTerms; ++i) {
    const auto term = static_cast<FrictionTerm>(i);
    const std::string key = prefix + name_of(term);
    const std::optional<double> value = number_of(json, key);
    if (!value) continue;
    terms.push_back(
        {.term = term, .value = *value, .std = number_of(json, key + "_std").value_or(0.0)});
  }
  return terms;
}

Expected<JointFit> joint_of(const ReportJson& json, const std::string& name, const fs::path& file) {
  const std::string key = std::string(kPrefix) + name + '.';
  JointFit joint;
  joint.name = name;
  const std::optional<double> smoothing = number_of(json, key + "smoothing_speed");
  if (!smoothing || *smoothing <= 0.0) return bad_report(file, "has no friction of joint " + name);
  joint.sign.smoothing_speed = *smoothing;
  joint.stribeck_speed = number_of(json, key + "stribeck_speed").value_or(0.0);
  joint.friction = terms_of(json, key);
  joint.equivalent = terms_of(json, key + "equivalent.");
  if (joint.value_of(FrictionTerm::stribeck) != 0.0 && joint.stribeck_speed <= 0.0) {
    return bad_report(file, "has no Stribeck speed of joint " + name);
  }
  return joint;
}

Expected<Eigen::VectorXd> inertias_of(const ReportJson& json, const std::vector<std::string>& names,
                                      const fs::path& file) {
  Eigen::VectorXd inertias(kBodyParameters * static_cast<Eigen::Index>(names.size()));
  Eigen::Index row = 0;
  for (const std::string& name : names) {
    const ReportJson& body = json[std::string(kPrefix) + name + std::string(kInertias)];
    if (!body.is_array() || body.size() != kBodyParameters) {
      return bad_report(file, "has no ten inertial parameters of joint " + name);
    }
    for (const ReportJson& value : body) {
      if (!value.is_number() || !std::isfinite(value.get<double>())) {
        return bad_report(file, "has inertial parameters that are no numbers for joint " + name);
      }
      inertias[row++] = value.get<double>();
    }
    if (inertias[row - kBodyParameters] <= 0.0) {
      return bad_report(file, "has a mass that is not positive for joint " + name);
    }
  }
  return inertias;
}

}  // namespace

Expected<IdentifiedArm> parse_identified_arm(const std::string& text, const fs::path& file,
                                             const RobotModel& described) {
  const ReportJson json = ReportJson::parse(text, nullptr, false);
  if (!json.is_object() || json.value("format", ReportJson()) != kReportFormat) {
    return bad_report(file, "is no identification report");
  }
  RobotFit fit;
  JointLog names;
  names.joints = joints_of(json);
  if (names.joints.empty()) return bad_report(file, "is no report of a robot's identification");
  if (json.value("is_physical", ReportJson()) != true) {
    return bad_report(file, "states bodies that are not possible: they can't be simulated");
  }
  const Expected<MatchedRobot> matched = match_joints(names, described);
  if (!matched) return bad_report(file, matched.error().message);
  for (std::size_t j = 0; j < names.joints.size(); ++j) {
    if (matched->columns[j] != j) return bad_report(file, "has the joints in another order");
    Expected<JointFit> joint = joint_of(json, names.joints[j], file);
    if (!joint) return joint.error();
    fit.joints.push_back(*std::move(joint));
  }
  Expected<Eigen::VectorXd> inertias = inertias_of(json, names.joints, file);
  if (!inertias) return inertias.error();
  fit.inertial_parameters = *std::move(inertias);
  IdentifiedArm arm{.model = fit.robot(matched->model), .joints = fit.joints};
  for (const RobotJoint& joint : arm.model.joints) {
    if (joint.armature < 0.0) {
      return bad_report(file, "has a negative motor inertia at joint " + joint.name);
    }
    if (const std::optional<std::string> fault = physical_fault(joint.body)) {
      return bad_report(file, "has an impossible body at joint " + joint.name + ": " + *fault);
    }
  }
  return arm;
}

Expected<IdentifiedArm> read_identified_arm(const fs::path& file_or_folder,
                                            const RobotModel& described) {
  std::error_code ignored;
  const fs::path file =
      fs::is_directory(file_or_folder, ignored) ? file_or_folder / "report.json" : file_or_folder;
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_identified_arm(*text, file, described);
}

}  // namespace pcavr
