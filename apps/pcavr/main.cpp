// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/core/signal_cleanup.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/base/report/report_command.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/option_file.hpp"

#include "command_description.hpp"
#include "commands.hpp"
#include "failure.hpp"
#include "help_formatter.hpp"
#include "number_option.hpp"
#include "shared_files.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

#ifndef PCAVR_VERSION
#error "PCAVR_VERSION is set by the build"
#endif

namespace pcavr::app {
namespace {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
constexpr int kExitNo = 3;        ///< the answer to a question is no
constexpr int kMaxThreads = 256;  ///< above the machines that pcavr was tested on

/// A program that was started without one of its descriptors 0 to 2, as by cron or `<&-`, would
/// open its files as these, and print into them. False if that can't be prevented.
bool open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) != -1) continue;
    if (::open("/dev/null", O_RDWR) != descriptor) return false;
  }
  return true;
}

/// One line on standard error, and with --json an object on standard output.
int report_error(const Error& error, bool as_json, int exit_code = kExitFailed) {
  const std::string name = styled("pcavr:", TextStyle::kError, has_colors(STDERR_FILENO));
  std::fprintf(stderr, "%s %s\n", name.c_str(), error.to_string().c_str());
  if (as_json) std::cout << json_text(error_json(error, exit_code), 2) << '\n' << std::flush;
  return exit_code;
}

int run(const Action& action, bool as_json) {
  Console console;
  install_signal_cleanup();
  const Expected<CommandResult> result = action(console.observer());
  wait_if_interrupted();
  if (!result) return report_error(result.error(), as_json);
  if (as_json) {
    std::cout << json_text(result->json, 2) << '\n';
  } else {
    std::cout << printable_lines(result->summary);
  }
  std::cout.flush();
  if (!std::cout) return report_error({.message = "can't write to standard output"}, false);
  if (result->is_failure) return kExitFailed;
  return result->is_no ? kExitNo : kExitDone;
}

/// Needed for errors before the command line is parsed, and for exceptions.
bool has_json_flag(std::span<char* const> arguments) {
  return std::any_of(arguments.begin(), arguments.end(),
                     [](const char* argument) { return std::string_view(argument) == "--json"; });
}

/// Help and version are printed, too; returns the exit code.
int report_usage(const CLI::App& app, const CLI::ParseError& error, bool as_json) {
  const bool is_version = dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr;
  const bool is_request = error.get_exit_code() == kExitDone;
  if (is_version || (is_request && unknown_command(app).empty())) return app.exit(error);
  return report_error(usage_error(app, error), as_json, kExitUsage);
}

/// An option or argument that was given without a value, as by an unset variable of a shell: it
/// must not count as omitted.
std::optional<Error> find_empty_value(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::vector<std::string>& values = option->results();
    if (std::find(values.begin(), values.end(), "") == values.end()) continue;
    return Error{.message = "the value of " + option->get_name() + " is empty",
                 .hint = "see pcavr " + command.get_name() + " --help"};
  }
  // Option groups are subcommands, too; those that were not invoked have no results.
  for (const CLI::App* subcommand : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (auto error = find_empty_value(*subcommand)) return error;
  }
  return std::nullopt;
}

int print(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) return report_error({.message = "can't write to standard output"}, false);
  return kExitDone;
}

