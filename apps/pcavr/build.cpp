// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>

#include <unistd.h>

#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/perception/tracking/stated_poses.hpp"
#include "pcavr/pipeline/build_limits.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "summary.hpp"

namespace pcavr::app {
namespace {

constexpr InputRange kPoseStd{"std of a pose", 1e-6, 1.0, "m, rad",
                              "from exact to nothing: a room's width"};

constexpr InputRange kTile{
    "edge of a tile", 0.5, 1000.0, "m",
    "from a table, below which borders cost more than they save, to any hall"};
constexpr InputRange kMemory{"memory", 0.36, 1e6, "GB", "from what any build takes to a petabyte"};

struct BuildArguments {
  std::string recording;
  OutputOption output;
  std::string sensor;
  bool trust_poses = false;
  double pose_std = 0.0;  ///< [m, rad]; 0: the configuration's
  bool skip_bad = false;
  double tile_size = 0.0;   ///< [m]; 0: none
  double max_memory = 0.0;  ///< [GB]; 0: the machine's
  int threads = 1;
};

/// The machine's memory, or what a container may take of it [bytes].
double machine_memory() {
  const double physical =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  std::ifstream limit("/sys/fs/cgroup/memory.max");  // "max" where there is none
  double bytes = 0.0;
  return limit >> bytes ? std::min(bytes, physical) : physical;
}

BuildLimits limits_of(const BuildArguments& arguments) {
  BuildLimits limits;
  if (arguments.tile_size > 0.0) limits.tile_size = arguments.tile_size;
  limits.max_memory = arguments.max_memory > 0.0 ? 1e9 * arguments.max_memory : machine_memory();
  return limits;
}

Expected<CommandResult> build(const BuildArguments& arguments, Configuration& configuration,
                              const Observer& observer) {
  BuildOptions options = configuration.build;
  options.trust_poses = arguments.trust_poses;
  if (arguments.pose_std > 0.0) state_pose_std(arguments.pose_std, options.perception.camera);
  options.skip_bad = arguments.skip_bad;
  options.parallelism = {arguments.threads};
  // First, so that an output that can't be written fails before the long work.
  Expected<OutputFolder> folder =
      create_output(arguments.output, OutputKind::scene, {arguments.recording, arguments.sensor});
  if (!folder) return folder.error();
  const Expected<DepthNoise> noise =
      depth_noise_of(arguments.sensor, options.perception.depth_noise);
  if (!noise) return noise.error();
  options.perception.depth_noise = *noise;
  const Expected<Recording> recording =
      read_with_warnings(arguments.recording, options.skip_bad, configuration, observer);
  if (!recording) return recording.error();
  Expected<Scene> scene = build_scene_within(limits_of(arguments), *recording, options, observer);
  if (!scene) return scene.error();
  scene->configuration = configuration.changed();
  const Expected<void> written = write_scene(*scene, folder->path(), options.parallelism);
  if (!written) return written.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  CommandResult result{.summary = scene_summary(*scene, arguments.output.folder),
                       .json = scene_json(*scene, arguments.output.folder)};
  describe_left_out(recording->left_out, result);
  return result;
}

}  // namespace

void add_build(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command =
      app.add_subcommand("build", "Build a scene in the robot's base frame from a recording");
  command->footer("Example:\n  pcavr build my_recording -o my_scene --voxel 0.005");
  auto arguments = std::make_shared<BuildArguments>();
  BuildOptions& options = configuration.build;
  command->add_option("recording", arguments->recording, "Folder with a recording.yaml")
      ->required();
  add_output_option(*command, arguments->output, "Folder for the scene");
  add_number(*command, "--voxel", options.fusion.voxel_size, ranges::kVoxel,
             "Edge of a TSDF voxel of the mesh [m]")
      ->capture_default_str();
  add_number(*command, "--occupancy-resolution", options.occupancy.resolution,
             ranges::kOccupancyCell, "Edge of an occupancy cell [m]")
      ->capture_default_str();
  add_sensor_option(*command, arguments->sensor);
  CLI::Option* trust =
      command->add_flag("--trust-poses", arguments->trust_poses,
                        "Take the poses of groundtruth.txt as exact, not as measurements");
  add_number(*command, "--pose-std", arguments->pose_std, kPoseStd,
             "Std of the positions in groundtruth.txt [m], and of the rotations [rad]: holds for "
             "all of them, and it is an error where tags or images contradict one by more than 5")
      ->excludes(trust);
  command->add_flag("--skip-bad", arguments->skip_bad, "Skip bad rows and frames, and count them");
  add_number(*command, "--tiles", arguments->tile_size, kTile,
             "Fuse the surface by squares of this edge [m], one after the other: the same mesh in "
             "less memory");
  add_number(*command, "--max-memory", arguments->max_memory, kMemory,
             "Stop before the work where it would take more [GB] (default: the machine's)");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return build(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
