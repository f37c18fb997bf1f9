// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/export/export_world.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/core.h>

#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

#include "results/export/body_standing.hpp"
#include "results/export/exported_numbers.hpp"
#include "results/export/mass_properties.hpp"

namespace pcavr {
namespace {

constexpr double kDefaultSpeed = 0.03;       // [m/s] of a push by hand or arm
constexpr double kDefaultTipRadius = 0.005;  // [m]
constexpr double kDefaultToolHeight = 0.2;   // [m] over the highest body
constexpr double kImmovableForce = 10.0;     // [N] at which a fixed body's contact is matched
constexpr double kMaxBodyError = 5e-4;       // [m] of a simplified body
constexpr double kMaxScanError = 5e-3;       // [m] of the simplified scan
constexpr double kConcavity = 1e-4;          // [m] that counts as flat
constexpr double kPlaneNoise = 5e-4;         // [m] beyond the noise of a scanned plane
constexpr double kMassTolerance = 0.1;       // relative: another body

bool has_friction(const ObjectParameters& known) {
  return known.sliding_friction_coefficient || known.limiting_static_friction ||
         !known.sliding_force.empty();
}

Expected<void> check_known(const SceneObjectEntry& object, const ObjectParameters& known,
                           const ExportOptions& options) {
  if (object.mass && known.mass) {
    const double difference = std::abs(known.mass->value - *object.mass);
    if (difference > std::max(kMassTolerance * *object.mass, 5.0 * known.mass->std.value_or(0.0))) {
      return Error{.message = fmt::format("object '{}' has {} kg in the scene and {} kg in the "
                                          "parameters: they are of another object",
                                          object.name, *object.mass, known.mass->value),
                   .hint = "give the parameters that were identified with this scene"};
    }
  }
  if (!object.is_movable || options.assumes || options.geometry_only) return {};
  const char* missing = !known.mass ? "mass" : !has_friction(known) ? "friction" : nullptr;
  if (missing == nullptr) return {};
  return Error{.message = fmt::format("object '{}' has no identified {}", object.name, missing),
               .hint = "identify it (pcavr identify friction), or go on with defaults: --assume"};
}

/// The mean of the speeds at which bodies were pushed, by the precision of their forces.
std::optional<double> identified_speed(const ParameterTable& parameters) {
  double sum = 0.0, weights = 0.0;
  for (const auto& [name, known] : parameters) {
    for (const SlidingForce& sample : known.sliding_force) {
      if (!(sample.std > 0.0)) continue;
      const double weight = sample.force * sample.force / (sample.std * sample.std);
      sum += weight * sample.speed;
      weights += weight;
    }
  }
  if (!(weights > 0.0)) return std::nullopt;
  return sum / weights;
}

/// The speed at which the exported coefficients hold, stated among the world's numbers.
void set_reference_speed(const ParameterTable& parameters, const ExportOptions& options,
                         ExportedWorld& world) {
  const std::optional<double> identified = identified_speed(parameters);
  world.reference_speed = options.speed.value_or(identified.value_or(kDefaultSpeed));
  world.numbers.push_back({.object = "world",
                           .key = "reference_speed",
                           .value = world.reference_speed,
                           .unit = "m/s",
                           .origin = options.speed ? "given"
                                     : identified  ? "measured"
                                                   : "assumed"});
}

/// [m] Largest depth of vertices under the planes of a closed mesh's faces: 0 where it is convex,
/// as then no vertex is in front of any.
double max_concavity_of(const TriangleMesh& mesh) {
  double max = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices[t[0]];
    const Eigen::Vector3f normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    if (!(normal.norm() > 0.0F)) continue;
    const Eigen::Vector3f unit = normal.normalized();
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      max = std::max(max, static_cast<double>(unit.dot(vertex - a)));
    }
  }
  return max;
}

TriangleMesh reduced(const TriangleMesh& mesh, std::size_t max_triangles, double max_error) {
  if (mesh.triangles.size() <= max_triangles) return mesh;
  return simplified(mesh, max_triangles, max_error);
}

Expected<TriangleMesh> reduced_scan(const SceneManifest& scene, const ExportOptions& options) {
  if (options.scan_base != nullptr) return *options.scan_base;
  const Expected<TriangleMesh> scan = read_mesh(scene.folder / "mesh.ply");
  if (!scan) return scan.error();
  return reduced(*scan, options.max_scan_triangles, kMaxScanError);
}

struct CompletedBody {
  ExportedBody body;
  CadModel model;
  CompletedPhysics physics;
};

