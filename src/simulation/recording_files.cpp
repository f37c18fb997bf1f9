// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/recording_files.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

#include <fmt/core.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/simulation/plant_truth.hpp"

namespace fs = std::filesystem;

namespace pcavr::simulation {
namespace {

constexpr const char* kPhaseNames[] = {"free", "static", "critical", "sliding"};

Expected<void> make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!code) return {};
  return Error{.message = "can't be created: " + code.message(),
               .file = folder.string(),
               .hint = "choose a folder that you may write to"};
}

/// An ASCII PLY with positions and triangles.
std::string format_ply(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  text << std::setprecision(9);
  for (const Eigen::Vector3f& v : mesh.vertices) {
    text << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) text << "3 " << a << ' ' << b << ' ' << c << '\n';
  return std::move(text).str();
}

std::string format_phases(const PlantCase& plant, const PlantRun& run) {
  std::ostringstream text;
  text << "t,object,phase\n" << std::fixed << std::setprecision(6);
  for (const PlantPhaseChange& change : run.phases) {
    text << change.t << ',' << plant.bodies[change.body].name << ','
         << kPhaseNames[static_cast<int>(change.phase)] << '\n';
  }
  return std::move(text).str();
}

std::string format_impacts(const PlantCase& plant, const PlantRun& run) {
  std::string text = "t,object,duration,approach_speed,restitution\n";
  for (const PlantImpact& impact : run.impacts) {
    text +=
        fmt::format("{:.6f},{},{:.6f},{:.6f},{:.6f}\n", impact.t, plant.bodies[impact.body].name,
                    impact.duration, impact.approach_speed, impact.restitution);
  }
  return text;
}

ParameterTable parameter_table(const std::vector<PlantBody>& bodies, const PlantRun& run) {
  ParameterTable table;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const PlantBody& body = bodies[i];
    const PlantParameters p = parameters_met(run, body, i);
    const auto known = [](double value) { return ParameterValue{.value = value}; };
    table[body.name] = {.mass = known(p.mass),
                        .limiting_static_friction = known(p.limiting_static_friction),
                        .sliding_friction_coefficient = known(p.sliding_friction_coefficient),
                        .viscous_friction = known(p.viscous_friction),
                        .contact_stiffness = known(p.contact_stiffness),
                        .contact_damping = known(p.contact_damping),
                        .contact_exponent = known(p.contact_exponent),
                        .friction_radius = known(friction_radius(body.patches)),
                        .tool_friction_coefficient = known(p.tool_friction_coefficient)};
  }
  return table;
}

Trajectory moved_trajectory(const PlantRun& run, const PlantBody& body, std::size_t index) {
  Trajectory T_base_object;
  const auto count = static_cast<int>(std::ceil(run.duration() * 100.0));
  for (int i = 0; i <= count; ++i) {
    const Stamp stamp = Stamp::from_seconds(0.01 * i);
    T_base_object.append(stamp, T_base_object_at(run, body, index, stamp.seconds()));
  }
  return T_base_object;
}

Trajectory resting_trajectory(const Pose& T_base_object, const std::vector<Stamp>& frames) {
  Trajectory poses;
  for (const Stamp stamp : frames) poses.append(stamp, T_base_object);
  return poses;
}

Expected<void> write_object(const fs::path& folder, const std::string& name,
                            const Trajectory& T_base_object) {
  return write_file(folder / "objects" / (name + ".txt"), format_trajectory(T_base_object));
}

std::string format_tracking(const std::vector<SimulatedMeasurement>& measurements) {
  std::string text = "t,evidence,tags,position_sigma,rotation_sigma,surface_rms,at_rest\n";
  for (const SimulatedMeasurement& measurement : measurements) {
    const char* evidence = measurement.is_seen ? "tags_and_shape" : "none";
    // Two tags, and a surface RMS of a millimetre, as for a camera's noise.
    text += fmt::format("{},{},{},{:.6f},{:.6f},{:.6f},{:d}\n", format_stamp(measurement.stamp),
                        evidence, measurement.is_seen ? 2 : 0, measurement.position_std,
                        measurement.rotation_std, measurement.is_seen ? 0.001 : 0.0,
                        measurement.is_at_rest);
  }
  return text;
}

}  // namespace

