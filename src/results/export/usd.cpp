// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/results/export/write_export.hpp"

#include "results/export/export_text.hpp"
#include "results/export/format_residuals.hpp"

namespace pcavr {
namespace {

/// Coefficient of support and tip, which no body exceeds.
constexpr double kPartner = ranges::kFrictionCoefficient.max;
/// Of colliders: shown on demand.
constexpr char kGuidePurpose[] = "      uniform token purpose = \"guide\"\n";
constexpr char kCollider[] = "\"PhysicsCollisionAPI\", \"MaterialBindingAPI\"";

std::string tuple(const Eigen::Vector3d& v) {
  return fmt::format("({}, {}, {})", v.x(), v.y(), v.z());
}
std::string tuple(const Eigen::Quaterniond& q) {
  return fmt::format("({}, {}, {}, {})", q.w(), q.x(), q.y(), q.z());
}

/// A string of USD's text format.
std::string quoted(const std::string& text) {
  std::string escaped = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped + '"';
}

std::string transform_text(const Pose& pose) {
  return fmt::format(
      "    double3 xformOp:translate = {}\n    quatd xformOp:orient = {}\n    uniform token[] "
      "xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]\n",
      tuple(pose.translation()), tuple(pose.rotation()));
}

std::string points_text(const TriangleMesh& mesh) {
  std::string points, counts, indices;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    points += fmt::format("{}({}, {}, {})", points.empty() ? "" : ", ", v.x(), v.y(), v.z());
  }
  for (const auto& t : mesh.triangles) {
    counts += counts.empty() ? "3" : ", 3";
    indices += fmt::format("{}{}, {}, {}", indices.empty() ? "" : ", ", t[0], t[1], t[2]);
  }
  return fmt::format(
      "      point3f[] points = [{}]\n      int[] faceVertexCounts = [{}]\n      int[] "
      "faceVertexIndices = [{}]\n      uniform token subdivisionScheme = \"none\"\n",
      points, counts, indices);
}

/// The colours of a mesh's vertices, where it has some: linear, as USD has them.
std::string colours_text(const TriangleMesh& mesh) {
  if (mesh.colors.empty()) return {};
  std::string colours;
  const auto linear = [](std::uint8_t value) {
    const double s = value / 255.0;  // IEC 61966-2-1
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  for (const Rgb8& c : mesh.colors) {
    colours += fmt::format("{}({:.4g}, {:.4g}, {:.4g})", colours.empty() ? "" : ", ", linear(c.r),
                           linear(c.g), linear(c.b));
  }
  return fmt::format("      color3f[] primvars:displayColor = [{}] (interpolation = \"vertex\")\n",
                     colours);
}

/// The smaller coefficient of a pair holds, where the engine is PhysX: its default is their mean.
std::string material_text(const std::string& name, double static_friction, double friction) {
  return fmt::format(
      "  def Material \"{}\" (prepend apiSchemas = [\"PhysicsMaterialAPI\", \"PhysxMaterialAPI\"]) "
      "{{\n"
      "    float physics:staticFriction = {}\n    float physics:dynamicFriction = {}\n"
      "    float physics:restitution = 0\n"
      "    uniform token physxMaterial:frictionCombineMode = \"min\"\n  }}\n",
      name, static_friction, friction);
}

std::string binding(const std::string& material) {
  return fmt::format("      rel material:binding:physics = </World/{}>\n", material);
}

/// The principal moments and axes, as UsdPhysicsMassAPI has inertias.
std::string mass_text(const MassProperties& body) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(body.inertia_object);
  Eigen::Matrix3d axes = principal.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  return fmt::format(
      "    float physics:mass = {}\n    point3f physics:centerOfMass = {}\n    float3 "
      "physics:diagonalInertia = {}\n    quatf physics:principalAxes = {}\n",
      body.mass, tuple(body.centre_of_mass_object), tuple(principal.eigenvalues()),
      tuple(Eigen::Quaterniond(axes)));
}

std::string numbers_text(const ExportedWorld& world, const std::string& object) {
  std::string text;
  for (const ExportedNumber& number : world.numbers) {
    if (number.object != object) continue;
    text += fmt::format("    custom double pcavr:{} = {}\n", number.key, number.value);
    if (number.std)
      text += fmt::format("    custom double pcavr:{}_std = {}\n", number.key, *number.std);
    text += fmt::format("    custom string pcavr:{}_origin = \"{}\"\n", number.key, number.origin);
  }
  return text;
}

std::string foot_prim(const SupportFoot& foot, std::size_t index, const std::string& material) {
  return fmt::format(
      "    def Sphere \"foot_{}\" (prepend apiSchemas = [{}]) {{\n{}      double radius = {}\n"
      "      double3 xformOp:translate = {}\n      uniform token[] xformOpOrder = "
      "[\"xformOp:translate\"]\n{}    }}\n",
      index, kCollider, kGuidePurpose, foot.radius, tuple(foot.centre_object), binding(material));
}

std::string body_prim(const ExportedWorld& world, std::size_t index) {
  const ExportedBody& body = world.bodies[index];
  const std::string prim = fmt::format("object_{}", index);
  std::string text = material_text(prim + "_tip_material", body.tool_friction, body.tool_friction);
  for (std::size_t i = 0; i < body.feet.size(); ++i) {
    const double friction = body.feet[i].friction;
    text += material_text(fmt::format("{}_foot_{}_material", prim, i),
                          friction * body.static_friction / body.friction, friction);
  }
  text += fmt::format("  def Xform \"{}\" (displayName = {}{}) {{\n", prim, quoted(body.name),
                      body.is_movable
                          ? "; prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsMassAPI\"]"
                          : "");
  text += transform_text(body.T_base_object);
  if (body.is_movable) text += mass_text(body.inertia);
  text += fmt::format("    custom string pcavr:name = {}\n", quoted(body.name));
  text += numbers_text(world, body.name);
  text += fmt::format(
      "    def Mesh \"mesh\" (prepend apiSchemas = [{}, \"PhysicsMeshCollisionAPI\"]) {{\n{}"
      "      uniform token physics:approximation = \"convexHull\"\n      double3 "
      "xformOp:translate = {}\n      uniform token[] xformOpOrder = [\"xformOp:translate\"]\n{}    "
      "}}\n",
      kCollider, points_text(body.mesh_object), tuple(body.surface_offset_object),
      binding(prim + "_tip_material"));
  for (std::size_t i = 0; i < body.feet.size(); ++i) {
    text += foot_prim(body.feet[i], i, fmt::format("{}_foot_{}_material", prim, i));
  }
  return text + "  }\n";
}

std::string support_prim(const ExportedSupport& support, std::size_t index, bool is_hidden) {
  return fmt::format(
      "  def Xform \"support_{}\" {{\n{}    def Cube \"box\" (prepend apiSchemas = [{}]) {{\n{}"
      "      double size = 1\n      double3 xformOp:scale = {}\n      uniform token[] xformOpOrder "
      "= [\"xformOp:scale\"]\n{}    }}\n  }}\n",
      index, transform_text(support.T_base_box), kCollider, is_hidden ? kGuidePurpose : "",
      tuple(support.size), binding("partner_material"));
}

/// PhysX takes the larger one of its two coefficients for the static one.
void add_static_residual(const ExportedBody& body, ExportedWorld& world) {
  if (!(body.static_friction < body.friction)) return;
  detail::add_static_friction_residual(
      body, "PhysX has none below sliding friction: a slower --speed has less", world);
}

}  // namespace