/// The words of the command line after the program's name, from the last to the first, as CLI11
/// takes them; "help build" is "build --help".
std::vector<std::string> reversed_words(std::span<char* const> given) {
  std::vector<std::string> words(given.begin() + (given.empty() ? 0 : 1), given.end());
  if (!words.empty() && words.front() == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  std::reverse(words.begin(), words.end());
  return words;
}

int run_command_line(int argc, char** argv) {
  const std::span<char* const> given(argv, static_cast<std::size_t>(argc));
  CLI::App app("Point-cloud augmented VR scenes from recorded depth frames, in the robot's base.");
  app.set_version_flag("-v,--version", "pcavr " PCAVR_VERSION);
  app.name("pcavr");
  app.require_subcommand(1);
  app.fallthrough();
  bool as_json = false;
  app.add_flag("--json", as_json, "Print the result as JSON on standard output");
  app.formatter(std::make_shared<HelpFormatter>(help_width(), has_colors(STDOUT_FILENO)));
  bool is_described = false;
  app.add_flag("--describe-commands", is_described, "All commands as JSON, and exit")->group("");

  Configuration configuration;
  ConfigurationOptions configuration_options;
  add_configuration_options(app, configuration, configuration_options);

  Action action;
  add_build(app, configuration, action);
  add_identify(app, configuration, action);
  add_calibrate(app, action);
  add_predict(app, configuration, action);
  add_replay(app, configuration, action);
  add_evaluate(app, configuration, action);
  add_simulate(app, action);
  add_record(app, configuration, action);
  add_import(app, action);
  add_export(app, configuration, action);
  add_serve(app, configuration, action);
  add_inspect(app, configuration, action);
  add_doctor(app, configuration, action);
  add_tags(app, action);
  add_keygen(app, action);
  add_robot_site(app, configuration, action);
  add_operator_site(app, configuration, action);
  add_plan(app, action);
  add_run(app, action);
  add_status(app, action);
  add_gather(app, action);
  add_survey(app, configuration, action);
  add_fuse(app, configuration, action);
  try {
    app.parse(reversed_words(given));
  } catch (const CLI::RequiredError& error) {
    // --print-config and --describe-commands need no arguments.
    if (!configuration_options.is_printed && !is_described) {
      return report_usage(app, error, has_json_flag(given));
    }
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error, has_json_flag(given));
  }
  if (configuration_options.error) return report_error(*configuration_options.error, as_json);
  if (is_described) return print(json_text(describe_command(app), 2) + '\n');
  if (configuration_options.is_printed) {
    return print(print_options(configuration.sections_of_command(full_name(invoked_command(app)))));
  }
  if (const auto empty = find_empty_value(app)) return report_error(*empty, as_json);
  set_report_command(command_of(given));
  return run(action, as_json);
}

}  // namespace

void add_sensor_option(CLI::App& command, std::string& camera_file) {
  command
      .add_option("--sensor", camera_file,
                  "Camera file with the sensor's depth noise (see calib/cameras)")
      ->transform(installed_calibration());
}

Expected<DepthNoise> depth_noise_of(const std::string& camera_file, const DepthNoise& configured) {
  if (camera_file.empty()) return configured;
  const Expected<CameraFile> sensor = read_camera_file(camera_file);
  if (!sensor) return sensor.error();
  if (!sensor->depth_noise) {
    return Error{.message = "the camera file has no depth noise",
                 .file = camera_file,
                 .place = "depth_noise",
                 .hint = "add it, or omit --sensor"};
  }
  return *sensor->depth_noise;
}

void add_threads_option(CLI::App& command, int& threads) {
  threads = Parallelism::max().threads;
  add_whole<int>(command, "--threads", threads, 1, kMaxThreads, "Number of threads")
      ->capture_default_str();
}

Expected<Recording> read_with_warnings(const std::string& folder, bool skip_bad,
                                       const Configuration& configuration,
                                       const Observer& observer) {
  ReadOptions options = configuration.reading;
  options.skip_bad = skip_bad;
  Expected<Recording> recording = read_recording(folder, options);
  if (!recording) return recording;
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  for (const std::string& note : recording->notes) observer.on_note(note);
  return recording;
}

void describe_left_out(const std::vector<SkippedRows>& left_out, CommandResult& result) {
  result.json["left_out"] = nlohmann::ordered_json::array();
  for (const auto& [file, reason, count] : left_out) {
    result.summary += fmt::format("skipped    {}: {}: {}\n", file, reason, count);
    result.json["left_out"].push_back({{"file", file}, {"reason", reason}, {"rows", count}});
  }
}

}  // namespace pcavr::app

int main(int argc, char** argv) {
  if (!pcavr::app::open_standard_descriptors()) return pcavr::app::kExitFailed;
  try {
    return pcavr::app::run_command_line(argc, argv);
  } catch (const std::exception& failure) {
    pcavr::wait_if_interrupted();
    const bool as_json = pcavr::app::has_json_flag({argv, static_cast<std::size_t>(argc)});
    return pcavr::app::report_error(pcavr::app::error_of(failure), as_json);
  }
}
