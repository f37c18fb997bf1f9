// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_robot_json.hpp"

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

void add_trial(Json& json, const std::string& key, const TrialStage& stage, std::size_t index) {
  const JointFit& joint = stage.joints[index];
  json[key + "viscous"] = joint.value_of(FrictionTerm::viscous);
  json[key + "coulomb"] = joint.value_of(FrictionTerm::coulomb);
  json[key + "held_out.relative_error"] = joint.held_out.relative;
  json[key + "held_out.rms_error"] = joint.held_out.rms;
  json[key + "position_rms_rad"] = stage.position_rms[static_cast<Eigen::Index>(index)];
}

void add_intervals(Json& json, const std::string& key, const JointIntervals& found) {
  for (const FrictionInterval& interval : found.intervals) {
    Json entry{{"begin", interval.begin}, {"end", interval.end}, {"rows", interval.rows}};
    for (const FittedTerm& term : interval.terms) {
      entry[name_of(term.term)] = term.value;
      entry[std::string(name_of(term.term)) + "_std"] = term.std;
    }
    json[key + "intervals"].push_back(entry);
  }
  json[key + "intervals.held_out.relative_error"] = found.held_out.relative;
}

void add_replay(Json& json, const std::string& key, const MotionReplay& replay,
                Eigen::Index joint) {
  json[key + "replay.kept_s"] = replay.simulated.kept[joint];
  json[key + "replay.tolerable_torque"] = replay.tolerable_torque[joint];
  json[key + "replay.alone.kept_s"] = replay.alone.kept[joint];
  if (replay.alone.is_finite) json[key + "replay.alone.rms_rad"] = replay.alone.rms[joint];
  if (!replay.simulated.is_finite) return;
  json[key + "replay.after_1s_rad"] = replay.after_1s[joint];
  json[key + "replay.rms_rad"] = replay.simulated.rms[joint];
}

void add_joint(Json& json, const RobotIdentification& found, std::size_t index) {
  const JointFit& joint = found.fit.joints[index];
  const std::string key = "joint." + joint.name + ".";
  for (const FittedTerm& term : joint.friction) {
    json[key + name_of(term.term)] = term.value;
    json[key + name_of(term.term) + "_std"] = term.std;
    json[key + name_of(term.term) + ".is_excited"] = term.is_excited;
  }
  for (const FittedTerm& term : joint.equivalent) {
    const std::string name = key + "equivalent." + name_of(term.term);
    json[name] = term.value;
    json[name + "_std"] = term.std;
  }
  json[key + "smoothing_speed"] = joint.sign.smoothing_speed;
  if (joint.sign.presliding_displacement > 0.0) {
    json[key + "presliding_displacement"] = joint.sign.presliding_displacement;
  }
  if (joint.stribeck_speed > 0.0) json[key + "stribeck_speed"] = joint.stribeck_speed;
  json[key + "noise_std"] = joint.noise_std;
  json[key + "train.relative_error"] = joint.train.relative;
  json[key + "held_out.relative_error"] = joint.held_out.relative;
  json[key + "held_out.rms_error"] = joint.held_out.rms;
  json[key + "plain.held_out.relative_error"] = joint.plain_held_out.relative;
  if (index < found.intervals.size()) add_intervals(json, key, found.intervals[index]);
  if (found.trial) {
    add_trial(json, key + "grid.alone.", found.trial->alone, index);
    add_trial(json, key + "grid.together.", found.trial->together, index);
  }
  if (!found.replay.t.empty())
    add_replay(json, key, found.replay, static_cast<Eigen::Index>(index));
}

Json touches_json(const ObservedContacts& contacts) {
  Json json = Json::array();
  for (const ObservedContacts::JointTouch& touch : contacts.touches) {
    Json entry{{"t", touch.t}, {"joint", touch.joint}};
    entry["force"] = nullptr;
    if (touch.force_base) {
      entry["force"] = {touch.force_base->x(), touch.force_base->y(), touch.force_base->z()};
    }
    json.push_back(entry);
  }
  return json;
}

}  // namespace

std::string robot_report_json(const RobotIdentification& found, const std::string& log,
                              const std::string& robot) {
  Json json;
  json["format"] = "pcavr-identification/1";
  json["version"] = PCAVR_VERSION;
  json["log"] = log;
  json["robot"] = robot;
  json["units"] = "SI";
  for (const auto& [key, value] : found.configuration) json["configuration"][key] = value;
  json["rows"] = found.log.t.size();
  json["fitted_rows"] = found.fit.train_rows;
  json["filter.bandwidth_Hz"] = found.signals.bandwidth;
  json["motion_frequency_Hz"] = found.signals.motion_frequency;
  json["torque_lag_s"] = found.fit.torque_lag;
  json["torque_sign"] = found.signals.is_sign_changed ? -1 : 1;
  json["prior_scale"] = found.fit.prior_scale;
  json["is_physical"] = found.fit.is_physical;
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) add_joint(json, found, j);
  const Eigen::VectorXd& inertias = found.fit.inertial_parameters;
  for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
    const Eigen::VectorXd body = inertias.segment<10>(static_cast<Eigen::Index>(10 * j));
    json["joint." + found.fit.joints[j].name + ".inertial_parameters"] =
        std::vector<double>(body.begin(), body.end());
  }
  for (const BaseParameter& entry : found.fit.base_parameters) {
    json["base_parameters"].push_back({{"name", entry.name},
                                       {"value", entry.value},
                                       {"std", entry.std},
                                       {"is_excited", entry.is_excited}});
  }
  if (found.contacts) {
    json["contact.detectable_force"] = found.contacts->detectable_force;
    json["contact.usual_detectable_force"] = found.contacts->usual_detectable_force;
    json["contact.touches"] = touches_json(*found.contacts);
    for (std::size_t j = 0; j < found.fit.joints.size(); ++j) {
      json["joint." + found.fit.joints[j].name + ".contact_threshold"] =
          found.contacts->thresholds[static_cast<Eigen::Index>(j)];
      json["joint." + found.fit.joints[j].name + ".detectable_torque"] =
          found.contacts->detectable_torque[static_cast<Eigen::Index>(j)];
    }
  }
  for (const JointCoupling& coupling : found.couplings) {
    json["couplings"].push_back({{"carrier", found.fit.joints[coupling.carrier].name},
                                 {"driven", found.fit.joints[coupling.driven].name},
                                 {"ratio", coupling.ratio},
                                 {"inertia", coupling.inertia.value},
                                 {"inertia_std", coupling.inertia.std},
                                 {"viscous", coupling.viscous.value},
                                 {"viscous_std", coupling.viscous.std},
                                 {"coulomb", coupling.coulomb.value},
                                 {"coulomb_std", coupling.coulomb.std},
                                 {"error_ratio", coupling.gain}});
  }
  for (const JointGain& gain : found.gains) {
    json["joint." + gain.joint + ".gain"] = gain.gain;
    json["joint." + gain.joint + ".gain_std"] = gain.std;
  }
  if (found.payload) {
    json["payload.mass"] = found.payload->mass;
    json["payload.mass_std"] = found.payload->mass_std;
    for (int axis = 0; axis < 3; ++axis) {
      json["payload.centre_of_mass"].push_back(found.payload->centre_of_mass[axis]);
      json["payload.centre_of_mass_std"].push_back(found.payload->centre_of_mass_std[axis]);
    }
  }
  json["notes"] = found.notes;
  return json_text(json, 2) + '\n';
}

}  // namespace pcavr
