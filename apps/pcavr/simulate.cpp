// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include <fmt/core.h>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "output_option.hpp"
#include "shared_files.hpp"

namespace pcavr::app {
namespace {

struct ImageSize {
  int width = 0;
  int height = 0;
};

struct SimulateArguments {
  std::string name;
  OutputOption output;
  std::uint64_t seed = 1;
  int threads = 1;
  bool without_images = false;
  bool without_mass = false;
  bool is_immovable = false;
  bool is_wide = false;
  SensorFaults faults;
  double saturation = 0.0;
  std::string lost;
  std::string camera;
  // Empty: the case's own value.
  std::optional<double> duration;
  std::optional<int> objects;
  std::optional<double> frame_rate;
  std::optional<ImageSize> image_size;
  std::optional<ImageSize> depth_size;
};

/// "A:B", seconds.
std::optional<SensorFaults::Gap> gap_of(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::optional<double> begin = parse_number<double>(text.substr(0, colon));
  const std::optional<double> end =
      parse_number<double>(text.substr(std::min(colon + 1, text.size())));
  if (!begin || !end || !ranges::kSpan.contains(*begin) || !ranges::kSpan.contains(*end) ||
      *end <= *begin) {
    return std::nullopt;
  }
  return SensorFaults::Gap{*begin, *end};
}

constexpr double kMinDuration = 0.1;  // [s]: two frames at 20 Hz
constexpr double kMaxDuration = 3600.0;
constexpr double kMinFrameRate = 0.1;  // [Hz]
constexpr double kMaxFrameRate = 240.0;
// Tags are not detected in less; larger images are not read (libjpeg's limit is 65500, memory
// less).
constexpr int kMinImageSide = 64;  // [px]
constexpr int kMaxImageSide = 8192;

/// "WIDTHxHEIGHT", pixels.
std::optional<ImageSize> size_of(const std::string& text) {
  ImageSize size;
  char more = 0;
  const auto is_side = [](int side) { return side >= kMinImageSide && side <= kMaxImageSide; };
  if (text.size() > 9) return std::nullopt;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &more) != 2) {
    return std::nullopt;
  }
  if (!is_side(size.width) || !is_side(size.height)) return std::nullopt;
  return size;
}

std::string name_of(const ImageSize& size) {
  return std::to_string(size.width) + 'x' + std::to_string(size.height);
}

/// Checks a number against its range. Also rejects text that is not a number, which CLI11's own
/// ranges accept.
std::string check_range(const std::string& text, double min, double max, const char* unit) {
  double value = 0.0;
  char more = 0;
  const bool is_number = std::sscanf(text.c_str(), "%lf%c", &value, &more) == 1;
  if (is_number && value >= min && value <= max) return {};
  return fmt::format("'{:.20}' is not a number from {:g} to {:g} {}", text, min, max, unit);
}

Error not_applicable(const std::string& option, const SimulationCase& simulation,
                     const std::string& reason, const std::string& hint) {
  return {.message = option + " does not apply to the case '" + simulation.name + "': " + reason,
          .hint = hint};
}

/// Duration and number of objects: for the cases whose task does not determine them.
Expected<void> change_scene(SimulationCase& simulation, const SimulateArguments& arguments) {
  const bool is_free = simulation.task == ToolTask::none;
  const bool is_push = simulation.task == ToolTask::push;
  if (arguments.duration) {
    if (!is_free && !is_push) {
      return not_applicable("--duration", simulation, "it lasts as long as its task",
                            "choose tabletop, room or push");
    }
    (is_push ? simulation.push_duration : simulation.duration) = *arguments.duration;
  }
  if (arguments.objects) {
    if (!is_free && !is_push) {
      return not_applicable("--objects", simulation, "its task determines its bodies",
                            "choose tabletop, room or push");
    }
    simulation.movable_boxes = *arguments.objects;
  }
  const bool can_be_immovable =
      simulation.task == ToolTask::press || simulation.task == ToolTask::impact;
  if (arguments.is_immovable && !can_be_immovable) {
    return not_applicable("--immovable", simulation, "its boxes are pushed away, or it has none",
                          "choose press or impact");
  }
  simulation.is_immovable = arguments.is_immovable;
  return {};
}

