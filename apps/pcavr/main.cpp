// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <iostream>

#include "pcavr/core/parallel.hpp"
#include "pcavr/core/signal_cleanup.hpp"
#include "pcavr/recording/camera_file.hpp"

#include "commands.hpp"

#ifndef PCAVR_VERSION
#error "PCAVR_VERSION is set by the build"
#endif

namespace pcavr::app {
namespace {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

int report_error(const std::string& line) {
  std::fprintf(stderr, "pcavr: %s\n", line.c_str());
  return kExitFailed;
}

int run(const Action& action, bool as_json) {
  Console console;
  install_signal_cleanup();
  const Expected<CommandResult> result = action(console.observer());
  wait_if_interrupted();
  if (!result) return report_error(result.error().to_string());
  if (as_json) {
    std::cout << json_text(result->json, 2);
  } else {
    std::cout << result->summary;
  }
  std::cout.flush();
  if (!std::cout) return report_error("standard output: can't be written");
  return result->is_failure ? kExitFailed : kExitDone;
}

int run_command_line(int argc, char** argv) {
  CLI::App app("Point-cloud augmented VR scenes from recorded depth frames, in the robot's base.");
  app.set_version_flag("--version", "pcavr " PCAVR_VERSION);
  app.name("pcavr");
  app.require_subcommand(1);
  app.fallthrough();
  bool as_json = false;
  app.add_flag("--json", as_json, "Print one machine-readable result on standard output");

  Action action;
  add_build(app, action);
  add_identify(app, action);
  add_replay(app, action);
  add_evaluate(app, action);
  add_simulate(app, action);
  add_import(app, action);
  add_serve(app, action);
  add_inspect(app, action);
  add_tags(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  return run(action, as_json);
}

}  // namespace

void add_sensor_option(CLI::App& command, std::string& camera_file) {
  command.add_option("--sensor", camera_file,
                     "Camera file that tells the sensor's depth noise (see calib/cameras)");
}

Expected<DepthNoise> depth_noise_of(const std::string& camera_file) {
  if (camera_file.empty()) return DepthNoise{};
  const Expected<CameraFile> sensor = read_camera_file(camera_file);
  if (!sensor) return sensor.error();
  if (!sensor->depth_noise) {
    return Error{.message = "says nothing of the depth noise",
                 .file = camera_file,
                 .place = "depth_noise",
                 .hint = "add it, or leave --sensor away"};
  }
  return *sensor->depth_noise;
}

void add_threads_option(CLI::App& command, int& threads) {
  threads = Parallelism::max().threads;
  command.add_option("--threads", threads, "How many threads to use")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
}

}  // namespace pcavr::app

int main(int argc, char** argv) {
  try {
    return pcavr::app::run_command_line(argc, argv);
  } catch (const std::exception& error) {
    pcavr::wait_if_interrupted();
    return pcavr::app::report_error(std::string("internal error: ") + error.what() +
                                    "; please report it with the command that you ran");
  }
}
