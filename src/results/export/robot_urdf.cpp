// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <tinyxml.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/export_robot.hpp"

#include "results/export/export_text.hpp"

namespace pcavr {
namespace {

void set_number(TiXmlElement& element, const char* name, double value) {
  element.SetAttribute(name, fmt::format("{}", value));
}

/// Removes all children of this name, and returns a new one.
TiXmlElement& replaced_child(TiXmlElement& parent, const char* name) {
  while (TiXmlElement* child = parent.FirstChildElement(name)) parent.RemoveChild(child);
  return *parent.InsertEndChild(TiXmlElement(name))->ToElement();
}

void write_inertial(const RigidInertia& body, TiXmlElement& link) {
  TiXmlElement& inertial = replaced_child(link, "inertial");
  TiXmlElement& origin = *inertial.InsertEndChild(TiXmlElement("origin"))->ToElement();
  origin.SetAttribute("xyz", detail::vector_text(body.centre_of_mass));
  origin.SetAttribute("rpy", "0 0 0");
  set_number(*inertial.InsertEndChild(TiXmlElement("mass"))->ToElement(), "value", body.mass);
  TiXmlElement& inertia = *inertial.InsertEndChild(TiXmlElement("inertia"))->ToElement();
  constexpr const char* kNames[3][3] = {
      {"ixx", "ixy", "ixz"}, {nullptr, "iyy", "iyz"}, {nullptr, nullptr, "izz"}};
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      set_number(inertia, kNames[row][column], body.inertia_at_com(row, column));
    }
  }
}

void edit_link(const ExportedRobot& robot, TiXmlElement& xml) {
  const auto index = robot.model.link_index(xml.Attribute("name"));
  if (!index || !robot.model.links[*index].joint) return;
  const RobotJoint& joint = robot.model.joints[*robot.model.links[*index].joint];
  if (joint.child_link == robot.model.links[*index].name) {
    write_inertial(joint.body, xml);
  } else {
    while (TiXmlElement* inertial = xml.FirstChildElement("inertial")) xml.RemoveChild(inertial);
  }
}

void edit_joint(const ExportedRobot& robot, TiXmlElement& xml) {
  const std::string name = xml.Attribute("name");
  if (std::find(robot.locked.begin(), robot.locked.end(), name) != robot.locked.end()) {
    xml.SetAttribute("type", "fixed");
    while (TiXmlElement* mimic = xml.FirstChildElement("mimic")) xml.RemoveChild(mimic);
  }
  const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                  [&](const ExportedJoint& joint) { return joint.name == name; });
  if (found == robot.joints.end()) return;
  TiXmlElement& dynamics = replaced_child(xml, "dynamics");
  set_number(dynamics, "damping", found->damping);
  set_number(dynamics, "friction", found->friction);
}

}  // namespace

Expected<void> write_robot_urdf(const ExportedRobot& robot, const std::string& urdf,
                                const std::filesystem::path& folder) {
  TiXmlDocument document;
  document.Parse(urdf.c_str(), nullptr, TIXML_ENCODING_UTF8);
  TiXmlElement* root = document.RootElement();
  if (document.Error() || root == nullptr) {
    return Error{.message = document.ErrorDesc(), .file = robot.model.file.string()};
  }
  for (TiXmlElement* xml = root->FirstChildElement(); xml != nullptr;
       xml = xml->NextSiblingElement()) {
    if (xml->Attribute("name") == nullptr) continue;
    if (xml->ValueStr() == "link") edit_link(robot, *xml);
    if (xml->ValueStr() == "joint") edit_joint(robot, *xml);
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  document.Accept(&printer);
  return write_file(folder / kRobotUrdfFile, printer.Str());
}

}  // namespace pcavr
