// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Both sites' main loops in virtual time, with the simulated plant as the robot and a recorded
// motion as the operator: what bench/two_sites.py does with two processes, without the machine's
// load in it, and the same to the bit each time.
//   pcavr_bench_two_sites SCENE TRACE PLANT PLANT_SEED OUTPUT [--parameters FILE] [--seed N]
//                         [KEY=VALUE...]
// KEY: loss, burst, jitter, reorder or duplicate of a link with 0.2 s each way, or SECTION.KEY of
// the teleop options. Writes OUTPUT/robot.mcap and OUTPUT/truth, prints what both programs report.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/pipeline/plant_robot.hpp"
#include "pcavr/pipeline/teleop_input.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/simulation/simulate.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/operator_interface.hpp"

#include "arguments.hpp"
#include "sites/virtual_sites.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using bench::fail;
using bench::value_or_exit;

constexpr double kDelay = 0.2;        // [s] each way
constexpr double kRobotOffset = 3.0;  // [s] by which the two clocks differ
constexpr double kRobotDrift = 2e-5;

struct Arguments {
  fs::path scene;
  fs::path trace;
  std::string plant;
  std::uint64_t plant_seed = 1;
  fs::path output;
  ReplayOptions options;
  SimulatedNetwork network;
};

void set_condition(const std::string& key, double value, LinkConditions::Options& link) {
  const std::vector<std::pair<std::string, double*>> fields{{"loss", &link.loss},
                                                            {"burst", &link.burst},
                                                            {"jitter", &link.jitter},
                                                            {"reorder", &link.reorder},
                                                            {"duplicate", &link.duplicate}};
  for (const auto& [name, field] : fields) {
    if (name == key) *field = value;
  }
}

Arguments parse(std::span<char*> words) {
  if (words.size() < 6) {
    fail(
        "usage: pcavr_bench_two_sites SCENE TRACE PLANT PLANT_SEED OUTPUT [--parameters FILE] "
        "[--seed N] [KEY=VALUE...]");
  }
  Arguments arguments{words[1], words[2], words[3], std::stoull(words[4]), words[5], {}, {}};
  arguments.network.forward.delay = arguments.network.backward.delay = kDelay;
  for (std::size_t i = 6; i < words.size(); ++i) {
    const std::string word = words[i];
    if (word == "--parameters" && i + 1 < words.size()) {
      arguments.options.parameters = value_or_exit(read_parameters(words[++i]));
      arguments.options.parameters_file = words[i];
    } else if (word == "--seed" && i + 1 < words.size()) {
      arguments.network.seed = std::stoull(words[++i]);
    } else if (word.find('.') < word.find('=')) {
      bench::set_option(sections_of(arguments.options.teleop), word);
    } else if (word.find('=') != std::string::npos) {
      const std::size_t equals = word.find('=');
      const double value = std::stod(word.substr(equals + 1));
      set_condition(word.substr(0, equals), value, arguments.network.forward);
      set_condition(word.substr(0, equals), value, arguments.network.backward);
    } else {
      fail("unknown argument " + word);
    }
  }
  return arguments;
}

ToolTask task_of(const std::string& name) {
  for (const SimulationCase& one : simulation_cases()) {
    if (one.name == name) return one.task;
  }
  fail(name + " is not a case of pcavr simulate");
}

SiteScene site_scene_of(const TeleopInput& world) {
  SiteScene scene{.name = "bench",
                  .version = "bench",
                  .objects = {},
                  .tool_radius = world.tool_radius,
                  .T_base_objects = {}};
  for (const TeleopObject& object : world.objects) {
    scene.objects.push_back(object.name);
    scene.T_base_objects.push_back(object.T_base_object);
  }
  return scene;
}

struct Reports {
  RobotSiteReport robot;
  OperatorSiteReport person;
};

