// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "results/export/export_text.hpp"
#include "results/export/foot_contact.hpp"
#include "results/export/format_residuals.hpp"

namespace pcavr {
namespace {

using detail::vector_text;
using detail::xml_text;

std::string origin_text(const Pose& pose) {
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", vector_text(pose.translation()),
                     vector_text(detail::roll_pitch_yaw(pose.rotation())));
}

std::string mesh_geometry(const std::string& file) {
  return fmt::format("<geometry><mesh filename=\"meshes/{}.obj\"/></geometry>", file);
}

std::string sphere_collision(const std::string& name, const Eigen::Vector3d& centre,
                             double radius) {
  return fmt::format(
      "    <collision name=\"{}\"><origin xyz=\"{}\"/><geometry><sphere radius=\"{}\"/></geometry>"
      "</collision>\n",
      name, vector_text(centre), radius);
}

std::string link_inertial(const MassProperties& body) {
  return fmt::format(
      "    <inertial><origin xyz=\"{}\"/><mass value=\"{}\"/><inertia {}/></inertial>\n",
      vector_text(body.centre_of_mass_object), body.mass,
      detail::inertia_attributes(body.inertia_object));
}

/// Bullet reads <contact>; other readers of URDF ignore it. It multiplies the coefficients of two
/// links, and has 0.5 for one without.
std::string link_friction(double friction) {
  return fmt::format("<lateral_friction value=\"{}\"/>", friction);
}

std::string body_link(const ExportedBody& body, std::size_t index, const ContactForce& contact,
                      const Eigen::Vector3d& up_base) {
  const std::string name = xml_text(body.name);
  const std::string mesh = mesh_geometry(fmt::format("object_{}", index));
  std::string text = fmt::format("  <link name=\"{}\">\n", name);
  if (body.is_movable) text += link_inertial(body.inertia);
  text += fmt::format("    <visual>{}</visual>\n", mesh);
  text += fmt::format("    <collision name=\"{}\"><origin xyz=\"{}\"/>{}</collision>\n", name,
                      vector_text(body.surface_offset_object), mesh);
  for (std::size_t i = 0; i < body.feet.size(); ++i) {
    // A link has one stiffness, also for its feet.
    const detail::FootContact support =
        detail::foot_contact(body, body.feet[i], up_base, contact.stiffness);
    text += sphere_collision(fmt::format("{}/foot_{}", name, i), support.centre_object,
                             body.feet[i].radius);
  }
  return text + fmt::format(
                    "    <contact>{}<stiffness value=\"{}\"/><damping value=\"{}\"/></contact>\n"
                    "  </link>\n",
                    link_friction(body.friction), contact.stiffness, contact.damping);
}

std::string joint_text(const ExportedWorld& world, const std::string& child, const char* type,
                       const Pose& T_base_child) {
  return fmt::format(
      "  <joint name=\"{0}_to_{1}\" type=\"{2}\"><parent link=\"{0}\"/><child link=\"{1}\"/>{3}"
      "</joint>\n",
      world.base_name, child, type, origin_text(T_base_child));
}

std::string support_link(const ExportedWorld& world, const ExportedSupport& support) {
  const std::string name = xml_text(support.name);
  const std::string box =
      fmt::format("<geometry><box size=\"{}\"/></geometry>", vector_text(support.size));
  const std::string visual =
      world.is_scanned() ? std::string() : fmt::format("<visual>{}</visual>", box);
  return fmt::format(
             "  <link name=\"{0}\">{1}<collision name=\"{0}\">{2}</collision>"
             "<contact>{3}</contact></link>\n",
             name, visual, box, link_friction(1.0)) +
         joint_text(world, name, "fixed", support.T_base_box);
}

/// The tip's coefficient, whose product with a body's is that of their contact: exact for one body,
/// for several on average.
double tip_friction(const ExportedWorld& world) {
  double sum = 0.0;
  for (const ExportedBody& body : world.bodies) sum += body.tool_friction / body.friction;
  return world.bodies.empty() ? 1.0 : sum / static_cast<double>(world.bodies.size());
}

std::string tool_link(const ExportedWorld& world, double friction) {
  const std::string name = xml_text(world.tool.name);
  return fmt::format("  <link name=\"{}\">\n{}    <contact>{}</contact>\n  </link>\n", name,
                     sphere_collision(name + "_tip", Eigen::Vector3d::Zero(), world.tool.radius),
                     link_friction(friction)) +
         joint_text(world, name, "floating", world.tool.T_base_tool);
}

void add_urdf_residuals(const ExportedBody& body, double stiffness, double friction_of_tip,
                        ExportedWorld& world) {
  world.residuals.push_back({.object = body.name,
                             .what = "friction coefficient at the tip",
                             .wanted = body.tool_friction,
                             .written = friction_of_tip * body.friction,
                             .unit = "1",
                             .remark = "Bullet multiplies the coefficients of two links"});
  detail::add_penetration_residual(body, stiffness, world);
  detail::add_static_friction_residual(
      body, "URDF has one coefficient for a link: sliding at the reference speed", world);
}

}  // namespace

Expected<void> write_urdf(ExportedWorld& world, const std::filesystem::path& folder) {
  if (auto written = detail::write_meshes(world, folder); !written) return written;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<robot name=\"pcavr\">\n  <link name=\"{}\"/>\n", world.base_name);
  for (const ExportedSupport& support : world.supports) text += support_link(world, support);
  if (world.is_scanned()) {
    const std::string name = xml_text(world.scan_name);
    text += fmt::format("  <link name=\"{}\"><visual>{}</visual></link>\n", name,
                        mesh_geometry("scan")) +
            joint_text(world, name, "fixed", Pose());
  }
  const double friction_of_tip = tip_friction(world);
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const ExportedBody& body = world.bodies[i];
    const ContactForce contact =
        contact_force(body.contact, static_penetration(body.contact, body.working_force), 0.0);
    text += body_link(body, i, contact, world.up_base) +
            joint_text(world, xml_text(body.name), body.is_movable ? "floating" : "fixed",
                       body.T_base_object);
    add_urdf_residuals(body, contact.stiffness, friction_of_tip, world);
  }
  text += tool_link(world, friction_of_tip);
  return write_file(folder / kUrdfFile, text + "</robot>\n");
}

}  // namespace pcavr
