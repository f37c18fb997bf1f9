// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/import.hpp"

#include <fmt/format.h>

#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/cloud/cloud_list.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/import_joint_log.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "commands.hpp"
#include "import_bag.hpp"
#include "import_clouds.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "shared_files.hpp"

namespace pcavr::app {
namespace {

/// More than ten hours at 90 Hz.
constexpr std::size_t kMaxFrames = 10'000'000;

constexpr InputRange kRowPeriod{"time between rows", 1e-5, 10.0, "s",
                                "from the fastest drives to loggers by hand"};

struct ImportArguments {
  std::string source;
  OutputOption output;
  std::string format;
  std::string camera;
  double depth_scale = 0.0;
  double period = 0.0;  ///< [s] 0: not given
  bool skip_bad = false;
  ImportOptions options;
  CloudArguments clouds;
  BagArguments bag;
};

bool is_of_bag(const ImportArguments& arguments, const CsvOptions& csv) {
  if (!arguments.format.empty()) return arguments.format == "bag";
  std::error_code code;
  const bool is_recording =
      std::filesystem::exists(std::filesystem::path(arguments.source) / "recording.yaml", code);
  return !is_recording && (has_csv_series(arguments.source, csv) || is_bag(arguments.source));
}

bool is_of_clouds(const ImportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format == "clouds";
  std::error_code code;
  const std::filesystem::path source = arguments.source;
  const bool has_images = std::filesystem::exists(source / "rgb.txt", code) ||
                          std::filesystem::exists(source / "recording.yaml", code);
  return !has_images && has_clouds(source);
}

bool is_joint_log(const ImportArguments& arguments) {
  if (!arguments.format.empty()) return arguments.format == "joints";
  return has_joint_log(arguments.source);
}

/// A recording without images: its manifest, and joints.csv.
Expected<CommandResult> import_joints(const ImportArguments& arguments) {
  Expected<OutputFolder> folder =
      create_output(arguments.output, OutputKind::recording, {arguments.source});
  if (!folder) return folder.error();
  JointLogImportOptions options;
  if (arguments.period > 0.0) options.period = arguments.period;
  options.skip_bad = arguments.skip_bad;
  const Expected<ImportedJointLog> imported = import_joint_log(arguments.source, options);
  if (!imported) return imported.error();
  Expected<void> written = write_file(folder->path() / "recording.yaml", format_manifest({}));
  if (!written) return written.error();
  written = write_file(folder->path() / "joints.csv", format_joint_log(imported->log));
  if (!written) return written.error();
  written = folder->commit();
  if (!written) return written.error();
  const JointLog& log = imported->log;
  const std::string& name = arguments.output.folder;
  return CommandResult{
      .summary = fmt::format(
          "{} rows of {} joints, {:.6g} s, {} rows not after the one before "
          "left out, {} bad rows skipped\n{}next: pcavr identify robot {} --robot URDF -o REPORT\n",
          log.t.size(), log.joints.size(), log.t.back(), imported->left_out, imported->bad,
          options.period ? fmt::format("stamps: a row each {:.6g} s, as given\n", *options.period)
                         : "",
          name),
      .json = {{"recording", name},
               {"rows", log.t.size()},
               {"joints", log.joints.size()},
               {"left_out", imported->left_out},
               {"bad", imported->bad}}};
}

Expected<CommandResult> import_sequence(const ImportArguments& arguments,
                                        const Observer& observer) {
  CloudImportOptions options;
  options.frame_rate = arguments.options.frame_rate;
  options.stride = arguments.options.stride;
  options.first = arguments.options.first;
  if (arguments.depth_scale > 0.0) options.depth_scale = arguments.depth_scale;
  return run_import_clouds({arguments.source, arguments.output}, arguments.clouds, options,
                           observer);
}

Expected<CommandResult> import_from_bag(const ImportArguments& arguments, CsvOptions csv,
                                        const Observer& observer) {
  CloudArguments others = arguments.clouds;
  others.manifest.clear();
  others.T_base_world.clear();
  const std::string cloud_option = first_cloud_option(others);
  if (!cloud_option.empty()) {
    return Error{.message = cloud_option + " is for point clouds, but this is a bag",
                 .file = arguments.source};
  }
  BagImportOptions options;
  options.csv = std::move(csv);
  options.manifest = arguments.clouds.manifest;
  if (!arguments.clouds.T_base_world.empty()) {
    const Expected<Pose> pose = parse_pose(arguments.clouds.T_base_world, "--T-base-world");
    if (!pose) return pose.error();
    options.T_base_world = *pose;
  }
  options.stride = arguments.options.stride;
  options.first = arguments.options.first;
  if (arguments.depth_scale > 0.0) {
    options.depth_scale = options.raw_depth_scale = arguments.depth_scale;
  }
  if (!arguments.camera.empty()) {
    const Expected<CameraFile> sensor = read_camera_file(arguments.camera);
    if (!sensor) return sensor.error();
    options.camera = sensor->camera;
    if (!options.raw_depth_scale) options.raw_depth_scale = sensor->depth_scale;
  }
  return run_import_bag(arguments.source, arguments.output, arguments.bag, options, observer);
}

/// States which of two possible scales is used, and why.
std::string depth_scale_warning(const ImportedDepthScale& scale) {
  const std::string hint = fmt::format("; --depth-scale {:g} if that is wrong", *scale.other);
  if (!scale.share_in_range) {
    return fmt::format("depth_scale {:g} is used, where such folders usually have {:g}", scale.used,
                       *scale.other) +
           hint;
  }
  return fmt::format(
             "depth_scale {:g} is used: {:.0f} % of the readings are in the camera's range "
             "then, with {:g} {:.0f} %",
             scale.used, 100.0 * *scale.share_in_range, *scale.other,
             100.0 * *scale.other_share_in_range) +
         hint;
}

Expected<CommandResult> run_import(ImportArguments arguments, const Observer& observer) {
  const Expected<CsvOptions> csv = csv_options(arguments.bag, arguments.skip_bad);
  if (!csv) return csv.error();
  if (is_of_bag(arguments, *csv)) return import_from_bag(arguments, *csv, observer);
  if (const std::string option = first_bag_option(arguments.bag); !option.empty()) {
    if (auto unknown = unknown_csv_columns(arguments.source)) return *std::move(unknown);
    return Error{.message = option + " is for bags, but this is none",
                 .file = arguments.source,
                 .hint = "give a .bag, .mcap or .db3 file, the folder of one, or CSV files"};
  }
  if (is_joint_log(arguments)) return import_joints(arguments);
  if (arguments.skip_bad) {
    return Error{
        .message = "--skip-bad is for CSV files and the log of an arm, but this is neither",
        .file = arguments.source,
        .hint = "import without it; build and replay have their own"};
  }
  if (is_of_clouds(arguments)) return import_sequence(arguments, observer);
  if (const std::string option = first_cloud_option(arguments.clouds); !option.empty()) {
    return Error{.message = option + " is for point clouds, but there are none",
                 .file = arguments.source,
                 .hint = "give a folder with .pcd or .ply files, or a list of them"};
  }
  Expected<OutputFolder> folder =
      create_output(arguments.output, OutputKind::recording, {arguments.source, arguments.camera});
  if (!folder) return folder.error();
  ImportOptions& options = arguments.options;
  if (arguments.format == "tum") options.format = ImportFormat::tum_rgbd;
  if (arguments.format == "7scenes") options.format = ImportFormat::seven_scenes;
  if (arguments.depth_scale > 0.0) options.depth_scale = arguments.depth_scale;
  if (!arguments.camera.empty()) {
    const Expected<CameraFile> sensor = read_camera_file(arguments.camera);
    if (!sensor) return sensor.error();
    options.camera = sensor->camera;
    options.camera_depth_scale = sensor->depth_scale;
    options.depth_noise = sensor->depth_noise;
  }
  const Expected<ImportReport> report =
      import_recording(arguments.source, folder->path(), options, observer);
  if (!report) return report.error();
  if (report->depth_scale.other) {
    observer.on_warning(arguments.camera + ": " + depth_scale_warning(report->depth_scale));
  }
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  const std::string& folder_name = arguments.output.folder;
  return CommandResult{
      .summary = std::to_string(report->frames) + " frames, " + std::to_string(report->poses) +
                 " camera poses, " + std::to_string(report->left_out) +
                 " unpaired images skipped, " + std::to_string(report->poses_left_out) +
                 " frames without a pose\nnext: pcavr build " + folder_name + " -o SCENE\n",
      .json = {{"recording", folder_name},
               {"frames", report->frames},
               {"poses", report->poses},
               {"left_out", report->left_out},
               {"poses_left_out", report->poses_left_out}}};
}

}  // namespace

void add_import(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("import",
                         "Convert a bag of ROS 1 or ROS 2, CSV files of poses and forces, a TUM "
                         "RGB-D or 7-Scenes folder, point clouds, or the log of an arm into a "
                         "recording");
  command->footer(
      "Example:\n  pcavr import rgbd_dataset_freiburg1_desk --camera calib/cameras/kinect_v1.yaml "
      "--depth-scale 5000 -o desk\n  pcavr import clouds/ --poses poses.txt -o scan\n  pcavr "
      "import push.bag "
      "--wrench-topic /netft_data --object "
      "box=/vicon/box/box -o push");
  auto arguments = std::make_shared<ImportArguments>();
  command
      ->add_option(
          "source", arguments->source,
          "Bag (.bag, .mcap, .db3 or a folder), folder, what the names of a run's CSV files begin "
          "with, cloud file (.pcd, .ply), or list of clouds 'timestamp path'")
      ->required();
  add_output_option(*command, arguments->output, "Folder for the recording");
  command
      ->add_option("--format", arguments->format,
                   "bag, tum, 7scenes, clouds or joints; detected from the files if absent")
      ->check(CLI::IsMember({"bag", "tum", "7scenes", "clouds", "joints"}));
  command
      ->add_option("--camera", arguments->camera,
                   "Camera file for a source without intrinsics (see calib/cameras)")
      ->transform(installed_calibration());
  add_number(
      *command, "--depth-scale", arguments->depth_scale, ranges::kDepthScale,
      "Depth image units per metre; without it the camera file's or the format's, by the readings");
  add_number(*command, "--rate", arguments->options.frame_rate, ranges::kImportRate,
             "Frame rate of a source without timestamps [Hz]")
      ->capture_default_str();
  add_number(*command, "--period", arguments->period, kRowPeriod,
             "Time between rows of a joint log without stamps [s]");
  command->add_flag("--skip-bad", arguments->skip_bad,
                    "Skip rows of CSV files that can't be read, and count them");
  add_whole<std::size_t>(*command, "--stride", arguments->options.stride, 1, kMaxFrames,
                         "Import every n-th frame")
      ->capture_default_str();
  add_whole<std::size_t>(*command, "--first", arguments->options.first, 0, kMaxFrames,
                         "Index of the first frame to import")
      ->capture_default_str();
  add_bag_options(*command, arguments->bag);
  add_cloud_options(*command, arguments->clouds);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_import(*arguments, observer); };
  });
}

}  // namespace pcavr::app