std::vector<Pose> body_poses(const World& world, const PlantCase& plant, const PlantRun& run,
                             double t) {
  std::vector<Pose> poses{Pose()};
  for (std::size_t i = 0; i < world.boxes.size(); ++i) {
    poses.push_back(world.has_tool ? T_base_object_at(run, plant.bodies[i], i, t)
                                   : world.boxes[i].T_base_object);
  }
  if (plant.tool.arm && world.has_tool) {
    RobotDynamics kinematics(plant.tool.arm->described);
    kinematics.forward_kinematics(arm_position_at(run, t));
    for (const std::size_t link : world.arm_links) {
      poses.push_back(plant.tool.arm->T_base_robot * kinematics.T_base_link(link));
    }
  } else if (world.has_tool) {
    poses.push_back(tool_pose(p_base_tip_at(run, t)));
  }
  return poses;
}

Expected<void> write_truth(const fs::path& folder, const Truth& truth) {
  Trajectory T_base_camera;
  for (const Stamp stamp : truth.frames) {
    T_base_camera.append(stamp, truth.camera.T_base_camera(stamp.seconds()));
  }
  auto written = make_folder(folder / "truth" / "objects");
  if (written && !T_base_camera.empty()) {
    written = write_file(folder / "truth/camera.txt", format_trajectory(T_base_camera));
  }
  if (written) {
    written =
        write_file(folder / "truth/scene.ply", format_ply(truth.world.bodies.front().surface.mesh));
  }
  if (!written) return written;
  if (truth.world.has_tool) return write_plant_truth(folder / "truth", truth.plant, truth.run);
  for (std::size_t i = 0; i < truth.world.boxes.size() && written; ++i) {
    written = write_object(folder / "truth", truth.world.bodies[1 + i].name,
                           resting_trajectory(truth.world.boxes[i].T_base_object, truth.frames));
  }
  return written;
}

Expected<void> write_tracking(const fs::path& folder, const Truth& truth, std::uint64_t seed,
                              const SensorFaults& faults) {
  for (std::size_t i = 0; i < truth.plant.bodies.size(); ++i) {
    const PlantBody& body = truth.plant.bodies[i];
    if (!body.is_movable) continue;
    const auto measurements = simulated_tracking(truth.run, body, i, seed, faults);
    Trajectory T_base_object;
    for (const SimulatedMeasurement& measurement : measurements) {
      if (measurement.is_seen) T_base_object.append(measurement.stamp, measurement.T_base_object);
    }
    const fs::path target = folder / "tracked" / "objects" / body.name;
    auto written = make_folder(target);
    if (written) written = write_file(target / "tracked.txt", format_trajectory(T_base_object));
    if (written) written = write_file(target / "tracking.csv", format_tracking(measurements));
    if (!written) return written;
  }
  return {};
}

}  // namespace pcavr::simulation

namespace pcavr {

using namespace simulation;

Expected<void> write_plant_truth(const fs::path& folder, const PlantCase& plant,
                                 const PlantRun& run) {
  auto written = make_folder(folder / "objects");
  for (std::size_t i = 0; i < plant.bodies.size() && written; ++i) {
    const PlantBody& body = plant.bodies[i];
    written = write_object(folder, body.name, moved_trajectory(run, body, i));
  }
  if (written) written = write_file(folder / "phase.csv", format_phases(plant, run));
  if (written && !run.impacts.empty()) {
    written = write_file(folder / "impacts.csv", format_impacts(plant, run));
  }
  if (!written) return written;
  return write_file(folder / "parameters.yaml",
                    format_parameters(parameter_table(plant.bodies, run)));
}

}  // namespace pcavr
