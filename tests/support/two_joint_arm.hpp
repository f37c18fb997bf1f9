// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace pcavr {

/// An arm with a turning joint, a sliding one, a flange fixed to it, and a finger that no log has.
inline std::string two_joint_urdf() {
  const std::string inertial =
      "<inertial><origin xyz=\"0 0 0.1\"/><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" "
      "ixz=\"0\" "
      "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
  const std::string limit = "<limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"10\"/>";
  return "<?xml version=\"1.0\"?><robot name=\"two\"><!-- a comment --><link name=\"base\"/>"
         "<link name=\"a\">" +
         inertial +
         "<collision><geometry><box size=\"0.1 0.2 0.3\"/></geometry></collision></link>"
         "<link name=\"b\">" +
         inertial + "</link><link name=\"flange\">" + inertial + "</link><link name=\"finger\">" +
         inertial +
         "</link><joint name=\"j1\" type=\"revolute\"><origin xyz=\"0 0 0.5\" rpy=\"0 0 1\"/>"
         "<parent link=\"base\"/><child link=\"a\"/><axis xyz=\"0 0 1\"/>" +
         limit +
         "<dynamics damping=\"7\"/></joint><joint name=\"j2\" type=\"prismatic\"><parent "
         "link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>" +
         limit +
         "</joint><joint name=\"mount\" type=\"fixed\"><origin xyz=\"0 0 0.2\"/><parent "
         "link=\"b\"/><child link=\"flange\"/></joint><joint name=\"grip\" type=\"prismatic\">"
         "<parent link=\"flange\"/><child link=\"finger\"/><axis xyz=\"1 0 0\"/>" +
         limit + "</joint></robot>";
}

/// A report of pcavr identify robot for it; friction of j2 has no offset and no Coulomb part.
inline std::string two_joint_report(double coulomb_2 = 0.0123456789) {
  const std::string body = "[3.25, 0.1, 0.2, 0.3, 0.5, 0.01, 0.02, 0.6, 0.03, 0.7]";
  return "{\"format\": \"pcavr-identification/1\", \"is_physical\": true, "
         "\"joint.j1.coulomb\": 0.5, \"joint.j1.viscous\": 1.0, \"joint.j1.stribeck\": 0.2, "
         "\"joint.j1.stribeck_speed\": 0.1, \"joint.j1.motor_inertia\": 0.04, "
         "\"joint.j1.smoothing_speed\": 0.01, \"joint.j1.equivalent.offset\": 0.3, "
         "\"joint.j1.equivalent.viscous\": 1.23456789, \"joint.j1.equivalent.viscous_std\": 0.1, "
         "\"joint.j1.equivalent.coulomb\": 0.456789, "
         "\"joint.j2.coulomb\": 0.5, \"joint.j2.viscous\": 1.0, "
         "\"joint.j2.smoothing_speed\": 0.01, \"joint.j2.equivalent.viscous\": 0.25, "
         "\"joint.j2.equivalent.coulomb\": " +
         std::to_string(coulomb_2) + ", \"joint.j1.inertial_parameters\": " + body +
         ", \"joint.j2.inertial_parameters\": " + body + "}";
}

}  // namespace pcavr
