// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "results/export/export_text.hpp"
#include "results/export/foot_contact.hpp"
#include "results/export/format_residuals.hpp"
#include "results/export/mujoco_contact.hpp"

namespace pcavr {
namespace {

using detail::linear_contact;
using detail::mjcf_pose;
using detail::vector_text;
using detail::xml_text;

constexpr double kTimestep = 1e-3;         // [s] a tenth of the period of feet and stiff contacts
constexpr double kImpedanceRatio = 100.0;  // a static body creeps by under 0.05 mm/s
constexpr double kFootImpedance = 0.5;     // feet stay on the support: they do not oscillate
/// [kg] Of the tool, which is moved by its joints' positions and velocities: so heavy that contact
/// does not move it between two steps, light enough for the solver. Fixed bodies meet it, too,
/// which they would not as a mocap body; and a mocap body has no velocity, by which contacts are
/// damped.
constexpr double kToolMass = 1e3;
/// [1/s] Rate at which friction at the tip stops slip below the cone: half of what is stable.
constexpr double kStickRate = 0.5 / kTimestep;

std::string contact_text(const detail::MujocoContact& contact) {
  const auto& [min, max, width, midpoint, power] = contact.solimp;
  return fmt::format("solref=\"{} {}\" solimp=\"{} {} {} {} {}\"", contact.solref[0],
                     contact.solref[1], min, max, width, midpoint, power);
}

std::string inertial_text(const MassProperties& body) {
  const Eigen::Matrix3d& i = body.inertia_object;
  return fmt::format("<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>",
                     vector_text(body.centre_of_mass_object), body.mass, i(0, 0), i(1, 1), i(2, 2),
                     i(0, 1), i(0, 2), i(1, 2));
}

/// [1/kg] Sum of the inverse weights of a body and the tool.
double inverse_weight(const ExportedBody& body) {
  return 1.0 / kToolMass + (body.is_movable ? 1.0 / body.inertia.mass : 0.0);
}

std::string foot_text(const ExportedBody& body, std::size_t index, const Eigen::Vector3d& up_base) {
  const SupportFoot& foot = body.feet[index];
  const detail::FootContact support = detail::stiff_foot_contact(body, foot, up_base);
  const detail::MujocoContact contact =
      linear_contact(support.stiffness, support.damping, 1.0 / body.inertia.mass, kFootImpedance);
  return fmt::format(
      "      <geom class=\"foot\" name=\"{}/foot_{}\" size=\"{}\" pos=\"{}\" friction=\"{} 0 0\" "
      "{}/>\n",
      xml_text(body.name), index, foot.radius, vector_text(support.centre_object), foot.friction,
      contact_text(contact));
}

std::string body_text(const ExportedBody& body, std::size_t index,
                      const detail::MujocoContact& contact, const Eigen::Vector3d& up_base) {
  const std::string name = xml_text(body.name);
  std::string text =
      fmt::format("    <body name=\"{}\" {}>\n", name, mjcf_pose(body.T_base_object));
  if (body.is_movable) {
    text += fmt::format("      <freejoint name=\"{}\"/>\n      {}\n", name,
                        inertial_text(body.inertia));
  }
  text += fmt::format(
      "      <geom class=\"solid\" name=\"{}\" type=\"mesh\" mesh=\"object_{}\" pos=\"{}\" "
      "friction=\"{} 0 0\" priority=\"1\" {} rgba=\"0.8 0.6 0.3 1\"/>\n",
      name, index, vector_text(body.surface_offset_object), body.friction, contact_text(contact));
  for (std::size_t i = 0; i < body.feet.size(); ++i) text += foot_text(body, i, up_base);
  return text + "    </body>\n";
}

std::string pair_text(const ExportedWorld& world, const ExportedBody& body,
                      const detail::MujocoContact& contact) {
  return fmt::format(
      "    <pair geom1=\"{}_tip\" geom2=\"{}\" condim=\"3\" friction=\"{} {} 0 0 0\" {} "
      "solreffriction=\"-1 {}\"/>\n",
      xml_text(world.tool.name), xml_text(body.name), body.tool_friction, body.tool_friction,
      contact_text(contact), -kStickRate * contact.solimp[1]);
}

std::string custom_text(const ExportedWorld& world) {
  std::string text = "  <custom>\n";
  const auto add = [&text](const ExportedNumber& number, const char* suffix, double value) {
    text += fmt::format("    <numeric name=\"{}/{}{}\" data=\"{}\"/>\n", xml_text(number.object),
                        number.key, suffix, value);
  };
  for (const ExportedNumber& number : world.numbers) {
    add(number, "", number.value);
    if (number.std) add(number, "_std", *number.std);
  }
  return text + "  </custom>\n";
}

std::string header_text(const ExportedWorld& world) {
  const Eigen::Vector3d gravity = Eigen::Vector3d::Zero() - kStandardGravity * world.up_base;
  return fmt::format(
      "<mujoco model=\"{}\">\n"
      "  <!-- SI units, frame base. Friction holds at {} m/s; numbers with std: {}. -->\n"
      "  <compiler angle=\"radian\" autolimits=\"true\"/>\n"
      "  <option timestep=\"{}\" gravity=\"{}\" cone=\"elliptic\" impratio=\"{}\"/>\n"
      "  <default>\n"
      "    <default class=\"solid\"><geom contype=\"1\" conaffinity=\"3\" "
      "condim=\"3\"/></default>\n"
      "    <default class=\"foot\"><geom type=\"sphere\" contype=\"2\" conaffinity=\"0\" "
      "condim=\"3\" priority=\"2\" group=\"3\" rgba=\"0.2 0.2 0.2 1\"/></default>\n"
      "    <default class=\"visual\"><geom contype=\"0\" conaffinity=\"0\" "
      "group=\"2\"/></default>\n"
      "  </default>\n",
      "pcavr", world.reference_speed, kExportManifest, kTimestep, vector_text(gravity),
      kImpedanceRatio);
}

std::string assets_text(const ExportedWorld& world) {
  std::string text = "  <asset>\n";
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    text += fmt::format("    <mesh name=\"object_{0}\" file=\"meshes/object_{0}.obj\"/>\n", i);
  }
  if (world.is_scanned()) {
    text += "    <mesh name=\"scan\" file=\"meshes/scan.obj\" inertia=\"shell\"/>\n";
  }
  return text + "  </asset>\n";
}

std::string static_text(const ExportedWorld& world) {
  std::string text = "    <light pos=\"0 0 3\" dir=\"0 0 -1\" directional=\"true\"/>\n";
  for (const ExportedSupport& support : world.supports) {
    text += fmt::format(
        "    <geom class=\"solid\" name=\"{}\" type=\"box\" size=\"{}\" {} "
        "rgba=\"0.6 0.6 0.6 1\"{}/>\n",
        xml_text(support.name), vector_text(support.size / 2.0), mjcf_pose(support.T_base_box),
        world.is_scanned() ? " group=\"3\"" : "");  // viewers draw groups 0 to 2
  }
  if (world.is_scanned()) {
    text += fmt::format("    <geom class=\"visual\" name=\"{}\" type=\"mesh\" mesh=\"scan\"/>\n",
                        xml_text(world.scan_name));
  }
  return text;
}

/// The tool at rest at its pose; its joints' positions count from there.
std::string tool_text(const ExportedTool& tool) {
  const std::string name = xml_text(tool.name);
  std::string text = fmt::format(
      "    <body name=\"{}\" pos=\"{}\" gravcomp=\"1\">\n      <inertial pos=\"0 0 0\" mass=\"{}\" "
      "diaginertia=\"1 1 1\"/>\n",
      name, vector_text(tool.T_base_tool.translation()), kToolMass);
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("      <joint name=\"{}_{}\" type=\"slide\" axis=\"{}\"/>\n", name,
                        "xyz"[i], vector_text(Eigen::Vector3d::Unit(i)));
  }
  return text + fmt::format(
                    "      <geom class=\"solid\" name=\"{}_tip\" type=\"sphere\" size=\"{}\" "
                    "rgba=\"0.2 0.4 0.9 1\"/>\n    </body>\n",
                    name, tool.radius);
}