Expected<void> write_usd(ExportedWorld& world, const std::filesystem::path& folder) {
  std::string text = fmt::format(
      "#usda 1.0\n(\n  defaultPrim = \"World\"\n  metersPerUnit = 1\n  upAxis = \"Z\"\n)\n"
      "def Xform \"World\" {{\n  def PhysicsScene \"physics\" {{\n    vector3f "
      "physics:gravityDirection = {}\n    float physics:gravityMagnitude = {}\n  }}\n",
      tuple(-world.up_base), kStandardGravity);
  text += material_text("partner_material", kPartner, kPartner);
  for (std::size_t i = 0; i < world.supports.size(); ++i) {
    text += support_prim(world.supports[i], i, world.is_scanned());
  }
  if (world.is_scanned()) {
    text += "  def Mesh \"scan\" {\n" + points_text(world.scan_base) +
            colours_text(world.scan_base) + "  }\n";
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    text += body_prim(world, i);
    add_static_residual(world.bodies[i], world);
  }
  text += fmt::format(
      "  def Xform \"tool\" (prepend apiSchemas = [\"PhysicsRigidBodyAPI\"]) {{\n{}    bool "
      "physics:kinematicEnabled = true\n    def Sphere \"tip\" (prepend apiSchemas = "
      "[{}]) {{\n      double radius = {}\n{}    }}\n  }}\n}}\n",
      transform_text(world.tool.T_base_tool), kCollider, world.tool.radius,
      binding("partner_material"));
  return write_file(folder / kUsdFile, text);
}

}  // namespace pcavr