/// [N] Friction at a speed: what pushes at such speeds have shown, else Coulomb and viscous
/// friction, which lack what a slow speed adds.
double friction_at(double speed, const ObjectParameters& known, const FrictionParameters& law) {
  // A mean of equal speeds differs from them by rounding.
  constexpr double kSameSpeed = 1e-9;
  const std::vector<SlidingForce>& rows = known.sliding_force;
  for (const SlidingForce& row : rows) {
    if (std::abs(row.speed - speed) <= kSameSpeed * speed) return row.force;
  }
  const auto next = std::find_if(rows.begin(), rows.end(),
                                 [&](const SlidingForce& row) { return row.speed >= speed; });
  if (next == rows.end() || next == rows.begin()) {
    return law.coulomb_force + law.viscous * speed;
  }
  const SlidingForce& before = *std::prev(next);
  const double share = (speed - before.speed) / (next->speed - before.speed);
  return before.force + share * (next->force - before.force);
}

void set_friction(const BodyPhysics& physics, const ObjectParameters& known, double speed,
                  ExportedBody& body) {
  const FrictionParameters& friction = physics.friction;
  const double weight = friction.mass * kStandardGravity;
  body.coulomb_friction = friction.coulomb_force / weight;
  body.static_friction = std::max(friction.limiting_force, friction.coulomb_force) / weight;
  body.viscous = friction.viscous;
  body.stribeck_speed = physics.stribeck_speed;
  body.friction = friction_at(speed, known, friction) / weight;
  body.friction_radius = physics.friction_radius;
  body.working_force = body.is_movable ? std::max(body.friction * weight, 1.0) : kImmovableForce;
}

Expected<CompletedBody> make_body(const SceneManifest& scene, const SceneObjectEntry& object,
                                  const ObjectParameters& known, double speed,
                                  const ExportOptions& options) {
  if (auto checked = check_known(object, known, options); !checked) return checked.error();
  Expected<CadModel> model = read_object_model(scene, object);
  if (!model) return model.error();
  CompletedBody completed{.body = {}, .model = std::move(*model), .physics = {}};
  completed.model.mesh_object =
      reduced(completed.model.mesh_object, options.max_body_triangles, kMaxBodyError);
  completed.physics =
      object.is_movable ? complete_physics(known, completed.model, object.T_base_object)
                        : complete_immovable_physics(known, completed.model, object.T_base_object);
  ExportedBody& body = completed.body;
  const BodyPhysics& physics = completed.physics.physics;
  body.name = object.name;
  body.is_movable = object.is_movable;
  body.T_base_object = object.T_base_object;
  body.mesh_object = completed.model.mesh_object;
  body.max_concavity = max_concavity_of(body.mesh_object);
  body.is_convex = body.max_concavity < kConcavity;
  body.inertia = detail::mass_properties_of(completed.model, physics.friction.mass);
  body.surface_offset_object = known.contact_surface_offset.value_or(Eigen::Vector3d::Zero());
  body.tool_friction = physics.tool_friction;
  body.contact = physics.contact;
  set_friction(physics, known, speed, body);
  return completed;
}

/// The plane that a body stands on: that of its support, lowered as its box is; of a body without
/// one, the horizontal plane under its lowest point.
Plane standing_plane(const SceneManifest& scene, const std::vector<double>& lowered,
                     const ExportedBody& body, std::vector<std::string>& warnings) {
  for (std::size_t i = 0; i < scene.support_planes.size(); ++i) {
    const auto& names = scene.support_planes[i].objects;
    if (std::find(names.begin(), names.end(), body.name) == names.end()) continue;
    Plane plane = scene.support_planes[i].plane_base;
    plane.offset -= lowered[i];
    return plane;
  }
  warnings.push_back(body.name + ": stands on no support plane of the scene");
  const double lowest = detail::lowest_height(body, scene.up_base);
  return {.normal = scene.up_base, .offset = lowest - detail::kFootProtrusion};
}

/// `name`, with as many '_' at its end that no body has it, or it with one of these suffixes.
std::string unused_name(const std::vector<ExportedBody>& bodies, std::string name,
                        const std::vector<std::string>& suffixes = {}) {
  const auto is_taken = [&](const ExportedBody& body) {
    return body.name == name ||
           std::any_of(suffixes.begin(), suffixes.end(),
                       [&](const std::string& suffix) { return body.name == name + suffix; });
  };
  while (std::any_of(bodies.begin(), bodies.end(), is_taken)) name += '_';
  return name;
}

