// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/friction_search.hpp"

#include <cstddef>
#include <optional>
#include <utility>

namespace pcavr {
namespace {

/// All pushes one after the other. The tip's path has gaps between them.
struct JoinedPushes {
  std::vector<IdentifiedContact> contacts;
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<TrackedPose> tracked;

  void add(const StoredPush& push) {
    contacts.push_back(push.contact);
    t_tool.insert(t_tool.end(), push.t_tool.begin(), push.t_tool.end());
    p_base_tip.insert(p_base_tip.end(), push.p_base_tip.begin(), push.p_base_tip.end());
    tracked.insert(tracked.end(), push.tracked.begin(), push.tracked.end());
  }

  /// Adds a press up to whose force the contact law was seen.
  void add_press(double peak_force) {
    IdentifiedContact& press = contacts.emplace_back();
    press.object = 0;
    press.episode.kind = ContactKind::press;
    press.episode.peak_force = peak_force;
  }
};

}  // namespace

FrictionSearch::Findings FrictionSearch::run() const {
  JoinedPushes joined;
  for (const Push& push : pushes) {
    joined.add(*push.stored);
    joined.contacts.back().shown = push.shown ? *push.shown : PushEvidence();
  }
  for (const double peak : press_peaks) joined.add_press(peak);
  Findings result{{}, pushes};
  ObjectIdentification& found = result.object;
  found.parameters = known;
  found.presses = presses;
  found.penetration.relative_std = penetration_std;
  found.is_turning_known = true;
  static const CadModel kNotTracked;
  const BodyMotion body{model ? *model : kNotTracked, joined.tracked};
  const PathView tip(joined.t_tool, joined.p_base_tip);
  // A wrong given mass is identified again, as everything else that is predicted with.
  identify_friction_of(joined.contacts, 0, std::nullopt, body, tip, tool_radius, options, found);
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    result.pushes[i].shown =
        std::make_shared<const PushEvidence>(std::move(*joined.contacts[i].shown));
  }
  return result;
}

}  // namespace pcavr
