// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/transmissions.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <tinyxml.h>

namespace pcavr {
namespace {

constexpr double kMaxTransmissionValue = 1e12;  // beyond any stiffness: its square is finite

/// A motor may turn against its joint.
enum class Sign { kPositive, kAny };

/// The number of an element's text, or of its attribute `value`; absent where the element is.
Expected<std::optional<double>> number_in(const TiXmlElement* element, const std::string& joint,
                                          const std::filesystem::path& file,
                                          Sign sign = Sign::kPositive) {
  if (element == nullptr) return std::optional<double>();
  const char* attribute = element->Attribute("value");
  const char* content = attribute != nullptr ? attribute : element->GetText();
  std::string_view text = content == nullptr ? "" : content;
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n+"), text.size()));
  text = text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
  double value = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = code == std::errc() && end == text.data() + text.size();
  const double size = sign == Sign::kAny ? std::abs(value) : value;
  if (is_number && size > 0.0 && size < kMaxTransmissionValue) return std::optional(value);
  const char* expected = sign == Sign::kAny ? "a number other than 0" : "a positive number";
  return Error{fmt::format("<{}> is '{:.30}', not {}", element->Value(), text, expected),
               file.string(), element->Row(), fmt::format("transmission of joint '{}'", joint),
               "give a number in SI units, or remove the element"};
}

/// The first of these children that an element has.
const TiXmlElement* child_of(const TiXmlElement& element,
                             std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (const TiXmlElement* child = element.FirstChildElement(name)) return child;
  }
  return nullptr;
}

/// Those of more than one joint or motor (differentials) are not described by one ratio.
bool has_one(const TiXmlElement& transmission, const char* kind) {
  const TiXmlElement* first = transmission.FirstChildElement(kind);
  return first != nullptr && first->NextSiblingElement(kind) == nullptr;
}

Expected<JointTransmission> read_transmission(const TiXmlElement& xml,
                                              const std::filesystem::path& file) {
  const TiXmlElement& joint = *xml.FirstChildElement("joint");
  const TiXmlElement& actuator = *xml.FirstChildElement("actuator");
  JointTransmission found;
  if (const char* name = joint.Attribute("name")) found.joint = name;
  constexpr char kReduction[] = "mechanicalReduction";
  const TiXmlElement* reduction = child_of(actuator, {"drake:gear_ratio", kReduction});
  if (reduction == nullptr) reduction = child_of(joint, {kReduction});
  if (reduction == nullptr) reduction = child_of(xml, {kReduction});
  const auto ratio = number_in(reduction, found.joint, file, Sign::kAny);
  if (!ratio) return ratio.error();
  const auto inertia =
      number_in(child_of(actuator, {"drake:rotor_inertia", "rotorInertia"}), found.joint, file);
  if (!inertia) return inertia.error();
  const auto stiffness = number_in(child_of(actuator, {"gearStiffness"}), found.joint, file);
  if (!stiffness) return stiffness.error();
  found.reduction = ratio->value_or(1.0);
  found.rotor_inertia = *inertia;
  found.gear_stiffness = *stiffness;
  return found;
}

}  // namespace

Expected<std::vector<JointTransmission>> parse_transmissions(const std::string& text,
                                                             const std::filesystem::path& file) {
  TiXmlDocument document;
  document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  const TiXmlElement* root = document.RootElement();
  if (document.Error() || root == nullptr) {
    return Error{"is not XML", file.string(), document.ErrorRow(), "",
                 "a robot description in URDF is expected"};
  }
  std::vector<JointTransmission> all;
  for (const TiXmlElement* xml = root->FirstChildElement("transmission"); xml != nullptr;
       xml = xml->NextSiblingElement("transmission")) {
    if (!has_one(*xml, "joint") || !has_one(*xml, "actuator")) continue;
    Expected<JointTransmission> found = read_transmission(*xml, file);
    if (!found) return found.error();
    all.push_back(*std::move(found));
  }
  return all;
}

}  // namespace pcavr