void add_supports(const SceneManifest& scene, std::vector<CompletedBody>& completed,
                  ExportedWorld& world) {
  std::vector<ExportedBody> bodies;
  bodies.reserve(completed.size());
  for (const CompletedBody& each : completed) bodies.push_back(each.body);
  std::vector<double> lowered;
  for (const SupportPlane& plane : scene.support_planes) {
    const detail::LoweredSupport support = detail::support_box_of(plane, bodies);
    lowered.push_back(support.lowered);
    world.supports.push_back(support.box);
    world.supports.back().name = unused_name(bodies, fmt::format("support_{}", lowered.size() - 1));
    if (support.lowered > kPlaneNoise) {
      world.warnings.push_back(fmt::format("{}: lowered by {:.2f} mm, so that no body lies in it",
                                           world.supports.back().name, 1e3 * support.lowered));
    }
  }
  for (CompletedBody& each : completed) {
    if (each.body.is_movable) {
      const Plane plane = standing_plane(scene, lowered, each.body, world.warnings);
      detail::place_feet(each.model, each.physics.physics, plane, each.body, world.residuals);
    }
    world.bodies.push_back(std::move(each.body));
  }
}

/// Pose above the bodies, for a tool whose place is not stated.
Pose default_tool_pose(const std::vector<ExportedBody>& bodies, const Eigen::Vector3d& up) {
  Eigen::AlignedBox3d box;
  for (const ExportedBody& body : bodies) {
    for (const Eigen::Vector3f& v : body.mesh_object.vertices) {
      box.extend(body.T_base_object * v.cast<double>());
    }
  }
  if (box.isEmpty()) box.extend(Eigen::Vector3d::Zero());
  const double half = 0.5 * box.sizes().norm();
  return Pose::from_translation(box.center() + (half + kDefaultToolHeight) * up);
}

void add_tool(const ExportOptions& options, ExportedWorld& world) {
  ExportedTool& tool = world.tool;
  tool.name = unused_name(world.bodies, "tool", {"_x", "_y", "_z", "_tip"});
  tool.radius = options.tool_radius.value_or(kDefaultTipRadius);
  tool.T_base_tool = options.T_base_tool.value_or(default_tool_pose(world.bodies, world.up_base));
  world.numbers.push_back({.object = tool.name,
                           .key = "tip_radius",
                           .value = tool.radius,
                           .unit = "m",
                           .origin = options.tool_radius ? "given" : "assumed"});
}

void warn_of_assumed(const std::vector<ExportedNumber>& numbers, ExportedWorld& world) {
  std::string keys;
  for (const ExportedNumber& number : numbers) {
    if (number.origin == "assumed") keys += (keys.empty() ? "" : ", ") + number.key;
  }
  if (keys.empty()) return;
  world.warnings.push_back(numbers.front().object + ": assumed, not identified: " + keys);
}

/// The numbers of a body, and what engines make of its shape.
void add_body_numbers(const ExportedBody& body, const std::vector<ExportedNumber>& numbers,
                      ExportedWorld& world) {
  warn_of_assumed(numbers, world);
  world.numbers.insert(world.numbers.end(), numbers.begin(), numbers.end());
  if (body.is_convex) return;
  world.warnings.push_back(
      fmt::format("{}: is not convex; engines fill its concavities", body.name));
}

Expected<void> add_scan(const SceneManifest& scene, const ExportOptions& options,
                        ExportedWorld& world) {
  if (!scene.is_scanned()) return {};
  Expected<TriangleMesh> scan = reduced_scan(scene, options);
  if (!scan) return scan.error();
  world.scan_name = unused_name(world.bodies, world.scan_name);
  world.scan_base = *std::move(scan);
  world.occupancy_file = scene.folder / kOccupancyFile;
  return {};
}

}  // namespace

Expected<ExportedWorld> make_exported_world(const SceneManifest& scene,
                                            const ParameterTable& parameters,
                                            const ExportOptions& options) {
  ExportedWorld world;
  world.source = scene.recording;
  world.up_base = scene.up_base;
  set_reference_speed(parameters, options, world);
  std::vector<CompletedBody> bodies;
  for (const SceneObjectEntry& object : scene.objects) {
    const auto known = parameters.find(object.name);
    const ObjectParameters nothing;
    const ObjectParameters& values = known == parameters.end() ? nothing : known->second;
    Expected<CompletedBody> body = make_body(scene, object, values, world.reference_speed, options);
    if (!body) return body.error();
    if (!options.geometry_only) {
      add_body_numbers(body->body, detail::numbers_of(object.name, values, body->physics), world);
    }
    bodies.push_back(std::move(*body));
  }
  add_supports(scene, bodies, world);
  world.base_name = unused_name(world.bodies, world.base_name);
  if (auto added = add_scan(scene, options, world); !added) return added.error();
  add_tool(options, world);
  if (options.geometry_only) world.residuals.clear();
  return world;
}

}  // namespace pcavr