Reports run(const Arguments& arguments, TeleopInput& world, const TeleopInput& trace,
            PlantRobot& plant, BlackBox& black_box) {
  const TeleopOptions& teleop = arguments.options.teleop;
  const SiteScene scene = site_scene_of(world);
  RobotSiteOptions robot_options;
  const OperatorSiteOptions operator_options;
  const Observer observer;
  LiveRobotSite site = value_or_exit(LiveRobotSite::create(world, teleop, 0.0));
  const auto person = value_or_exit(make_recorded_operator(trace, teleop));
  Wire wire;
  WireServer server(wire);
  double t = 0.0;
  WireClient client(wire, t);
  std::uint32_t sessions = 0;
  SiteProcess<RobotSiteReport> robot_site{.rate = 1.0 + kRobotDrift};
  SiteProcess<OperatorSiteReport> operator_site;
  robot_site.steps =
      make_robot_site_steps(server, plant, site, scene, robot_options, observer,
                            {.clock = [&t] { return kRobotOffset + (1.0 + kRobotDrift) * t; },
                             .new_session = {},
                             .prepares_at_once = true,
                             .log = &black_box.log()});
  operator_site.steps = make_operator_site_steps(client, *person, trace, teleop, scene,
                                                 operator_options, arguments.network, observer,
                                                 {.clock = [&t] { return t; },
                                                  .new_session = [&sessions] { return ++sessions; },
                                                  .prepares_at_once = true,
                                                  .log = nullptr});
  run_in_virtual_time(robot_site, operator_site, wire, t,
                      [&] { return operator_site.steps->is_finished(); });
  return {value_or_exit(robot_site.steps->finish()), value_or_exit(operator_site.steps->finish())};
}

nlohmann::ordered_json json_of(const Reports& reports) {
  nlohmann::ordered_json corrections = nlohmann::ordered_json::array();
  for (const SentCorrection& sent : reports.robot.corrections) {
    corrections.push_back({{"t", sent.t},
                           {"object", sent.object},
                           {"case", std::string(name_of(sent.which))},
                           {"what", sent.what},
                           {"bytes", sent.bytes}});
  }
  nlohmann::ordered_json robot{{"sessions", reports.robot.sessions},
                               {"correction_bytes", reports.robot.correction_bytes},
                               {"streaming_bytes", reports.robot.streaming_bytes},
                               {"max_correction_cpu_s", reports.robot.max_correction_time},
                               {"corrections", std::move(corrections)}};
  if (const auto& response = reports.robot.tool_response) {
    robot["tool_compliance_m_per_n"] = response->compliance;
    robot["tool_rate_rad_s"] = response->rate;
    robot["tool_damping_ratio"] = response->damping_ratio;
  }
  return {{"robot", std::move(robot)},
          {"operator",
           {{"sessions", reports.person.sessions},
            {"corrections", reports.person.corrections},
            {"lead_s", reports.person.lead}}}};
}

int bench_two_sites(std::span<char*> words) {
  const Arguments arguments = parse(words);
  const SceneManifest scene = value_or_exit(read_scene_manifest(arguments.scene));
  TeleopInput world = value_or_exit(read_teleop_world(scene, arguments.options));
  TeleopInput trace = world;
  add_tool_motion(value_or_exit(read_recording(arguments.trace)), trace);
  const auto plant =
      value_or_exit(make_plant_robot(task_of(arguments.plant), arguments.plant_seed, world,
                                     arguments.options.teleop.pose.tracking_latency));
  plant->keep_truth();
  fs::create_directories(arguments.output / "truth");
  BlackBoxOptions black_box_options;
  black_box_options.queue_size = 256.0;  // virtual time is faster than a disk
  const auto black_box = value_or_exit(
      BlackBox::create(arguments.output / "robot.mcap", site_scene_of(world), black_box_options));
  const Reports reports = run(arguments, world, trace, *plant, *black_box);
  const BlackBox::Summary written = value_or_exit(black_box->close());
  if (written.dropped > 0) fail("the log is not complete");
  const Expected<void> truth = plant->write_truth(arguments.output / "truth");
  if (!truth) fail(truth.error().to_string());
  fmt::print("{}\n", json_of(reports).dump());
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace pcavr

int main(int argc, char** argv) {
  return pcavr::bench_two_sites({argv, static_cast<std::size_t>(argc)});
}
