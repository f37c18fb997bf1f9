// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Haptic rendering at 1 kHz: a hand presses into the top of a CAD body on its support, 20 mm/s in
// and out. The god-object stays on the surface; the force follows the penetration, up to the
// device's limit.
//   07_render_forces CAD_FILE
#include <algorithm>
#include <cstdio>

#include <pcavr/teleoperation/haptics/haptic_world.hpp>

namespace {

constexpr double kCycle = 0.001;  // [s]
constexpr double kSpeed = 0.02;   // [m/s]
constexpr double kDepth = 0.01;   // [m] deepest point of the hand, below first contact

pcavr::Expected<void> render(const char* cad_file) {
  const auto cad = pcavr::read_cad_model(cad_file, "body");
  if (!cad) return cad.error();
  const Eigen::AlignedBox3d box = pcavr::bounds(cad->mesh_object.vertices).cast<double>();
  const auto T_base_body = pcavr::Pose::from_translation({0.0, 0.0, -box.min().z()});
  pcavr::BodyPhysics physics = pcavr::complete_physics({}, *cad, T_base_body).physics;
  // Softer than the default: several millimetres within the range of the device.
  physics.contact = {.stiffness = 1000.0, .damping = 5.0, .exponent = 1.0};
  pcavr::HapticWorldModel model;
  model.world.bodies.push_back({*cad, T_base_body, physics});
  model.force.max_force = 6.0;
  auto world = pcavr::HapticWorld::create(model);
  if (!world) return world.error();

  const Eigen::Vector3d centre_base = T_base_body * cad->centre_of_mass_object;
  const double top = box.sizes().z() + model.world.tool_radius;
  const Eigen::Vector3d start(centre_base.x(), centre_base.y(), top + 0.002);
  world->reset(start);
  const double turn = (kDepth + 0.002) / kSpeed;
  for (int cycle = 1; cycle * kCycle <= 2.0 * turn; ++cycle) {
    const double t = cycle * kCycle;
    const double down = kSpeed * std::min(t, 2.0 * turn - t);
    world->step({start - down * Eigen::Vector3d::UnitZ(), true}, kCycle);
    if (cycle % 100 != 0) continue;
    const pcavr::HapticWorldState& state = world->state();
    std::printf("%.2f s  hand %6.2f mm, god-object %5.2f mm above contact  force %.2f N%s\n", t,
                1e3 * (state.p_base_hip.z() - top), 1e3 * (state.p_base_proxy.z() - top),
                state.force_base.norm(), state.touched_body == 0U ? "  touches the body" : "");
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s CAD_FILE\n", argv[0]), 2;
  const auto done = render(argv[1]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().to_string().c_str());
  return done ? 0 : 1;
}
