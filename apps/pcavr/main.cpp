// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <exception>
#include <iostream>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/core/signal_cleanup.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/option_file.hpp"

#include "commands.hpp"
#include "failure.hpp"
#include "number_option.hpp"

#ifndef PCAVR_VERSION
#error "PCAVR_VERSION is set by the build"
#endif

namespace pcavr::app {
namespace {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
constexpr int kExitDisagreement = 3;
constexpr std::size_t kMaxCommand = 32;  ///< characters: no command is as long
constexpr int kMaxThreads = 256;         ///< above the machines that pcavr was tested on

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
  std::fprintf(stderr, "pcavr: %s\n", error.to_string().c_str());
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
  return result->has_disagreement ? kExitDisagreement : kExitDone;
}

/// Needed for errors before the command line is parsed, and for exceptions.
bool has_json_flag(std::span<char* const> arguments) {
  return std::any_of(arguments.begin(), arguments.end(),
                     [](const char* argument) { return std::string_view(argument) == "--json"; });
}

/// The name by which help on the invoked command is asked for.
std::string invoked(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* command : app.get_subcommands()) name += ' ' + invoked(*command);
  return name;
}

/// The first word in place of a command, which CLI11 reports as a missing one, and not at all
/// where help is asked for; else empty.
std::string unknown_command(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining();
  const auto word = std::find_if(words.begin(), words.end(),
                                 [](const std::string& each) { return !each.starts_with('-'); });
  return app.get_subcommands().empty() && word != words.end() ? *word : std::string();
}

/// Number of characters to insert, remove or replace to turn one into the other [Levenshtein 1966].
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// The command that was probably meant; empty if none is similar.
std::string nearest_command(const CLI::App& app, const std::string& word) {
  std::string nearest;
  std::size_t fewest = 3;  // edits: beyond two it is another word
  if (word.size() > kMaxCommand) return nearest;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::size_t edits = edits_between(word, command->get_name());
    if (edits >= std::min(fewest, command->get_name().size())) continue;
    fewest = edits;
    nearest = command->get_name();
  }
  return nearest;
}

/// Help and version are printed, too; returns the exit code.
int report_usage(const CLI::App& app, const CLI::ParseError& error, bool as_json) {
  std::string hint = "see " + invoked(app) + " --help";
  const bool is_version = dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr;
  const std::string unknown = is_version ? std::string() : unknown_command(app);
  if (!unknown.empty()) {
    const std::string nearest = nearest_command(app, unknown);
    if (!nearest.empty()) hint = "did you mean " + nearest + "? " + hint;
    return report_error({.message = "unknown command '" + unknown + "'", .hint = hint}, as_json,
                        kExitUsage);
  }
  if (error.get_exit_code() == kExitDone) return app.exit(error);
  return report_error({.message = error.what(), .hint = hint}, as_json, kExitUsage);
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
  add_import(app, action);
  add_export(app, configuration, action);
  add_serve(app, configuration, action);
  add_inspect(app, configuration, action);
  add_doctor(app, configuration, action);
  add_tags(app, action);
  add_keygen(app, action);
  add_robot_site(app, configuration, action);
  add_operator_site(app, configuration, action);
  try {
    app.parse(reversed_words(given));
  } catch (const CLI::RequiredError& error) {
    // --print-config needs no arguments.
    if (!configuration_options.is_printed) return report_usage(app, error, has_json_flag(given));
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error, has_json_flag(given));
  }
  if (configuration_options.error) return report_error(*configuration_options.error, as_json);
  if (configuration_options.is_printed) return print(print_options(configuration.sections()));
  if (const auto empty = find_empty_value(app)) return report_error(*empty, as_json);
  return run(action, as_json);
}

}  // namespace

void add_sensor_option(CLI::App& command, std::string& camera_file) {
  command.add_option("--sensor", camera_file,
                     "Camera file with the sensor's depth noise (see calib/cameras)");
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
