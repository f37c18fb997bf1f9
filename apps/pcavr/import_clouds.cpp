// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "import_clouds.hpp"

#include <numbers>
#include <span>

#include <fmt/core.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "output_option.hpp"

namespace pcavr::app {
namespace {

std::string poses_line(const CloudImportReport& report) {
  std::string text = report.poses == CloudPoses::given        ? "poses      given"
                     : report.poses == CloudPoses::viewpoints ? "poses      the clouds' viewpoints"
                                                              : "poses      aligned";
  if (report.poses == CloudPoses::aligned) {
    text += fmt::format(" with each other to {:.1f} mm (rms), overlapping by {:.0f} % or more",
                        1e3 * report.alignment_rms, 100.0 * report.alignment_overlap);
  }
  if (report.anchor_frames > 0) {
    text += fmt::format("; base by tags in {} frames, residual {:.1f} mm, {:.2f} deg",
                        report.anchor_frames, 1e3 * report.anchor_position_rms,
                        report.anchor_rotation_rms * 180.0 / std::numbers::pi);
  }
  return text + '\n';
}

std::string summary_of(const CloudImportReport& report, const std::string& folder) {
  const CameraModel& camera = report.camera;
  std::string text =
      fmt::format("clouds     {}{}, {} points; {} frames\n", report.clouds,
                  report.is_organised ? " organised" : "", report.points, report.frames);
  text += fmt::format("camera     {} x {}, fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}; ", camera.width,
                      camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  text += report.is_organised
              ? fmt::format("estimated, residual {:.3f} px (rms)\n", report.pinhole_residual)
              : fmt::format("virtual, rays {:.2f} mrad apart, {} points left out\n",
                            1e3 * report.ray_spacing, report.points_outside);
  return text + poses_line(report) + "next: pcavr build " + folder + " -o SCENE\n";
}

nlohmann::ordered_json json_of(const CloudImportReport& report, const std::string& folder) {
  const CameraModel& camera = report.camera;
  const char* poses = report.poses == CloudPoses::given        ? "given"
                      : report.poses == CloudPoses::viewpoints ? "viewpoints"
                                                               : "aligned";
  return {{"recording", folder},
          {"clouds", report.clouds},
          {"frames", report.frames},
          {"is_organised", report.is_organised},
          {"unit_m", report.unit},
          {"points", report.points},
          {"points_left_out", report.points_outside},
          {"camera", {camera.fx, camera.fy, camera.cx, camera.cy}},
          {"pinhole_residual_px", report.pinhole_residual},
          {"poses", poses},
          {"alignment_rms_m", report.alignment_rms},
          {"alignment_overlap", report.alignment_overlap},
          {"anchor_frames", report.anchor_frames},
          {"anchor_position_rms_m", report.anchor_position_rms},
          {"anchor_rotation_rms_rad", report.anchor_rotation_rms}};
}

}  // namespace

Expected<Pose> parse_pose(const std::vector<double>& numbers, const std::string& option) {
  Error error{.message = "is not tx ty tz qx qy qz qw",
              .place = option,
              .hint = "give a position in metres and a unit quaternion"};
  if (numbers.size() != 7) return error;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!ranges::kCoordinate.contains(numbers[i])) return error;
  }
  if (check_unit_quaternion(std::span(numbers).subspan(3))) return error;
  return Pose({numbers[6], numbers[3], numbers[4], numbers[5]},
              {numbers[0], numbers[1], numbers[2]});
}

void add_cloud_options(CLI::App& command, CloudArguments& arguments) {
  CLI::App* group = command.add_option_group(
      "point clouds", "PCD or PLY files, one for each frame, organised or not");
  group->add_option("--poses", arguments.poses,
                    "TUM trajectory of the clouds in base, or in a world frame with one of the "
                    "following two options; without it, the clouds' viewpoints, or the clouds are "
                    "aligned with each other");
  group
      ->add_option("--T-base-world", arguments.T_base_world,
                   "Pose of the world frame of clouds or of --object in base: tx ty tz qx qy qz qw")
      ->expected(7);
  group
      ->add_flag("--anchor-tags", arguments.anchor_tags,
                 "Find the world frame's pose by the base tags of --manifest in the clouds' "
                 "colours")
      ->excludes("--T-base-world");
  group->add_option("--manifest", arguments.manifest,
                    "recording.yaml of which markers, objects and tool are taken over");
  group->add_option("--unit", arguments.unit, "m or mm; detected if absent")
      ->check(CLI::IsMember({"m", "mm"}));
  group->add_flag("--unorganised", arguments.unorganised,
                  "Use the rays of organised clouds that are no pinhole projection");
  add_threads_option(*group, arguments.threads);
}

std::string first_cloud_option(const CloudArguments& arguments) {
  if (!arguments.poses.empty()) return "--poses";
  if (!arguments.T_base_world.empty()) return "--T-base-world";
  if (arguments.anchor_tags) return "--anchor-tags";
  if (!arguments.manifest.empty()) return "--manifest";
  if (!arguments.unit.empty()) return "--unit";
  return arguments.unorganised ? "--unorganised" : "";
}

Expected<CommandResult> run_import_clouds(const CloudPaths& paths, const CloudArguments& arguments,
                                          CloudImportOptions options, const Observer& observer) {
  Expected<OutputFolder> folder = create_output(
      paths.output, OutputKind::recording, {paths.source, arguments.poses, arguments.manifest});
  if (!folder) return folder.error();
  options.poses = arguments.poses;
  options.manifest = arguments.manifest;
  options.anchor_by_tags = arguments.anchor_tags;
  options.as_unorganised = arguments.unorganised;
  options.parallelism = {arguments.threads};
  if (!arguments.unit.empty()) options.unit = arguments.unit == "mm" ? 1e-3 : 1.0;
  if (!arguments.T_base_world.empty()) {
    const Expected<Pose> pose = parse_pose(arguments.T_base_world, "--T-base-world");
    if (!pose) return pose.error();
    options.T_base_world = *pose;
  }
  const Expected<CloudImportReport> report =
      import_clouds(paths.source, folder->path(), options, observer);
  if (!report) return report.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return CommandResult{.summary = summary_of(*report, paths.output.folder),
                       .json = json_of(*report, paths.output.folder)};
}

}  // namespace pcavr::app
