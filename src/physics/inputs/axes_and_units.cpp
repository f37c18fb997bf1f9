// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/solvers.hpp"

#include "physics/inputs/faults.hpp"
#include "physics/inputs/force_turn.hpp"
#include "physics/inputs/signed_permutations.hpp"

namespace pcavr {
namespace {

/// Minimum cosine of a sound force to the face's normal: friction cones of tip and object reach 45
/// degrees, of rubber 60.
constexpr double kSound = 0.5;
/// A force at more than 75 degrees to the normal does not push the face.
constexpr double kMisdirected = 0.26;
// Another interpretation must agree with the inward direction by this, exceed the one as written by
// this, and agree better with the motion by this. Neither criterion is sufficient alone: a tip that
// slides along a face moves across its force, and a wrong pose of the body rotates its normals.
constexpr double kExplains = 0.8;
constexpr double kInwardGain = 0.4;
constexpr double kMotionGain = 0.2;
/// Interpretations within this difference of their cosines are equally good.
constexpr double kTie = 0.05;
/// [m] between tip and surface at a touch, as for attribution.
constexpr double kMaxTouchGap = 0.015;

struct Length {
  const char* name;
  double metres;
};
// The last where metres were divided by 1000 once too often.
constexpr std::array<Length, kOtherLengthUnits> kLengths{
    {{"millimetres", 1e-3}, {"centimetres", 1e-2}, {"kilometres", 1e3}}};

bool explains(const DirectionAgreement& candidate, const DirectionAgreement& as_written) {
  return candidate.inward >= kExplains && candidate.inward - as_written.inward >= kInwardGain &&
         candidate.motion > 0.0 && candidate.motion - as_written.motion >= kMotionGain;
}

std::string cosines(double better, double as_written, std::size_t contacts) {
  return fmt::format("mean cosine {:.2f}, as written {:.2f}", better, as_written) + " over " +
         std::to_string(contacts) + (contacts == 1 ? " contact" : " contacts");
}

/// The force's sign or the tool's axes where they explain the unsound contacts; `all` contacts must
/// be consistent with it.
std::optional<InputFault> explain_sign(std::span<const ContactEvidence> evidence,
                                       std::span<const ContactEvidence> all) {
  if (evidence.empty()) return std::nullopt;
  const DirectionAgreement as_written = agreement_of(evidence, Eigen::Matrix3d::Identity());
  const DirectionAgreement flipped = agreement_of(evidence, -Eigen::Matrix3d::Identity());
  const DirectionAgreement tool = agreement_in_tool_axes(evidence);
  const bool is_flipped = explains(flipped, as_written) &&
                          agreement_of(all, -Eigen::Matrix3d::Identity()).inward >= kExplains;
  const bool is_in_tool =
      explains(tool, as_written) && agreement_in_tool_axes(all).inward >= kExplains;
  Error error{.message = "", .file = "wrench.csv"};
  if (is_flipped && flipped.inward >= tool.inward - kTie) {
    const bool is_either = is_in_tool && tool.inward >= flipped.inward - kTie;
    error.message = std::string("the force has the wrong sign") +
                    (is_either ? ", or is in the tool's axes" : "") +
                    ": reversed it points into the objects that the tool touches (" +
                    cosines(flipped.inward, as_written.inward, evidence.size()) + ")";
    error.hint =
        "write the force that the tool exerts, in base axes, not the reaction force on the tool";
    return InputFault{InputFaultKind::force_sign, std::move(error)};
  }
  if (is_in_tool) {
    error.message =
        "the force is in the tool's axes: rotated by the tool's orientation it points into the "
        "objects that the tool touches (" +
        cosines(tool.inward, as_written.inward, evidence.size()) + ")";
    error.hint = "write it in base axes";
    return InputFault{InputFaultKind::force_axes, std::move(error)};
  }
  return std::nullopt;
}

/// Permuted axes that explain the unsound contacts, likewise.
std::optional<InputFault> explain_permutation(std::span<const ContactEvidence> evidence,
                                              std::span<const ContactEvidence> all) {
  if (evidence.empty()) return std::nullopt;
  const DirectionAgreement as_written = agreement_of(evidence, Eigen::Matrix3d::Identity());
  std::optional<Eigen::Matrix3d> best;
  double inward = 0.0;
  for (const Eigen::Matrix3d& axes : signed_permutations()) {
    const DirectionAgreement candidate = agreement_of(evidence, axes);
    // Prefers rotated axes to mirrored ones where both explain the data.
    const double needed = inward + (axes.determinant() > 0.0 ? 1e-9 : kTie);
    const bool fits_all = agreement_of(all, axes).inward >= kExplains;
    if (!fits_all || !explains(candidate, as_written) || candidate.inward < needed) continue;
    best = axes;
    inward = candidate.inward;
  }
  if (!best) return std::nullopt;
  Error error{.message = "", .file = "wrench.csv"};
  error.message = "the force is in other axes than the tool's motion: read as, for example, " +
                  components_text(*best) + " it points into the objects that the tool touches (" +
                  cosines(inward, as_written.inward, evidence.size()) + ")";
  error.hint = "write it in base axes";
  return InputFault{InputFaultKind::force_axes, std::move(error)};
}

/// Whether the tip is at a body, with the force into it.
bool touches_any(const InputSeries& series, const Contact& contact,
                 const Eigen::Vector3d& p_base_tip, const BodyPoses& poses) {
  for (std::size_t i = 0; i < series.bodies.size(); ++i) {
    const Touch touch = poses.touch(i, contact.begin, p_base_tip, series.tool_radius);
    if (std::abs(touch.gap) < kMaxTouchGap &&
        touch.inward_base.dot(contact.direction_base) >= kSound) {
      return true;
    }
  }
  return false;
}

std::size_t count_sound(std::span<const ContactEvidence> evidence) {
  return static_cast<std::size_t>(
      std::count_if(evidence.begin(), evidence.end(),
                    [](const ContactEvidence& one) { return inward_cosine(one) >= kSound; }));
}

/// Touched from above, or from the side: axes may be permuted in the plane only, or along z.
enum class Side { above, lateral };

std::vector<ContactEvidence> from(Side side, std::span<const ContactEvidence> evidence) {
  std::vector<ContactEvidence> chosen;
  for (const ContactEvidence& one : evidence) {
    const bool is_above = std::abs(one.inward_base.z()) > one.inward_base.head<2>().norm();
    if (is_above == (side == Side::above)) chosen.push_back(one);
  }
  return chosen;
}

/// The contacts of the sides from which no more than half are sound.
std::vector<ContactEvidence> unsound_sides(std::span<const ContactEvidence> evidence) {
  std::vector<ContactEvidence> unsound;
  for (const Side side : {Side::above, Side::lateral}) {
    const std::vector<ContactEvidence> contacts = from(side, evidence);
    if (2 * count_sound(contacts) > contacts.size()) continue;
    unsound.insert(unsound.end(), contacts.begin(), contacts.end());
  }
  return unsound;
}

}  // namespace

std::optional<InputFault> axes_fault(std::span<const ContactEvidence> evidence) {
  // Where most contacts from one side are sound, the others were with an unknown object.
  const std::vector<ContactEvidence> unsound = unsound_sides(evidence);
  if (auto fault = explain_sign(unsound, evidence)) return fault;
  if (auto error = state_force_turn(evidence).error) {
    return InputFault{InputFaultKind::force_axes, std::move(*error)};
  }
  return explain_permutation(unsound, evidence);
}

UnitTouches count_unit_touches(const InputSeries& series, std::span<const Contact> contacts,
                               std::span<const ContactEvidence> evidence, const PathView& tip,
                               const BodyPoses& poses) {
  UnitTouches result{.contacts = contacts.size(), .in_metres = evidence.size()};
  // Where the tip touches a body in metres, no other unit is needed.
  if (!evidence.empty()) return result;
  for (std::size_t k = 0; k < kLengths.size(); ++k) {
    for (const Contact& contact : contacts) {
      const Eigen::Vector3d p_base_tip = kLengths[k].metres * tip.at(contact.begin);
      const bool touches = touches_any(series, contact, p_base_tip, poses);
      result.in_other_units[k] += touches ? 1 : 0;
    }
  }
  return result;
}

void UnitTouches::add(const UnitTouches& other) {
  contacts += other.contacts;
  in_metres += other.in_metres;
  for (std::size_t k = 0; k < in_other_units.size(); ++k) {
    in_other_units[k] += other.in_other_units[k];
  }
}

std::optional<InputFault> tool_unit_fault(const UnitTouches& touches) {
  if (touches.in_metres > 0) return std::nullopt;
  for (std::size_t k = 0; k < kLengths.size(); ++k) {
    const std::size_t count = touches.in_other_units[k];
    if (count == 0 || 2 * count < touches.contacts) continue;
    return InputFault{
        InputFaultKind::tool_unit,
        {.message = std::string("the tool's position is in ") + kLengths[k].name +
                    ": with that unit, the tip touches an object in " + std::to_string(count) +
                    " of " + std::to_string(touches.contacts) + " contacts, and in metres in none",
         .file = "tool.csv",
         .hint = "write metres"}};
  }
  return std::nullopt;
}

void leave_out_misdirected(std::span<const ContactEvidence> evidence,
                           std::vector<Contact>& contacts) {
  for (const ContactEvidence& one : evidence) {
    const double cosine = inward_cosine(one);
    Contact& contact = contacts[one.contact];
    if (cosine >= kMisdirected || !contact.left_out.empty()) continue;
    const double degrees = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
    // Rounded to tens: contacts are counted by their reason.
    contact.left_out = fmt::format(
        "the force points some {:.0f} degrees off the normal of the face that the tool touches",
        10.0 * std::round(0.1 * degrees));
  }
}

}  // namespace pcavr