void add_contact_residual(const ExportedBody& body, const detail::MujocoContact& contact,
                          ExportedWorld& world) {
  const double weight = inverse_weight(body);
  const double depth = static_penetration(body.contact, body.working_force);
  const double error = detail::error_of(contact, body.contact, body.working_force, weight);
  world.residuals.push_back(
      {.object = body.name,
       .what = fmt::format("contact force at {:.3g} mm", 1e3 * depth),
       .wanted = body.working_force,
       .written = detail::mujoco_force(contact, depth, weight),
       .unit = "N",
       .remark =
           fmt::format("at most {:.2g} % off from a quarter to one and a half times this depth",
                       100.0 * error)});
}

}  // namespace

Expected<void> write_mjcf(ExportedWorld& world, const std::filesystem::path& folder) {
  if (auto checked = detail::check_reserved_name(world, "world", "MJCF"); !checked) return checked;
  if (auto written = detail::write_meshes(world, folder); !written) return written;
  std::string bodies, pairs;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const ExportedBody& body = world.bodies[i];
    const detail::MujocoContact contact =
        detail::fit_mujoco_contact(body.contact, body.working_force, inverse_weight(body));
    bodies += body_text(body, i, contact, world.up_base);
    pairs += pair_text(world, body, contact);
    add_contact_residual(body, contact, world);
    detail::add_static_friction_residual(
        body, "MuJoCo has one coefficient: sliding at the reference speed", world);
  }
  const std::string text = header_text(world) + assets_text(world) + custom_text(world) +
                           "  <worldbody>\n" + static_text(world) + bodies + tool_text(world.tool) +
                           "  </worldbody>\n  <contact>\n" + pairs + "  </contact>\n</mujoco>\n";
  return write_file(folder / kMjcfFile, text);
}

}  // namespace pcavr
