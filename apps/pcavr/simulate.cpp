// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <optional>

#include "pcavr/geometry/depth_grid.hpp"
#include "pcavr/recording/camera_file.hpp"

#include "commands.hpp"
#include "number_option.hpp"
#include "output_option.hpp"

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
  SensorFaults faults;
  double saturation = 0.0;
  std::string lost;
  std::string camera;
  // Nothing: what the case has.
  std::optional<double> duration;
  std::optional<int> objects;
  std::optional<double> frame_rate;
  std::optional<ImageSize> image_size;
  std::optional<ImageSize> depth_size;
};

/// "A:B", seconds.
std::optional<SensorFaults::Gap> gap_of(const std::string& text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::optional<double> begin = whole_number<double>(text.substr(0, colon));
  const std::optional<double> end =
      whole_number<double>(text.substr(std::min(colon + 1, text.size())));
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
// Tags are not found in less; more is not read (libjpeg's limit is 65500, memory ends before).
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

/// Also refuses what is not a number, which CLI11's own ranges let pass.
std::string check_range(const std::string& text, double low, double high, const char* unit) {
  double value = 0.0;
  char more = 0;
  const bool is_number = std::sscanf(text.c_str(), "%lf%c", &value, &more) == 1;
  if (is_number && value >= low && value <= high) return {};
  char line[120];
  std::snprintf(line, sizeof line, "'%.20s' is not a number from %g to %g %s", text.c_str(), low,
                high, unit);
  return line;
}

Error refused(const std::string& option, const SimulationCase& simulation,
              const std::string& reason, const std::string& hint) {
  return {.message = option + " does not go with the case '" + simulation.name + "': " + reason,
          .hint = hint};
}

/// How long, how many objects: for the cases whose course does not depend on them.
Expected<void> change_scene(SimulationCase& simulation, const SimulateArguments& arguments) {
  const bool is_free = simulation.task == ToolTask::none;
  const bool is_push = simulation.task == ToolTask::push;
  if (arguments.duration) {
    if (!is_free && !is_push) {
      return refused("--duration", simulation, "it lasts as long as its task",
                     "choose tabletop, room or push");
    }
    (is_push ? simulation.push_duration : simulation.duration) = *arguments.duration;
  }
  if (arguments.objects) {
    if (!is_free && !is_push) {
      return refused("--objects", simulation, "its task is for the bodies that it has",
                     "choose tabletop, room or push");
    }
    simulation.movable_boxes = *arguments.objects;
  }
  return {};
}

Expected<void> change_images(SimulationCase& simulation, const SimulateArguments& arguments) {
  const bool changes_images = arguments.frame_rate || arguments.image_size || arguments.depth_size;
  if (changes_images && !simulation.with_images) {
    return Error{.message = "--frames-per-second, --image-size and --depth-size are for images",
                 .hint = "leave out --no-images, or these"};
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
                 .hint = "give a depth image the shape of the colour image, no larger"};
  }
  simulation.depth_width = depth.width;
  simulation.depth_height = depth.height;
  return {};
}

/// The case asked for, with what the options change in it.
Expected<SimulationCase> changed(SimulationCase simulation, const SimulateArguments& arguments) {
  simulation.with_images = !arguments.without_images;
  simulation.with_mass = !arguments.without_mass;
  simulation.faults = arguments.faults;
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
  Expected<SimulationCase> with_options = changed(*known, arguments);
  if (!with_options) return with_options.error();
  SimulationCase& chosen = *with_options;
  if (!arguments.camera.empty()) {
    const Expected<CameraFile> sensor = read_camera_file(arguments.camera);
    if (!sensor) return sensor.error();
    if (sensor->camera.width < 8 || sensor->camera.height < 8) {
      return Error{.message = "an image of less than 8 x 8 pixels shows nothing",
                   .file = arguments.camera,
                   .hint = "give a camera with larger images"};
    }
    chosen.camera = sensor->camera;
  }
  if (!chosen.with_images && chosen.task == ToolTask::none) {
    return Error{.message = "without images the case '" + chosen.name + "' records nothing",
                 .hint = "leave out --no-images, or choose a case with a tool"};
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
                         "' is not a width and a height of 64 to 8192 pixels, as 1280x720";
      });
}

void add_scale_options(CLI::App& command, SimulateArguments& arguments) {
  command
      .add_option("--duration", arguments.duration,
                  "How long it lasts [s], 0.1 to 3600: tabletop, room; push, which then goes on "
                  "pushing until then")
      ->check([](const std::string& text) {
        return check_range(text, kMinDuration, kMaxDuration, "seconds");
      });
  command
      .add_option("--objects", arguments.objects,
                  "Movable boxes, 1 to 20: tabletop, room, push; more than two are small")
      ->check(CLI::Range(1, PushOptions::kMaxBoxes));
  command.add_option("--frames-per-second", arguments.frame_rate, "Images in a second, 0.1 to 240")
      ->check([](const std::string& text) {
        return check_range(text, kMinFrameRate, kMaxFrameRate, "frames per second");
      });
  add_size_option(command, "--image-size", arguments.image_size,
                  "Of the images [px]; as wide a view as ever");
  add_size_option(command, "--depth-size", arguments.depth_size,
                  "Of the depth images [px], where smaller than colour by one factor");
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "simulate", "Make a recording with exact truth: ray-cast images, tool, force");
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
                    "No frames: the objects' start is in the manifest, and tracked/ holds what a "
                    "marker tracker would have found");
  command->add_flag("--without-mass", arguments->without_mass, "No masses in the manifest");
  add_number(*command, "--clock-offset", arguments->faults.clock_offset, ranges::kClockOffset,
             "The wrench's stamps are late by this [s]; early where negative");
  command->add_flag("--flip-force", arguments->faults.is_force_flipped,
                    "The wrench has the wrong sign");
  add_number(*command, "--saturate", arguments->saturation, ranges::kSaturation,
             "The force sensor's end of range [N]");
  command
      ->add_option("--lose-tracking", arguments->lost,
                   "No object is seen between these times, A:B [s]")
      ->needs("--no-images")
      ->check([](const std::string& text) {
        return gap_of(text) ? std::string() : "give two times in seconds, as 2.5:3.5";
      });
  add_scale_options(*command, *arguments);
  command
      ->add_option("--camera", arguments->camera,
                   "Camera file: image size, intrinsics and lens (see calib/cameras)")
      ->excludes("--image-size")
      ->excludes("--depth-size");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_simulation(*arguments, observer); };
  });
}

}  // namespace pcavr::app