Expected<void> change_images(SimulationCase& simulation, const SimulateArguments& arguments) {
  const bool changes_images = arguments.frame_rate || arguments.image_size || arguments.depth_size;
  if (changes_images && !simulation.with_images) {
    return Error{.message = "--frames-per-second, --image-size and --depth-size need images",
                 .hint = "omit --no-images, or these options"};
  }
  if (arguments.frame_rate) simulation.frame_rate = *arguments.frame_rate;
  if (arguments.image_size) {
    simulation.width = arguments.image_size->width;
    simulation.height = arguments.image_size->height;
  }
  if (!arguments.depth_size) return {};
  const ImageSize& depth = *arguments.depth_size;
  CameraModel color;
  color.width = simulation.width;
  color.height = simulation.height;
  if (!is_depth_grid(color, depth.width, depth.height)) {
    return Error{.message = "--depth-size " + name_of(depth) + " is not " +
                            name_of({simulation.width, simulation.height}) +
                            " divided by one factor",
                 .hint = "give a depth size with the colour image's aspect ratio, no larger"};
  }
  simulation.depth_width = depth.width;
  simulation.depth_height = depth.height;
  return {};
}

/// The case with the options applied.
Expected<SimulationCase> apply_options(SimulationCase simulation,
                                       const SimulateArguments& arguments) {
  simulation.with_images = !arguments.without_images;
  simulation.with_mass = !arguments.without_mass;
  simulation.faults = arguments.faults;
  simulation.is_wide = arguments.is_wide;
  if (arguments.saturation > 0.0) simulation.faults.saturation = arguments.saturation;
  simulation.faults.lost_tracking = gap_of(arguments.lost);
  if (const Expected<void> done = change_scene(simulation, arguments); !done) return done.error();
  if (const Expected<void> done = change_images(simulation, arguments); !done) return done.error();
  return simulation;
}

Expected<CommandResult> run_simulation(const SimulateArguments& arguments,
                                       const Observer& observer) {
  const std::vector<SimulationCase>& cases = simulation_cases();
  const auto known = std::find_if(cases.begin(), cases.end(), [&](const SimulationCase& one) {
    return one.name == arguments.name;
  });
  Expected<SimulationCase> with_options = apply_options(*known, arguments);
  if (!with_options) return with_options.error();
  SimulationCase& chosen = *with_options;
  if (!arguments.camera.empty()) {
    const Expected<CameraFile> sensor = read_camera_file(arguments.camera);
    if (!sensor) return sensor.error();
    if (sensor->camera.width < 8 || sensor->camera.height < 8) {
      return Error{.message = "an image of less than 8 x 8 pixels is too small",
                   .file = arguments.camera,
                   .hint = "give a camera with larger images"};
    }
    chosen.camera = sensor->camera;
  }
  if (!chosen.with_images && chosen.task == ToolTask::none) {
    return Error{.message = "without images the case '" + chosen.name + "' records nothing",
                 .hint = "omit --no-images, or choose a case with a tool"};
  }
  Expected<OutputFolder> folder =
      create_output(arguments.output, OutputKind::recording, {arguments.camera});
  if (!folder) return folder.error();
  const Expected<void> done =
      simulate(chosen, arguments.seed, folder->path(), {arguments.threads}, observer);
  if (!done) return done.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  return CommandResult{.summary = "next: pcavr build " + arguments.output.folder + " -o SCENE\n",
                       .json = {{"recording", arguments.output.folder},
                                {"case", arguments.name},
                                {"seed", arguments.seed}}};
}

