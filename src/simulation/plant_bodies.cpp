// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/plant_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/random.hpp"

#include "simulation/box_grid.hpp"
#include "simulation/impact_moves.hpp"

namespace pcavr::simulation {
namespace {

constexpr int kPatchesAlong = 7;
constexpr double kLaneX = 0.62;             ///< [m]: the boxes stand in a row along
constexpr double kLaneY[] = {-0.34, 0.26};  ///< base y, with room to be pushed
constexpr double kMaxBoxYaw = 0.25;         ///< [rad]
constexpr double kMaxOffCentre = 0.0015;    ///< [m] of the centre of mass: uneven contents

/// Log-uniform, so that every order of magnitude is equally likely.
double sample_log_uniform(double low, double high, Random& random) {
  return low * std::pow(high / low, random.uniform());
}

/// Stiffness for which `force` [N] causes `penetration` [m].
double stiffness_for(double force, double penetration, double exponent) {
  return force / std::pow(penetration, exponent);
}

PlantParameters sample_parameters(Random& random) {
  PlantParameters p;
  p.mass = sample_log_uniform(0.8, 6.0, random);
  const double coefficient = sample_log_uniform(0.2, 1.1, random);
  p.limiting_static_friction = coefficient * p.mass * kStandardGravity;
  p.sliding_friction_coefficient = random.uniform(0.72, 0.96) * coefficient;
  p.viscous_friction = sample_log_uniform(2.0, 30.0, random);
  p.contact_exponent = random.uniform(1.3, 1.7);
  p.contact_stiffness = stiffness_for(
      p.limiting_static_friction, sample_log_uniform(0.0002, 0.002, random), p.contact_exponent);
  p.contact_damping = sample_log_uniform(0.5, 6.0, random) * p.contact_stiffness;
  p.tool_friction_coefficient = random.uniform(0.15, 0.5);
  p.stribeck_speed = sample_log_uniform(0.0005, 0.002, random);
  p.breakaway_displacement = sample_log_uniform(4e-6, 1.5e-5, random);
  return p;
}

/// Makes the pressure distribution uneven, with the centre of pressure (below the centre of mass)
/// at `centre`.
void make_pressure_uneven(std::vector<PlantPatch>& patches, double unevenness,
                          const Eigen::Vector2d& centre, Random& random) {
  double total = 0.0;
  for (PlantPatch& patch : patches) {
    patch.share *= 1.0 + unevenness * random.uniform(-1.0, 1.0);
    total += patch.share;
  }
  for (PlantPatch& patch : patches) patch.share /= total;
  // Repeated linear correction: each one changes the second moments that it was computed from.
  for (int round = 0; round < 3; ++round) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Vector2d square = Eigen::Vector2d::Zero();
    for (const PlantPatch& patch : patches) mean += patch.share * patch.p_body;
    for (const PlantPatch& patch : patches) {
      square += patch.share * (patch.p_body - mean).cwiseAbs2();
    }
    const Eigen::Vector2d slope = (centre - mean).cwiseQuotient(square);
    for (PlantPatch& patch : patches) patch.share *= 1.0 + slope.dot(patch.p_body - mean);
  }
}

Eigen::Vector2d sample_centre(Random& random) {
  const double x = random.uniform(-kMaxOffCentre, kMaxOffCentre);
  return {x, random.uniform(-kMaxOffCentre, kMaxOffCentre)};
}

Pose upright_pose(double x, double y, double half_height, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {x, y, half_height}};
}

PlantBody box(const std::string& name, const Eigen::Vector3d& half) {
  PlantBody body;
  body.name = name;
  body.parts.push_back({.half_extents = half});
  body.patches = uniform_patches(half.head<2>(), kPatchesAlong);
  return body;
}

/// A random pose of the box with this number.
Pose sample_box_pose(int number, double half_height, Random& random) {
  const double x = kLaneX + random.uniform(-0.02, 0.02);
  const double yaw = random.uniform(-kMaxBoxYaw, kMaxBoxYaw);
  return upright_pose(x, kLaneY[number], half_height, yaw);
}

}  // namespace

