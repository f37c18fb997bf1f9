// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "scene_options.hpp"

#include <algorithm>
#include <fstream>

#include <unistd.h>

#include "pcavr/perception/tracking/stated_poses.hpp"

#include "commands.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr InputRange kPoseStd{"std of a pose", 1e-6, 1.0, "m, rad",
                              "from exact to nothing: a room's width"};
constexpr InputRange kMemory{"memory", 0.36, 1e6, "GB", "from what any build takes to a petabyte"};

/// The machine's memory, or what a container may take of it [bytes].
double machine_memory() {
  const double physical =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  std::ifstream limit("/sys/fs/cgroup/memory.max");  // "max" where there is none
  double bytes = 0.0;
  return limit >> bytes ? std::min(bytes, physical) : physical;
}

}  // namespace

void add_scene_options(CLI::App& command, SceneArguments& arguments, Configuration& configuration) {
  BuildOptions& options = configuration.build;
  command.add_option("recording", arguments.recording, "Folder with a recording.yaml")->required();
  add_number(command, "--voxel", options.fusion.voxel_size, ranges::kVoxel,
             "Edge of a TSDF voxel of the mesh [m]")
      ->capture_default_str();
  add_number(command, "--occupancy-resolution", options.occupancy.resolution,
             ranges::kOccupancyCell, "Edge of an occupancy cell [m]")
      ->capture_default_str();
  add_sensor_option(command, arguments.sensor);
  CLI::Option* trust =
      command.add_flag("--trust-poses", arguments.trust_poses,
                       "Take the poses of groundtruth.txt as exact, not as measurements");
  add_number(command, "--pose-std", arguments.pose_std, kPoseStd,
             "Std of the positions in groundtruth.txt [m], and of the rotations [rad]: holds for "
             "all of them, and it is an error where tags or images contradict one by more than 5")
      ->excludes(trust);
  command.add_flag("--skip-bad", arguments.skip_bad, "Skip bad rows and frames, and count them");
  add_threads_option(command, arguments.threads);
}

CLI::Option* add_limits(CLI::App& command, SceneArguments& arguments) {
  CLI::Option* tiles = add_number(
      command, "--tiles", arguments.tile_size, kTileRange,
      "Fuse the surface by squares of this edge [m], one after the other: the same mesh in less "
      "memory");
  add_number(command, "--max-memory", arguments.max_memory, kMemory,
             "Stop before the work where it would take more [GB] (default: the machine's)");
  return tiles;
}

Expected<BuildOptions> build_options_of(const SceneArguments& arguments,
                                        const Configuration& configuration) {
  BuildOptions options = configuration.build;
  options.trust_poses = arguments.trust_poses;
  if (arguments.pose_std > 0.0) state_pose_std(arguments.pose_std, options.perception.camera);
  options.skip_bad = arguments.skip_bad;
  options.parallelism = {arguments.threads};
  const Expected<DepthNoise> noise =
      depth_noise_of(arguments.sensor, options.perception.depth_noise);
  if (!noise) return noise.error();
  options.perception.depth_noise = *noise;
  return options;
}

BuildLimits limits_of(const SceneArguments& arguments) {
  BuildLimits limits;
  if (arguments.tile_size > 0.0) limits.tile_size = arguments.tile_size;
  limits.max_memory = arguments.max_memory > 0.0 ? 1e9 * arguments.max_memory : machine_memory();
  return limits;
}

}  // namespace pcavr::app
