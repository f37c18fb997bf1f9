// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Runs the operator's and the robot's site over a recording, in virtual time and over a link with
// delay, jitter and loss, and prints the corrections that the robot's site sends. Only the masses
// are known; the rest is identified online.
//   08_correct_over_a_link RECORDING TRACKED
#include <cstdio>
#include <utility>

#include <pcavr/pipeline/identify.hpp>
#include <pcavr/teleoperation/teleop/run_teleop.hpp>

namespace {

pcavr::Expected<pcavr::TeleopInput> read_input(const char* folder, const char* tracked_folder) {
  const auto recording = pcavr::read_recording(folder);
  if (!recording) return recording.error();
  auto streams = pcavr::identification_input(*recording, {.tracked = tracked_folder});
  if (!streams) return streams.error();
  pcavr::TeleopInput input;  // the same series as for identification
  for (const pcavr::IdentifiableObject& object : streams->objects) {
    if (object.tracked.empty()) return pcavr::Error{.message = object.name + " was not tracked"};
    pcavr::ObjectParameters known;
    if (object.mass) known.mass = {*object.mass};
    const pcavr::Pose start = object.tracked.front().T_base_object;
    input.objects.push_back({object.name, object.model, start, known, object.tracked});
  }
  input.tool_radius = streams->tool_radius;
  input.t_tool = std::move(streams->t_tool);
  input.p_base_tip = std::move(streams->p_base_tip);
  input.t_force = std::move(streams->t_force);
  input.force_base = std::move(streams->force_base);
  return input;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: %s RECORDING TRACKED\n", argv[0]), 2;
  const auto input = read_input(argv[1], argv[2]);
  if (!input) return std::fprintf(stderr, "%s\n", input.error().to_string().c_str()), 1;
  pcavr::TeleopOptions options;
  options.forward_delay = options.backward_delay = 0.2;
  options.jitter = 0.01;
  options.loss = 0.3;
  options.seed = 2;
  const auto run = pcavr::run_teleop(*input, options);
  if (!run) return std::fprintf(stderr, "%s\n", run.error().to_string().c_str()), 1;
  for (const pcavr::SentCorrection& sent : run->corrections) {
    std::printf("%7.3f s  %s  case %-4s  %s, %zu bytes%s\n", sent.t,
                input->objects[sent.object].name.c_str(), std::string(name_of(sent.which)).c_str(),
                sent.what.c_str(), sent.bytes, sent.is_lost ? ", lost" : "");
  }
  std::printf("%zu corrections, %zu bytes; streaming would send %zu bytes\n", run->sent_corrections,
              run->correction_bytes, run->streaming_bytes);
}