void wear_support(PlantBody& body, Random& random) {
  constexpr double kSpotShare = 0.6;  // of the smaller half side: a quarter of the support or less
  const Eigen::Vector2d half = half_extents_of(body).head<2>();
  const double x = random.uniform(-1.0, 1.0);
  const Eigen::Vector2d centre = half.cwiseProduct(Eigen::Vector2d(x, random.uniform(-1.0, 1.0)));
  const double worn = random.uniform(0.5, 0.7);
  double mean = 0.0;
  for (PlantPatch& patch : body.patches) {
    const bool is_worn = (patch.p_body - centre).norm() < kSpotShare * half.minCoeff();
    patch.wear = is_worn ? worn : 1.0;
    mean += patch.share * patch.wear;
  }
  for (PlantPatch& patch : body.patches) patch.wear /= mean;
  body.parameters.load_exponent = random.uniform(-0.2, 0.0);
}

std::vector<PlantBody> sample_boxes(std::uint64_t seed, int count) {
  std::vector<PlantBody> bodies;
  const bool is_grid = needs_grid(count);
  for (int number = 0; number < count; ++number) {
    // Separate streams for more than two: 20 to 22, 30 and 31 are used for other bodies.
    Random random = Random(seed).fork((is_grid ? 200U : 20U) + static_cast<std::uint64_t>(number));
    const Eigen::Vector3d half =
        is_grid ? grid_half_extents(random)
                : Eigen::Vector3d(random.uniform(0.05, 0.125), random.uniform(0.05, 0.125),
                                  random.uniform(0.05, 0.09));
    PlantBody body = box("box_" + std::to_string(number + 1), half);
    body.parameters = sample_parameters(random);
    const double unevenness = random.uniform() < 0.5 ? 0.0 : random.uniform(0.1, 0.6);
    const Eigen::Vector2d centre =
        kMaxOffCentre * Eigen::Vector2d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    if (unevenness > 0.0) make_pressure_uneven(body.patches, unevenness, centre, random);
    body.T_base_object = is_grid ? grid_pose(number, count, half.z(), random)
                                 : sample_box_pose(number, half.z(), random);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<PlantBody> paper_boxes(std::uint64_t seed) {
  const Eigen::Vector3d half(0.0875, 0.0875, 0.0625);
  std::vector<PlantBody> bodies{box("fp_box", half), box("r_box", half)};
  // Mass and limiting friction are the paper's, which gives no others: at breakaway soft foam is
  // compressed by 6 mm, rubber by 3 mm.
  PlantParameters& foam = bodies[0].parameters;
  foam.mass = 3.0;
  foam.limiting_static_friction = 9.57;
  foam.sliding_friction_coefficient = 0.283;
  foam.viscous_friction = 10.0;
  foam.contact_stiffness = 20600.0;
  foam.contact_damping = 82400.0;
  PlantParameters& rubber = bodies[1].parameters;
  rubber.mass = 3.5;
  rubber.limiting_static_friction = 40.62;
  rubber.sliding_friction_coefficient = 1.006;
  rubber.viscous_friction = 25.0;
  rubber.contact_stiffness = 247000.0;
  rubber.contact_damping = 617500.0;
  for (int number = 0; number < 2; ++number) {
    Random random = Random(seed).fork(30 + static_cast<std::uint64_t>(number));
    PlantBody& body = bodies[static_cast<std::size_t>(number)];
    body.T_base_object = sample_box_pose(number, half.z(), random);
    make_pressure_uneven(body.patches, 0.3, sample_centre(random), random);
  }
  return bodies;
}

std::vector<PlantBody> soft_boxes(std::uint64_t seed, double depth) {
  std::vector<PlantBody> bodies = sample_boxes(seed, 2);
  for (std::size_t number = 0; number < bodies.size(); ++number) {
    Random random = Random(seed).fork(70 + number);
    PlantParameters& p = bodies[number].parameters;
    p.contact_stiffness =
        stiffness_for(sample_log_uniform(10.0, 40.0, random), depth, p.contact_exponent);
    p.contact_damping = sample_log_uniform(1.0, 6.0, random) * p.contact_stiffness;
  }
  return bodies;
}

std::vector<PlantBody> yielding_boxes(std::uint64_t seed, double min_depth, double max_depth) {
  std::vector<PlantBody> bodies = sample_boxes(seed, 2);
  for (std::size_t number = 0; number < bodies.size(); ++number) {
    Random random = Random(seed).fork(80 + number);
    PlantParameters& p = bodies[number].parameters;
    p.contact_stiffness = stiffness_for(p.limiting_static_friction,
                                        random.uniform(min_depth, max_depth), p.contact_exponent);
    p.contact_damping = sample_log_uniform(1.0, 6.0, random) * p.contact_stiffness;
  }
  return bodies;
}

std::vector<PlantBody> struck_boxes(std::uint64_t seed, double speed, double mass) {
  std::vector<PlantBody> bodies = sample_boxes(seed, 2);
  for (std::size_t number = 0; number < bodies.size(); ++number) {
    Random random = Random(seed).fork(60 + number);
    PlantParameters& p = bodies[number].parameters;
    const double duration = sample_log_uniform(0.0025, 0.07, random);
    const double restitution = random.uniform(0.1, 0.95);
    set_impact(speed, mass, duration, restitution, p);
  }
  return bodies;
}

PlantBody slotted_block(std::uint64_t seed, double tip_radius) {
  Random random = Random(seed).fork(22);
  PlantBody body;
  body.name = "slot_block";
  const double slot = tip_radius + random.uniform(0.001, 0.004);  // half its width
  const double floor = random.uniform(0.02, 0.03);
  const double wall = random.uniform(0.03, 0.045);
  const Eigen::Vector3d half(slot + wall, random.uniform(0.06, 0.1), random.uniform(0.035, 0.05));
  const double wall_middle = floor - half.z() + (half.z() - 0.5 * floor);
  const Eigen::Vector3d wall_half(0.5 * wall, half.y(), half.z() - 0.5 * floor);
  body.parts = {{.centre = {0.0, 0.0, 0.5 * floor - half.z()},
                 .half_extents = {half.x(), half.y(), 0.5 * floor}},
                {.centre = {-slot - 0.5 * wall, 0.0, wall_middle}, .half_extents = wall_half},
                {.centre = {slot + 0.5 * wall, 0.0, wall_middle}, .half_extents = wall_half}};
  body.parameters = sample_parameters(random);
  body.parameters.mass = random.uniform(6.0, 9.0);
  // It must not slide under 40 N of friction from the tip.
  body.parameters.limiting_static_friction = 1.1 * body.parameters.mass * kStandardGravity;
  body.parameters.sliding_friction_coefficient = 0.95;
  body.parameters.contact_stiffness = stiffness_for(
      40.0, sample_log_uniform(0.0003, 0.0015, random), body.parameters.contact_exponent);
  body.parameters.contact_damping =
      sample_log_uniform(0.5, 6.0, random) * body.parameters.contact_stiffness;
  body.patches = uniform_patches(half.head<2>(), kPatchesAlong);
  body.T_base_object = sample_box_pose(0, half.z(), random);
  return body;
}

namespace {

/// The four walls and the floor around a hole, without overlap.
void build_block(const Eigen::Vector3d& half, const ObliqueHole& hole, PlantBody& body) {
  const double begin_y = hole.mouth.y() - hole.half_extents.y();
  const double end_y = hole.mouth.y() + hole.half_extents.y();
  const double wall_z = 0.5 * (hole.floor + half.z());
  const auto cuboid = [&](double low_y, double high_y, double z, double half_z) -> PlantCuboid {
    return {.centre = {0.0, 0.5 * (low_y + high_y), z},
            .half_extents = {half.x(), 0.5 * (high_y - low_y), half_z}};
  };
  const double floor_half = 0.5 * (hole.floor + half.z());
  const double wall_half = 0.5 * (half.z() - hole.floor);
  body.parts = {cuboid(-half.y(), half.y(), floor_half - half.z(), floor_half),
                cuboid(-half.y(), begin_y, wall_z, wall_half),
                cuboid(end_y, half.y(), wall_z, wall_half)};
  const double w = hole.half_extents.x();
  const double top = half.z();
  body.prisms = {{.outline_xz = {{-half.x(), hole.floor},
                                 {hole.bottom.x() - w, hole.floor},
                                 {hole.mouth.x() - w, top},
                                 {-half.x(), top}},
                  .begin_y = begin_y,
                  .end_y = end_y},
                 {.outline_xz = {{hole.bottom.x() + w, hole.floor},
                                 {half.x(), hole.floor},
                                 {half.x(), top},
                                 {hole.mouth.x() + w, top}},
                  .begin_y = begin_y,
                  .end_y = end_y}};
}

}  // namespace

PlantBody block_with_hole(std::uint64_t seed, double tip_radius) {
  Random random = Random(seed).fork(23);
  PlantBody body;
  body.name = "hole_block";
  const Eigen::Vector3d half(random.uniform(0.07, 0.09), random.uniform(0.07, 0.1),
                             random.uniform(0.04, 0.05));
  const double angle = random.uniform(15.0, 25.0) * std::numbers::pi / 180.0;
  ObliqueHole hole;
  hole.floor = -half.z() + random.uniform(0.02, 0.03);
  hole.half_extents = {(tip_radius + random.uniform(0.0003, 0.001)) / std::cos(angle),
                       tip_radius + random.uniform(0.0003, 0.001)};
  const double shift = std::tan(angle) * (half.z() - hole.floor);
  const double aside = random.uniform(0.3, 0.5) * half.y();
  hole.mouth = {-0.5 * shift, aside};
  hole.bottom = {0.5 * shift, aside};
  build_block(half, hole, body);
  PlantParameters& p = body.parameters;
  p = sample_parameters(random);
  p.mass = random.uniform(2.0, 4.0);
  const double coefficient = random.uniform(0.15, 0.35);
  p.limiting_static_friction = coefficient * p.mass * kStandardGravity;
  p.sliding_friction_coefficient = random.uniform(0.8, 0.96) * coefficient;
  p.contact_stiffness =
      stiffness_for(40.0, sample_log_uniform(0.0003, 0.0015, random), p.contact_exponent);
  p.contact_damping = sample_log_uniform(0.5, 6.0, random) * p.contact_stiffness;
  body.patches = uniform_patches(half.head<2>(), kPatchesAlong);
  // The hole's missing material shifts the centre of mass by some tenths of a millimetre.
  const double missing = hole.half_extents.prod() * (half.z() - hole.floor) / (2.0 * half.prod());
  const Eigen::Vector2d centre(0.0, -missing / (1.0 - missing) * aside);
  make_pressure_uneven(body.patches, 0.3, centre, random);
  body.T_base_object = sample_box_pose(0, half.z(), random);
  return body;
}

ObliqueHole hole_of(const PlantBody& block) {
  PCAVR_REQUIRE(block.prisms.size() == 2);
  const PlantPrism& left = block.prisms[0];
  const PlantPrism& right = block.prisms[1];
  const double y = 0.5 * (left.begin_y + left.end_y);
  const auto middle_x = [&](std::size_t l, std::size_t r) {
    return 0.5 * (left.outline_xz[l].x() + right.outline_xz[r].x());
  };
  return {.half_extents = {0.5 * (right.outline_xz[0].x() - left.outline_xz[1].x()),
                           0.5 * (left.end_y - left.begin_y)},
          .mouth = {middle_x(2, 3), y},
          .bottom = {middle_x(1, 0), y},
          .floor = left.outline_xz[0].y()};
}

Eigen::Vector3d half_extents_of(const PlantBody& body) {
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  for (const PlantCuboid& part : body.parts) {
    half = half.cwiseMax(part.centre.cwiseAbs() + part.half_extents);
  }
  return half;
}

}  // namespace pcavr::simulation
