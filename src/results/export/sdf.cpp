// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "results/export/export_text.hpp"
#include "results/export/foot_contact.hpp"
#include "results/export/format_residuals.hpp"

namespace pcavr {
namespace {

using detail::vector_text;
using detail::xml_text;

std::string sdf_pose(const Pose& pose) {
  return fmt::format("<pose>{} {}</pose>", vector_text(pose.translation()),
                     vector_text(detail::roll_pitch_yaw(pose.rotation())));
}

/// Coefficient of support and tip, which no body exceeds.
constexpr double kPartnerFriction = ranges::kFrictionCoefficient.max;

/// Coefficient for ODE and DART, which take the smaller one of a pair.
std::string ode_friction(double friction) {
  return fmt::format("<friction><ode><mu>{0}</mu><mu2>{0}</mu2></ode></friction>", friction);
}

/// Coefficient for Drake, which combines a pair to 2 m n / (m + n).
std::string drake_friction(double friction) {
  return fmt::format(
      "<drake:proximity_properties><drake:mu_static>{0}</drake:mu_static><drake:mu_dynamic>{0}"
      "</drake:mu_dynamic></drake:proximity_properties>",
      friction);
}

/// Of a body's surface: contact in N/m and N s/m; friction against the support or the tip.
std::string surface_text(double friction, double stiffness, double damping) {
  return fmt::format("<surface>{}<contact><ode><kp>{}</kp><kd>{}</kd></ode></contact></surface>",
                     ode_friction(friction), stiffness, damping) +
         drake_friction(friction * kPartnerFriction / (2.0 * kPartnerFriction - friction));
}

/// Of the support and the tip, with which a body's own coefficient holds.
std::string partner_surface_text() {
  return fmt::format("<surface>{}</surface>", ode_friction(kPartnerFriction)) +
         drake_friction(kPartnerFriction);
}

std::string collision_text(const std::string& name, const Eigen::Vector3d& position,
                           const std::string& geometry, const std::string& surface) {
  return fmt::format(
      "      <collision name=\"{}\"><pose>{} 0 0 0</pose><geometry>{}</geometry>{}</collision>\n",
      name, vector_text(position), geometry, surface);
}

std::string mesh_text(const std::string& file) {
  return fmt::format("<mesh><uri>meshes/{}.obj</uri></mesh>", file);
}

std::string visual_text(const std::string& geometry) {
  return fmt::format("      <visual name=\"body\"><geometry>{}</geometry></visual>\n", geometry);
}

std::string sdf_inertial(const MassProperties& body) {
  const Eigen::Matrix3d& i = body.inertia_object;
  return fmt::format(
      "      <inertial><pose>{} 0 0 0</pose><mass>{}</mass><inertia><ixx>{}</ixx><ixy>{}</ixy>"
      "<ixz>{}</ixz><iyy>{}</iyy><iyz>{}</iyz><izz>{}</izz></inertia></inertial>\n",
      vector_text(body.centre_of_mass_object), body.mass, i(0, 0), i(0, 1), i(0, 2), i(1, 1),
      i(1, 2), i(2, 2));
}

std::string model_text(const ExportedBody& body, std::size_t index, const ContactForce& contact,
                       const Eigen::Vector3d& up_base) {
  const std::string mesh = mesh_text(fmt::format("object_{}", index));
  std::string text = fmt::format(
      "    <model name=\"{}\">\n      {}\n      <static>{}</static>\n      <link name=\"body\">\n",
      xml_text(body.name), sdf_pose(body.T_base_object), !body.is_movable);
  if (body.is_movable) text += sdf_inertial(body.inertia);
  text += visual_text(mesh);
  text += collision_text("body", body.surface_offset_object, mesh,
                         surface_text(body.tool_friction, contact.stiffness, contact.damping));
  for (std::size_t i = 0; i < body.feet.size(); ++i) {
    const SupportFoot& foot = body.feet[i];
    const detail::FootContact support = detail::stiff_foot_contact(body, foot, up_base);
    text += collision_text(fmt::format("foot_{}", i), support.centre_object,
                           fmt::format("<sphere><radius>{}</radius></sphere>", foot.radius),
                           surface_text(foot.friction, support.stiffness, support.damping));
  }
  return text + "      </link>\n    </model>\n";
}

std::string fixed_model(const std::string& name, const Pose& pose, const std::string& content) {
  return fmt::format(
      "    <model name=\"{}\">\n      {}\n      <static>true</static>\n      <link "
      "name=\"body\">\n{}"
      "      </link>\n    </model>\n",
      xml_text(name), sdf_pose(pose), content);
}

std::string support_model(const ExportedSupport& support, bool is_drawn) {
  const std::string box = fmt::format("<box><size>{}</size></box>", vector_text(support.size));
  return fixed_model(
      support.name, support.T_base_box,
      (is_drawn ? visual_text(box) : "") +
          collision_text("body", Eigen::Vector3d::Zero(), box, partner_surface_text()));
}

std::string tool_model(const ExportedTool& tool) {
  const std::string tip = fmt::format("<sphere><radius>{}</radius></sphere>", tool.radius);
  return fmt::format(
      "    <model name=\"{}\">\n      {}\n      <link name=\"body\"><kinematic>true</kinematic>\n{}"
      "      </link>\n    </model>\n",
      xml_text(tool.name), sdf_pose(tool.T_base_tool),
      collision_text("tip", Eigen::Vector3d::Zero(), tip, partner_surface_text()));
}

/// SDF's own scopes and names.
Expected<void> check_names(const ExportedWorld& world) {
  for (const ExportedBody& body : world.bodies) {
    const std::string& name = body.name;
    if (name.find("::") != std::string::npos || (name.starts_with("__") && name.ends_with("__"))) {
      return detail::check_reserved_name(world, name, "SDF");
    }
  }
  return detail::check_reserved_name(world, "world", "SDF");
}

}  // namespace

Expected<void> write_sdf(ExportedWorld& world, const std::filesystem::path& folder) {
  if (auto checked = check_names(world); !checked) return checked;
  if (auto written = detail::write_meshes(world, folder); !written) return written;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\" xmlns:drake=\"https://drake.mit.edu\">\n"
      "  <world name=\"pcavr\">\n    <gravity>{}</gravity>\n",
      vector_text(Eigen::Vector3d::Zero() - kStandardGravity * world.up_base));
  for (const ExportedSupport& support : world.supports) {
    text += support_model(support, !world.is_scanned());
  }
  if (world.is_scanned()) {
    text += fixed_model(world.scan_name, Pose(), visual_text(mesh_text("scan")));
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const ExportedBody& body = world.bodies[i];
    const ContactForce contact =
        contact_force(body.contact, static_penetration(body.contact, body.working_force), 0.0);
    text += model_text(body, i, contact, world.up_base);
    detail::add_penetration_residual(body, contact.stiffness, world);
    detail::add_static_friction_residual(
        body, "SDF has one coefficient: sliding at the reference speed", world);
  }
  return write_file(folder / kSdfFile, text + tool_model(world.tool) + "  </world>\n</sdf>\n");
}

}  // namespace pcavr
