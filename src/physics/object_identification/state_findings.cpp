// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

const std::string kKnownBefore = "known before; to identify it again: ";
const std::string kExponentRemark =
    "given: the value known before, else that of a spherical tip on a flat face; to identify it: ";
const std::string kBoundedDamping =
    "not excited: the file has the largest damping that the presses allow; to identify it: ";
constexpr char kPriorRemark[] =
    "not excited: the value is its prior's, right with the coefficient at the speeds that were "
    "pushed only; to identify it: ";
/// A mass by accelerations alone, beside the one that the parameters contain.
constexpr char kInertialMass[] = "inertial_mass";
/// The penetration by the law's parameters: it is no parameter of the file.
constexpr char kPenetration[] = "contact.penetration";
constexpr char kBetterPress[] = "press along z at 5, 15 and 40 mm/s, 2 mm deep";
constexpr char kBetterPush[] = "push slowly through the centre of mass until it slides, ten times";
constexpr char kBetterSlide[] = "push at 60 mm/s, modulated by 2 Hz, 3 mm, without stopping";
constexpr char kBetterTurn[] =
    "push off-centre, on two faces and in both directions of rotation, with tracking";

class Findings {
 public:
  explicit Findings(std::vector<ParameterFinding>& rows) : rows_(rows) {}

  /// Adds a parameter; where it is not identified, with `better`, a motion that would identify it.
  ParameterFinding& add(const char* name, const char* unit,
                        const std::optional<ParameterValue>& value, bool is_excited,
                        const std::string& source, const std::string& better) {
    ParameterFinding& row = rows_.emplace_back();
    row.name = name;
    row.unit = unit;
    row.is_excited = is_excited && value.has_value();
    if (value) {
      row.value = value->value;
      row.std = value->std;
    }
    row.remark = row.is_excited ? source : value && value->std ? kKnownBefore + better : better;
    return row;
  }

 private:
  std::vector<ParameterFinding>& rows_;
};

std::string counted(int count, const char* word, const char* plural) {
  return std::to_string(count) + ' ' + word + (count == 1 ? "" : plural);
}

void state_contact(ObjectIdentification& found, Findings& findings) {
  const ObjectParameters& p = found.parameters;
  const bool by_presses = found.presses.best().is_valid;
  bool by_face = false;
  for (const FaceContact& face : found.faces) {
    by_face |= face.is_usable;
  }
  by_face = by_face && !found.is_contact_off_centre;
  const bool is_identified = by_presses || by_face;
  const std::string source = by_presses ? counted(found.press_count, "press", "es")
                             : by_face  ? "pushes before breakaway, under the given exponent"
                                        : "";
  const std::string better = kBetterPress;
  const ImpactFindings& impacts = found.impact_findings;
  const std::string by_impacts = counted(static_cast<int>(found.impacts.size()), "impact", "s");
  const bool is_stiffness_found = is_identified || impacts.gives_stiffness;
  findings.add("contact.stiffness", "N/m^n", p.contact_stiffness,
               is_stiffness_found && p.contact_stiffness && p.contact_stiffness->std,
               impacts.gives_stiffness ? by_impacts + ", under the given exponent" : source,
               better);
  const bool is_linear = p.contact_exponent && p.contact_exponent->value == 1.0;
  const char* const unit = is_linear ? "N s/m" : "N s/m^(n+1)";
  const bool is_bounded = by_presses && p.contact_damping && !impacts.gives_damping &&
                          !found.presses.best().damping.is_excited;
  ParameterFinding& damping = findings.add(
      "contact.damping", unit, p.contact_damping,
      !is_bounded && p.contact_damping && p.contact_damping->std &&
          (is_identified || impacts.gives_damping),
      impacts.gives_damping ? by_impacts + ", damping law: " + std::string(name_of(impacts.law)) +
                                  ", " + impacts.choice
                            : source,
      better);
  if (is_bounded) damping.remark = kBoundedDamping + better;
  if (p.contact_mass) {
    findings.add("contact.mass", "kg", p.contact_mass, by_presses, source,
                 "modulate the press at 10 Hz, 1 mm");
  }
  ParameterFinding& exponent =
      findings.add("contact.exponent", "", p.contact_exponent,
                   is_identified && !found.is_exponent_given, source, better);
  if (found.is_exponent_given && (by_face || impacts.gives_stiffness))
    exponent.remark = kExponentRemark + better;
  if (found.penetration.force > 0.0) {
    findings.add(kPenetration, "m", as_value(found.penetration.depth),
                 found.penetration.depth.is_excited,
                 fmt::format("at {:.2f} N, by the contact law", found.penetration.force), better);
  }
  if (by_presses && !found.presses.proposal.empty() && !found.impact_findings.gives_damping) {
    found.notes.push_back(found.presses.proposal);
  }
}

