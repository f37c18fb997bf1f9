// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// The whole pipeline in a few lines: from a recording to a scene on disk.
//   04_build_a_scene RECORDING SCENE
#include <cstdio>

#include <pcavr/base/core/output.hpp>
#include <pcavr/perception/scene/scene_bundle.hpp>
#include <pcavr/pipeline/build_scene.hpp>

namespace {

pcavr::Expected<void> build(const char* recording_folder, const char* scene_folder) {
  const auto recording = pcavr::read_recording(recording_folder);
  if (!recording) return recording.error();
  auto output = pcavr::OutputFolder::create(scene_folder);
  if (!output) return output.error();

  const pcavr::BuildOptions options(0.01);
  const auto scene = pcavr::build_scene(*recording, options);
  if (!scene) return scene.error();
  for (const pcavr::SceneObject& object : scene->objects) {
    if (object.evidence == pcavr::kNotSeen) {
      std::printf("%s was not seen\n", object.model.name.c_str());
      continue;
    }
    std::printf("%s at %.3f %.3f %.3f m\n", object.model.name.c_str(),
                object.T_base_object.translation().x(), object.T_base_object.translation().y(),
                object.T_base_object.translation().z());
  }
  const auto written = pcavr::write_scene(*scene, output->path(), options.parallelism);
  if (!written) return written;
  return output->commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: %s RECORDING SCENE\n", argv[0]), 2;
  const auto done = build(argv[1], argv[2]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().to_string().c_str());
  return done ? 0 : 1;
}
