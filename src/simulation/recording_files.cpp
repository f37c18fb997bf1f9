// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/recording_files.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "pcavr/core/output.hpp"
#include "pcavr/core/random.hpp"

namespace pcavr::simulation {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPhaseNames[] = {"free", "static", "critical", "sliding"};

Expected<void> make_folder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!code) return {};
  return Error{.message = "can't be made: " + code.message(),
               .file = folder.string(),
               .mend = "choose a folder that you may write to"};
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

std::string format_phases(const Truth& truth) {
  std::ostringstream text;
  text << "t,object,phase\n" << std::fixed << std::setprecision(6);
  for (const PhaseChange& change : truth.push.phases) {
    text << change.t << ',' << truth.world.bodies[1 + change.box].name << ','
         << kPhaseNames[static_cast<int>(change.phase)] << '\n';
  }
  return std::move(text).str();
}

std::string format_parameters(const Truth& truth) {
  std::ostringstream text;
  text << std::setprecision(9);
  for (std::size_t i = 0; i < truth.push.parameters.size(); ++i) {
    const PushParameters& p = truth.push.parameters[i];
    text << truth.world.bodies[1 + i].name << ":\n"
         << "  mass: " << p.mass << '\n'
         << "  limiting_static_friction: " << p.limiting_static_friction << '\n'
         << "  sliding_friction_coefficient: " << p.sliding_friction_coefficient << '\n'
         << "  viscous_friction: " << p.viscous_friction << '\n'
         << "  contact:\n"
         << "    stiffness: " << p.contact_stiffness << '\n'
         << "    damping: " << p.contact_damping << '\n'
         << "    exponent: " << p.contact_exponent << '\n';
  }
  return std::move(text).str();
}

Trajectory object_trajectory(const Truth& truth, std::size_t box) {
  Trajectory T_base_object;
  if (!truth.world.has_tool) {
    for (const Stamp stamp : truth.frames) {
      T_base_object.append(stamp, truth.world.boxes[box].T_base_object);
    }
    return T_base_object;
  }
  const auto count = static_cast<int>(std::ceil(truth.duration * 100.0));
  for (int i = 0; i <= count; ++i) {
    const Stamp stamp = Stamp::from_seconds(0.01 * i);
    T_base_object.append(stamp, body_poses(truth.world, truth.push, stamp.seconds())[1 + box]);
  }
  return T_base_object;
}

Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

Trajectory reported_tool(const Truth& truth, Random random) {
  Trajectory T_base_tool;
  for (std::size_t i = 0; i < truth.push.tip.size(); i += 2) {
    const Stamp stamp = Stamp::from_seconds(PushRun::kStep * static_cast<double>(i));
    Vector6d noise;
    noise << 5e-5 * normal_vector(random), 2e-4 * normal_vector(random);
    const Pose exact = body_poses(truth.world, truth.push, stamp.seconds()).back();
    T_base_tool.append(stamp, exact * Pose::exp(noise));
  }
  return T_base_tool;
}

std::vector<WrenchSample> reported_wrench(const Truth& truth, Random random) {
  constexpr double kBias = 0.1;    // [N], of the wandering bias
  constexpr double kMemory = 3.0;  // [s], after which it has forgotten where it was
  constexpr double kPeriod = 2.0 * PushRun::kStep;
  constexpr double kSpikes = 1e-3;  // probability in a sample
  const double keep = std::exp(-kPeriod / kMemory);
  Eigen::Vector3d bias = kBias * normal_vector(random);
  std::vector<WrenchSample> samples;
  for (std::size_t i = 0; i + 1 < truth.push.force.size(); i += 2) {
    const Stamp stamp = Stamp::from_seconds(PushRun::kStep * static_cast<double>(i + 1));
    Eigen::Vector3d force(0.0, 0.5 * (truth.push.force[i] + truth.push.force[i + 1]), 0.0);
    force += bias + normal_vector(random).cwiseProduct(Eigen::Vector3d(0.20, 0.20, 0.26));
    if (random.uniform() < kSpikes) {
      force += random.uniform(6.0, 35.0) * normal_vector(random).normalized();
    }
    bias = keep * bias + kBias * std::sqrt(1.0 - keep * keep) * normal_vector(random);
    // The push goes through the tip's centre: no torque about it but noise.
    samples.push_back({.stamp = stamp, .force = force, .torque = 0.005 * normal_vector(random)});
  }
  return samples;
}

}  // namespace

Expected<void> write_truth(const fs::path& folder, const Truth& truth) {
  Trajectory T_base_camera;
  for (const Stamp stamp : truth.frames) {
    T_base_camera.append(stamp, truth.camera.T_base_camera(stamp.seconds()));
  }
  auto written = make_folder(folder / "truth" / "objects");
  if (written) written = write_file(folder / "truth/camera.txt", format_trajectory(T_base_camera));
  for (std::size_t i = 0; i < truth.world.boxes.size() && written; ++i) {
    written = write_file(folder / "truth/objects" / (truth.world.bodies[1 + i].name + ".txt"),
                         format_trajectory(object_trajectory(truth, i)));
  }
  if (written) {
    written =
        write_file(folder / "truth/scene.ply", format_ply(truth.world.bodies.front().surface.mesh));
  }
  if (!written || !truth.world.has_tool) return written;
  written = write_file(folder / "truth/phase.csv", format_phases(truth));
  if (written) written = write_file(folder / "truth/parameters.yaml", format_parameters(truth));
  return written;
}

Expected<void> write_tool_streams(RecordingWriter& writer, const Truth& truth, std::uint64_t seed) {
  if (!truth.world.has_tool) return {};
  const Random root(seed);
  const auto written = writer.write_tool(reported_tool(truth, root.fork(6)));
  if (!written) return written;
  return writer.write_wrench(reported_wrench(truth, root.fork(7)));
}

}  // namespace pcavr::simulation
