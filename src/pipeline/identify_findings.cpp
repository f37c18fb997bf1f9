// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_findings.hpp"

#include <string>

namespace pcavr {
namespace {

const std::string kKnownBefore = "known before; to learn it anew: ";
const std::string kExponentRemark =
    "given: what was known before, else a spherical tip's on a flat face; to identify it: ";
constexpr char kBetterPress[] = "press along z at 5, 15 and 40 mm/s, 2 mm deep";
constexpr char kBetterPush[] = "push slowly through the middle until it goes, ten times";
constexpr char kBetterSlide[] = "modulate the push at 2 Hz, 3 mm, on 60 mm/s, without stopping";
constexpr char kBetterTurn[] = "push beside the middle, on two faces and both ways, with tracking";

class Findings {
 public:
  explicit Findings(std::vector<ParameterFinding>& rows) : rows_(rows) {}

  /// A parameter that this recording told, or `better`, the motion that would.
  ParameterFinding& add(const char* name, const char* unit,
                        const std::optional<ParameterValue>& value, bool is_excited,
                        const std::string& source, const std::string& better) {
    ParameterFinding& row = rows_.emplace_back();
    row.name = name;
    row.unit = unit;
    row.is_excited = is_excited && value.has_value();
    if (value) {
      row.value = value->value;
      row.deviation = value->deviation;
    }
    row.remark = row.is_excited              ? source
                 : value && value->deviation ? kKnownBefore + better
                                             : better;
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
    by_face |= face.contact.best().is_valid && face.contact.best().stiffness.is_excited;
  }
  const bool is_told = by_presses || by_face;
  const std::string source = by_presses ? counted(found.press_count, "press", "es")
                             : by_face  ? "pushes before they broke away, under the given exponent"
                                        : "";
  const std::string better = kBetterPress;
  findings.add("contact.stiffness", "N/m^n", p.contact_stiffness, is_told, source, better);
  findings.add("contact.damping", "N s/m^(n+1)", p.contact_damping, is_told, source, better);
  ParameterFinding& exponent = findings.add("contact.exponent", "", p.contact_exponent,
                                            is_told && !found.is_exponent_given, source, better);
  if (found.is_exponent_given) exponent.remark = kExponentRemark + better;
  if (by_presses && !found.presses.proposal.empty()) found.notes.push_back(found.presses.proposal);
}

void state_friction(const IdentifiableObject& object, ObjectIdentification& found,
                    Findings& findings) {
  const ObjectParameters& p = found.parameters;
  const SlidingIdentification& sliding = found.sliding;
  std::string mass_remark = std::string("not excited: ") + kBetterSlide;
  if (object.mass) mass_remark += "; the weighed mass is used";
  findings.add("mass", "kg", p.mass, sliding.mass.is_excited, "accelerations while it slid",
               mass_remark);
  findings.add(
      "limiting_static_friction", "N", p.limiting_static_friction, found.limit.pushes > 0,
      counted(found.limit.pushes, "push", "es") +
          (found.limit.pushes > 1 ? "; +- is the spread over them" : "; +- is its own deviation"),
      kBetterPush);
  findings.add("loading_rate", "N/s", p.loading_rate, found.limit.pushes > 0,
               "at which the limit was measured", kBetterPush);
  findings.add("sliding_friction_coefficient", "", p.sliding_friction_coefficient,
               sliding.coefficient.is_excited,
               sliding.mass.is_excited ? "with the identified mass"
               : object.mass           ? "with the weighed mass"
                                       : "with the mass that was known before",
               sliding.is_valid ? "the friction is known, the mass is not: weigh the object"
                                : std::string("push on for a second or more at 40 mm/s"));
  findings.add("viscous_friction", "N s/m", p.viscous_friction, sliding.viscous.is_excited,
               "speeds while it slid", std::string("not excited: ") + kBetterSlide);
  findings.add("friction_radius", "m", p.friction_radius, found.friction_radius.has_value(),
               std::to_string(found.turning.size()) + " stretches of pushes", kBetterTurn);
  if (!sliding.proposal.empty()) found.notes.push_back(sliding.proposal);
}

}  // namespace

void state_findings(IdentificationGoal goal, const IdentifiableObject& object,
                    ObjectIdentification& found) {
  Findings findings(found.findings);
  state_contact(found, findings);
  if (goal == IdentificationGoal::friction) state_friction(object, found, findings);
}

}  // namespace pcavr