void add_size_option(CLI::App& command, const std::string& name, std::optional<ImageSize>& size,
                     const std::string& description) {
  command
      .add_option_function<std::string>(
          name, [&size](const std::string& text) { size = size_of(text); }, description)
      ->type_name("WxH")
      ->check([](const std::string& text) {
        return size_of(text)
                   ? std::string()
                   : "'" + text.substr(0, 20) +
                         "' is not a width and a height of 64 to 8192 pixels, such as 1280x720";
      });
}

void add_scale_options(CLI::App& command, SimulateArguments& arguments) {
  command
      .add_option("--duration", arguments.duration,
                  "Duration [s], 0.1 to 3600; for tabletop, room and push, which then pushes for "
                  "that time")
      ->check([](const std::string& text) {
        return check_range(text, kMinDuration, kMaxDuration, "seconds");
      });
  command
      .add_option(
          "--objects", arguments.objects,
          "Number of movable boxes, 1 to 20; for tabletop, room and push; more than two are small")
      ->check(CLI::Range(1, PushOptions::kMaxBoxes));
  command.add_option("--frames-per-second", arguments.frame_rate, "Frame rate, 0.1 to 240")
      ->check([](const std::string& text) {
        return check_range(text, kMinFrameRate, kMaxFrameRate, "frames per second");
      });
  add_size_option(command, "--image-size", arguments.image_size,
                  "Size of the images [px]; the field of view is unchanged");
  add_size_option(command, "--depth-size", arguments.depth_size,
                  "Size of the depth images [px], if smaller than colour by one factor");
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Simulate a recording with exact ground truth: ray-cast images, tool motion, force");
  std::string footer = "Cases:\n";
  std::vector<std::string> names;
  for (const SimulationCase& known : simulation_cases()) {
    names.push_back(known.name);
    footer += "  " + known.name + ": " + known.description + '\n';
  }
  command->footer(footer + "\nExample:\n  pcavr simulate " + names.front() +
                  " -o my_recording --seed 7");
  auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("case", arguments->name, "What to simulate")
      ->required()
      ->check(CLI::IsMember(names));
  add_output_option(*command, arguments->output, "Folder for the recording");
  add_seed(*command, arguments->seed, "The same seed gives the same bytes")->capture_default_str();
  command->add_flag("--no-images", arguments->without_images,
                    "No frames: the objects' initial poses are in the manifest, and tracked/ holds "
                    "simulated marker tracking");
  command->add_flag("--without-mass", arguments->without_mass, "No masses in the manifest");
  command->add_flag("--immovable", arguments->is_immovable,
                    "The boxes are fixed to the table (movable: false); for press and impact");
  command->add_flag(
      "--wide", arguments->is_wide,
      "As in a workshop, by seed: worn supports, friction that depends on the load, "
      "pushes beside the normal, a cable that pulls the sensor, late tracking, motion "
      "blur");
  add_number(*command, "--clock-offset", arguments->faults.clock_offset, ranges::kClockOffset,
             "Delay of the wrench's timestamps [s]; negative: early");
  command->add_flag("--flip-force", arguments->faults.is_force_flipped,
                    "The wrench has the wrong sign");
  add_number(*command, "--saturate", arguments->saturation, ranges::kSaturation,
             "Measurement range of the force sensor [N]: larger forces saturate");
  command
      ->add_option("--lose-tracking", arguments->lost,
                   "Tracking is lost between these times, A:B [s]")
      ->needs("--no-images")
      ->check([](const std::string& text) {
        return gap_of(text) ? std::string() : "give two times in seconds, such as 2.5:3.5";
      });
  add_scale_options(*command, *arguments);
  command
      ->add_option("--camera", arguments->camera,
                   "Camera file: image size, intrinsics and distortion (see calib/cameras)")
      ->transform(installed_calibration())
      ->excludes("--image-size")
      ->excludes("--depth-size");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_simulation(*arguments, observer); };
  });
}

}  // namespace pcavr::app