/// The restitution is contact.restitution in the file, with the speed that it is for.
void state_restitution(const ObjectIdentification& found, Findings& findings) {
  if (found.impacts.empty()) return;
  double slowest = HUGE_VAL, fastest = 0.0;
  for (const MeasuredImpact& impact : found.impacts) {
    slowest = std::min(slowest, impact.approach_speed.value);
    fastest = std::max(fastest, impact.approach_speed.value);
  }
  findings.add("restitution", "", as_value(found.impact_findings.restitution), true,
               fmt::format("{} at {:.0f} to {:.0f} mm/s",
                           counted(static_cast<int>(found.impacts.size()), "impact", "s"),
                           1e3 * slowest, 1e3 * fastest),
               "");
}

void state_tool_friction(const ObjectIdentification& found, Findings& findings) {
  if (!found.parameters.tool_friction_coefficient) return;
  findings.add("tool_friction_coefficient", "", found.parameters.tool_friction_coefficient,
               found.tool_friction_contacts > 0,
               counted(found.tool_friction_contacts, "contact", "s") + ", sliding along a face",
               "slide the pressed tip 20 mm along a face, with tracking");
}

/// Hint how to identify friction of which no sample was found, after `slid` [s] of sliding.
std::string better_sliding(double slid) {
  constexpr double kEnough = 1.0;  // [s]
  if (slid < kEnough) return "slide the object for a second or more at 40 mm/s";
  return fmt::format(
      "it slid for {:.1f} s, but at no time steadily and clearly faster than the noise of its "
      "speed: push at 40 mm/s without stopping, or with less noise of tool and force",
      slid);
}

void state_friction(const IdentifiableObject& object, double slid, ObjectIdentification& found,
                    Findings& findings) {
  const ObjectParameters& p = found.parameters;
  const SlidingIdentification& sliding = found.sliding;
  ParameterFinding& mass =
      findings.add("mass", "kg", p.mass, sliding.mass.is_excited && !found.is_mass_given,
                   "accelerations during sliding", std::string("not excited: ") + kBetterSlide);
  if (found.is_mass_given) {
    mass.remark = object.mass ? "given: weighed" : "given: the mass known before";
    if (!sliding.mass.is_excited) mass.remark += std::string("; to identify it: ") + kBetterSlide;
    findings.add(kInertialMass, "kg", p.inertial_mass.value_or(as_value(sliding.mass)),
                 sliding.mass.is_excited, "accelerations during sliding, without the given mass",
                 std::string("not excited: ") + kBetterSlide);
  }
  findings.add("limiting_static_friction", "N", p.limiting_static_friction, found.limit.pushes > 0,
               counted(found.limit.pushes, "push", "es"), kBetterPush);
  findings.add("limiting_static_friction_scatter", "N", p.limiting_static_friction_scatter,
               found.limit.pushes > 1, "from push to push", kBetterPush);
  findings.add("loading_rate", "N/s", p.loading_rate, found.limit.pushes > 0,
               "loading rate of the measured limit", kBetterPush);
  findings.add("sliding_friction_coefficient", "", p.sliding_friction_coefficient,
               sliding.coefficient.is_excited,
               !found.is_mass_given ? "with the identified mass"
               : object.mass        ? "with the given mass"
                                    : "with the mass known before",
               !sliding.is_valid ? better_sliding(slid)
               : p.mass          ? std::string("not excited: ") + kBetterSlide
                                 : "the friction is known, the mass is not: weigh the object");
  ParameterFinding& viscous =
      findings.add("viscous_friction", "N s/m", p.viscous_friction, sliding.viscous.is_excited,
                   "speeds during sliding", kBetterSlide);
  if (!viscous.is_excited) {
    viscous.remark =
        std::string(found.friction.is_valid ? kPriorRemark : "not excited: ") + kBetterSlide;
  }
  findings.add("friction_radius", "m", p.friction_radius, found.friction_radius.has_value(),
               std::to_string(found.turning.size()) + " segments of pushes", kBetterTurn);
  if (!sliding.proposal.empty()) found.notes.push_back(sliding.proposal);
}

/// Lists what has a value and was not identified: now or, for what was not looked for, before.
void list_given(ObjectIdentification& found) {
  std::vector<std::string>& given = found.parameters.sources.given;
  for (const ParameterFinding& row : found.findings) {
    std::erase(given, row.name);
    if (!row.is_excited && row.value != 0.0 && row.name != kInertialMass &&
        row.name != kPenetration) {
      given.push_back(row.name);
    }
  }
}

}  // namespace

void state_findings(IdentificationGoal goal, const IdentifiableObject& object, double slid,
                    ObjectIdentification& found) {
  Findings findings(found.findings);
  state_contact(found, findings);
  state_restitution(found, findings);
  state_tool_friction(found, findings);
  if (goal == IdentificationGoal::friction && object.is_movable) {
    state_friction(object, slid, found, findings);
  }
  list_given(found);
}

}  // namespace pcavr
