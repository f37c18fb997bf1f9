// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Errors of a run against the ground truth of its simulated recording: ADD of the tracked and the
// predicted poses, at rest and moving. pcavr::evaluate() writes the whole report.
//   09_evaluate_a_run RUN RECORDING
#include <cstdio>
#include <filesystem>
#include <utility>

#include <pcavr/base/model/cad_model.hpp>
#include <pcavr/recordings/recording/recording.hpp>
#include <pcavr/results/evaluation/object_errors.hpp>

namespace {

void print(const std::string& name, const char* state, std::vector<double> errors) {
  const pcavr::ErrorStatistics add = pcavr::statistics(std::move(errors));
  std::printf("%s %s: ADD median %.2f mm, 95th percentile %.2f mm, max %.2f mm of %zu poses\n",
              name.c_str(), state, 1e3 * add.median, 1e3 * add.p95, 1e3 * add.max, add.count);
}

pcavr::Expected<void> evaluate(const std::filesystem::path& run,
                               const std::filesystem::path& recording_folder) {
  const auto recording = pcavr::read_recording(recording_folder);
  if (!recording) return recording.error();
  for (const pcavr::ObjectEntry& object : recording->manifest.objects) {
    const auto model = pcavr::read_cad_model(recording_folder / object.mesh, object.name);
    if (!model) return model.error();
    const pcavr::TriangleMesh& mesh_object = model->mesh_object;
    const auto truth =
        pcavr::read_trajectory(recording_folder / "truth/objects" / (object.name + ".txt"));
    if (!truth) return truth.error();
    for (const char* kind : {"tracked", "predicted"}) {
      const auto poses =
          pcavr::read_trajectory(run / "objects" / object.name / (std::string(kind) + ".txt"));
      if (!poses) return poses.error();
      const pcavr::ObjectErrors errors = pcavr::object_errors(mesh_object, *truth, *poses);
      std::vector<pcavr::Stamp> stamps;
      for (const pcavr::ModelError& pose : errors.poses) stamps.push_back(pose.stamp);
      const auto moves = pcavr::is_moving(*truth, mesh_object.vertices, stamps);
      std::vector<double> add[2];
      for (std::size_t i = 0; i < moves.size(); ++i) add[moves[i]].push_back(errors.poses[i].add);
      print(object.name + ' ' + kind, "at rest", std::move(add[0]));
      print(object.name + ' ' + kind, "moving", std::move(add[1]));
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: %s RUN RECORDING\n", argv[0]), 2;
  const auto done = evaluate(argv[1], argv[2]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().to_string().c_str());
  return done ? 0 : 1;
}
