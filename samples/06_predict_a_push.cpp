// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Predicts the objects from the tool's motion alone, in cycles of 1 ms. Twice a second a tracked
// pose arrives, 0.4 s old: rollback to its time and re-simulation of the present.
#include <cstdio>

#include <pcavr/physics/identification/path_view.hpp>
#include <pcavr/physics/object/parameters_file.hpp>
#include <pcavr/physics/prediction/predictor.hpp>
#include <pcavr/pipeline/identify.hpp>

namespace {

pcavr::Expected<void> predict(char** argv) {
  const auto recording = pcavr::read_recording(argv[1]);
  if (!recording) return recording.error();
  const auto input = pcavr::identification_input(*recording, {.tracked = argv[2]});
  if (!input) return input.error();
  auto known = pcavr::read_parameters(argv[3]);
  if (!known) return known.error();
  pcavr::WorldModel model{{}, {}, input->tool_radius};
  for (const pcavr::IdentifiableObject& object : input->objects) {
    if (object.tracked.empty()) return pcavr::Error{.message = object.name + " was not tracked"};
    const pcavr::Pose& start = object.tracked.front().T_base_object;
    model.bodies.push_back({object.model, start,
                            complete_physics((*known)[object.name], object.model, start).physics});
  }
  auto world = pcavr::PredictedWorld::create(std::move(model));
  if (!world) return world.error();
  const pcavr::PathView path(input->t_tool, input->p_base_tip);
  pcavr::Predictor predictor(std::move(*world), input->t_tool.front(), input->p_base_tip.front());
  for (int cycle = 1; predictor.now() < input->t_tool.back(); ++cycle) {
    predictor.step(path.at(predictor.now() + 0.001));
    if (cycle % 500 != 0) continue;
    const double now = predictor.now();
    for (std::size_t i = 0; i < input->objects.size(); ++i) {
      const pcavr::IdentifiableObject& object = input->objects[i];
      const pcavr::ShownBody shown = predictor.shown(i);
      const pcavr::Pose old = predictor.world().T_base_object(i);
      predictor.correct({now - 0.4, i, pose_at(object.tracked, now - 0.4)});
      if (shown.phase == pcavr::MotionPhase::free) continue;
      std::printf("%6.2f s  %s %-8s  %5.2f N, error %.2f mm, corrected by %.2f mm\n", now,
                  object.name.c_str(), std::string(name_of(shown.phase)).c_str(),
                  shown.force_base.norm(),
                  1e3 * translation_distance(old, pose_at(object.tracked, now)),
                  1e3 * translation_distance(old, predictor.world().T_base_object(i)));
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::puts("usage: 06_predict_a_push RECORDING TRACKED PARAMETERS"), 2;
  const auto done = predict(argv);
  if (!done) std::fprintf(stderr, "%s\n", done.error().to_string().c_str());
  return done ? 0 : 1;
}
