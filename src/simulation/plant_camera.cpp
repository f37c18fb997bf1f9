// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/plant_camera.hpp"

#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"

#include "simulation/camera_path.hpp"
#include "simulation/color_sensor.hpp"
#include "simulation/hashed_noise.hpp"
#include "simulation/layout.hpp"
#include "simulation/renderer.hpp"

namespace pcavr {

using namespace simulation;

struct PlantCamera::Content {
  Content(World simulated_world, const SimulationCase& simulation, std::uint64_t noise_seed)
      : world(std::move(simulated_world)),
        bodies(world),
        camera(on_grid(simulated_camera(simulation), simulation.width / 2, simulation.height / 2)),
        renderer(world, bodies, camera),
        T_base_camera(CameraPath(simulation, noise_seed).T_base_camera(0.0)),
        seed(noise_seed) {
    sensor.blur = 0.5 * simulation.corner_blur;
  }

  World world;
  RayBodies bodies;
  CameraModel camera;
  Renderer renderer;
  Pose T_base_camera;
  ColorSensor sensor;
  std::uint64_t seed;
};

PlantCamera::PlantCamera(std::unique_ptr<Content> content) : content_(std::move(content)) {}
PlantCamera::PlantCamera(PlantCamera&&) noexcept = default;
PlantCamera& PlantCamera::operator=(PlantCamera&&) noexcept = default;
PlantCamera::~PlantCamera() = default;

const CameraModel& PlantCamera::camera() const { return content_->camera; }

Expected<PlantCamera> PlantCamera::create(const SimulationCase& simulation, std::uint64_t seed) {
  PCAVR_REQUIRE(simulation.task != ToolTask::none && !simulation.has_arm);
  const PlantCase plant = make_plant_case(simulation.task, seed);
  Expected<World> world = make_world(simulation, plant, seed, {});
  if (!world) return world.error();
  return PlantCamera(std::make_unique<Content>(std::move(*world), simulation, seed));
}

ColorImage PlantCamera::render(const Eigen::Vector3d& p_base_tip,
                               std::span<const Pose> T_base_objects, std::uint64_t number) const {
  const Content& c = *content_;
  PCAVR_REQUIRE(T_base_objects.size() == c.world.boxes.size(), T_base_objects.size());
  std::vector<Pose> poses{Pose()};
  poses.insert(poses.end(), T_base_objects.begin(), T_base_objects.end());
  poses.push_back(tool_pose(p_base_tip));
  return expose(c.sensor, c.renderer.render(c.T_base_camera, poses).radiance,
                hash(c.seed, 102, number));
}

}  // namespace pcavr
