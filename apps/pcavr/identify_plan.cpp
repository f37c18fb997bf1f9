// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_plan.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>

namespace pcavr::app {
namespace {

nlohmann::ordered_json plan_json(const MotionPlan& plan) {
  nlohmann::ordered_json json{{"duration", plan.path.empty() ? 0.0 : plan.path.back().t}};
  for (const ObjectPlan& one : plan.objects) {
    nlohmann::ordered_json object{{"name", one.name},
                                  {"press_series", one.press_series},
                                  {"press_depth", one.press_depth},
                                  {"breakaways", one.breakaways},
                                  {"slides", one.slides},
                                  {"is_enough", one.is_enough},
                                  {"notes", one.notes}};
    for (const PlannedStd& row : one.stds) {
      nlohmann::ordered_json& stds = object["stds"][row.name] = nlohmann::ordered_json::object();
      if (row.now) stds["now"] = *row.now;
      if (row.expected) stds["expected"] = *row.expected;
      if (row.wished) stds["wished"] = *row.wished;
    }
    json["objects"].push_back(object);
  }
  return json;
}

/// Whether --force may replace the file: one that begins as a plan.
bool is_plan_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string header;
  return std::getline(stream, header) && (header == "t,x,y,z" || header.starts_with("t,q_"));
}

}  // namespace

Expected<OutputFile> create_plan_file(const std::string& file, bool replace) {
  return OutputFile::create(
      file, {.replace = replace, .kind = "motion plan", .is_replaceable = is_plan_file});
}

void add_plan(const MotionPlan& plan, const std::string& file, CommandResult& result) {
  result.json["plan"] = plan_json(plan);
  result.json["plan"]["file"] = file;
  result.summary += "next recording:\n";
  for (const std::string& line : describe_plan(plan)) result.summary += "  " + line + '\n';
  if (plan.path.empty()) return;
  const PlannedPoint& first = plan.path.front();
  result.summary += fmt::format(
      "wrote {}: {:.0f} s of commands of the tip in base; it begins at ({:.3f}, {:.3f}, {:.3f}) "
      "m\n",
      file, plan.path.back().t, first.p_base.x(), first.p_base.y(), first.p_base.z());
}

void add_plan(const ExcitingMotion& motion, const RobotFit& fit, const std::string& file,
              CommandResult& result) {
  const auto excited = [](const std::vector<BaseParameter>& parameters) {
    return std::count_if(parameters.begin(), parameters.end(),
                         [](const BaseParameter& entry) { return entry.is_excited; });
  };
  result.summary += fmt::format(
      "next recording: {:.0f} s in {}; base parameters excited now {}, expected {} of {}\n"
      "    joint                    friction's std, now and expected\n",
      motion.t.back(), file, excited(fit.base_parameters), excited(motion.base_parameters),
      fit.base_parameters.size());
  nlohmann::ordered_json& plan = result.json["plan"];
  plan = {{"file", file},
          {"duration", motion.t.back()},
          {"excited_now", excited(fit.base_parameters)},
          {"excited_expected", excited(motion.base_parameters)}};
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    const JointFit& joint = fit.joints[j];
    nlohmann::ordered_json row{{"name", joint.name},
                               {"viscous_std_expected", motion.viscous_std[j]},
                               {"coulomb_std_expected", motion.coulomb_std[j]}};
    std::string now;
    for (const FittedTerm& term : joint.friction) {
      if (term.term != FrictionTerm::viscous && term.term != FrictionTerm::coulomb) continue;
      row[std::string(name_of(term.term)) + "_std"] = term.std;
      now += fmt::format("{} {:.2g}, ", name_of(term.term), term.std);
    }
    plan["joints"].push_back(row);
    result.summary += fmt::format("    {:<24} {}expected viscous {:.2g}, coulomb {:.2g}\n",
                                  joint.name, now, motion.viscous_std[j], motion.coulomb_std[j]);
  }
  result.summary += "note: collisions are not checked: play the motion slowly first\n";
}

}  // namespace pcavr::app
