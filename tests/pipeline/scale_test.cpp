// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Many objects, and images of other sizes than 640 x 480, through the whole pipeline on small
// recordings.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"
#include "pcavr/simulation/simulate.hpp"

#include "pipeline/build/follow_objects.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// Frames of a hand-held camera around a table.
SimulationCase table_case(int boxes, int frames) {
  SimulationCase simulation;
  simulation.movable_boxes = boxes;
  simulation.clutter = 0;
  simulation.frame_rate = 20.0;
  simulation.duration = frames / simulation.frame_rate;
  return simulation;
}

Recording simulated(const SimulationCase& simulation, std::uint64_t seed,
                    const TemporaryFolder& folder) {
  EXPECT_TRUE(simulate(simulation, seed, folder.path(), {2}));
  return read_recording(folder.path()).value();
}

Pose truth_of(const Recording& recording, const std::string& object) {
  const auto path = recording.folder / "truth/objects" / (object + ".txt");
  return read_trajectory(path).value().poses().front().pose;
}

/// Every box on the table is detected, with a pose within the given error bounds.
void expect_placed(const Recording& recording, const Scene& scene, double max_shift,
                   double max_turn) {
  ASSERT_EQ(scene.objects.size(), recording.manifest.objects.size());
  for (const SceneObject& object : scene.objects) {
    const Pose truth = truth_of(recording, object.model.name);
    EXPECT_NE(object.evidence, "not_seen") << object.model.name;
    EXPECT_LT(translation_distance(object.T_base_object, truth), max_shift) << object.model.name;
    EXPECT_LT(rotation_distance(object.T_base_object, truth), max_turn) << object.model.name;
  }
}

TEST(ManyObjects, TwentyAreDetectedTrackedAndMasked) {
  const TemporaryFolder folder;
  const Recording recording = simulated(table_case(20, 6), 1, folder);
  const Expected<std::vector<DeclaredBody>> bodies = load_movable_bodies(recording, {});
  ASSERT_TRUE(bodies);
  const SurveyOptions options{.parallelism = {2}};
  const Expected<Survey> survey = survey_recording(recording, *bodies, options, {});
  ASSERT_TRUE(survey) << survey.error().to_string();
  const CameraModel& camera = *recording.manifest.camera;
  std::vector<int> tracked_frames(bodies->size());
  std::vector<double> squares(bodies->size());
  const auto done =
      follow_objects(recording, *bodies, *survey, options, {}, [&](const FollowedFrame& frame) {
        for (std::size_t i = 0; i < bodies->size(); ++i) {
          const Pose truth = truth_of(recording, (*bodies)[i].entry.name);
          const ObjectObservation& seen = frame.objects[i];
          if (seen.evidence == ObjectEvidence::none) continue;
          ++tracked_frames[i];
          squares[i] += std::pow(translation_distance(seen.T_base_object, truth), 2);
          // The middle of the top, where it is in view, belongs to the body and is masked.
          const Eigen::Vector2d pixel =
              camera.project(frame.T_base_camera.inverse() * truth.translation());
          if (!camera.contains(pixel)) continue;
          EXPECT_NE(frame.is_dynamic(static_cast<int>(std::lround(pixel.x())),
                                     static_cast<int>(std::lround(pixel.y()))),
                    0)
              << (*bodies)[i].entry.name;
        }
      });
  ASSERT_TRUE(done) << done.error().to_string();
  for (std::size_t i = 0; i < bodies->size(); ++i) {
    EXPECT_EQ(tracked_frames[i], 6) << (*bodies)[i].entry.name;
    // A single frame, boxes of 9 cm at 1.1 m: some millimetres.
    EXPECT_LT(std::sqrt(squares[i] / 6.0), 0.004) << (*bodies)[i].entry.name;
  }
}

TEST(ManyObjects, HaveTexturesWithinTheBoundOfAllUntilItIsUsed) {
  const TemporaryFolder folder;
  const Recording recording = simulated(table_case(20, 4), 1, folder);
  BuildOptions options(0.01, {2});
  options.texture.atlas_width = 256;
  options.texture.atlas_height = 256;
  options.texture.bodies_edge = 128;  // four of 64
  const Expected<Scene> scene = build_scene(recording, options);
  ASSERT_TRUE(scene) << scene.error().to_string();
  ASSERT_TRUE(scene->texture);
  int used = scene->texture->width * scene->texture->height;
  int with_texture = 0;
  for (const SceneObject& object : scene->objects) {
    if (!object.texture) continue;
    ++with_texture;
    used += object.texture->width * object.texture->height;
  }
  EXPECT_GE(with_texture, 4);
  EXPECT_LT(with_texture, 20);
  EXPECT_LE(used, 256 * 256);
}

// Ten times the bodies; the number of rays grows most with them.
TEST(ManyObjects, TwentyCastAtMostThreeAndAHalfTimesTheRaysOfTwoInAFrame) {
  const int max_samples = ObjectTrackerOptions{}.max_samples;
  EXPECT_EQ(samples_per_body(1, max_samples), max_samples);
  EXPECT_EQ(samples_per_body(1, 100), 100);
  EXPECT_EQ(samples_per_body(6, max_samples), max_samples);
  EXPECT_LE(20 * samples_per_body(20, max_samples), 3.5 * 2 * samples_per_body(2, max_samples));
  EXPECT_GE(samples_per_body(200, max_samples), 100);  // a tracker's minimum
}

TEST(ImageSize, ABoxIsPlacedInImagesOf1280x720) {
  SimulationCase simulation = table_case(1, 3);
  simulation.width = 1280;
  simulation.height = 720;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 4, folder);
  const Expected<Scene> scene = build_scene(recording, BuildOptions(0.01, {2}));
  ASSERT_TRUE(scene) << scene.error().to_string();
  EXPECT_EQ(scene->quality.frames_used, 3U);
  EXPECT_GT(scene->mesh_base.triangles.size(), 1000U);
  expect_placed(recording, *scene, 0.003, 0.01);
}

TEST(ImageSize, ABoxIsPlacedWhereDepthIsSmallerThanColour) {
  // Depth is smaller by a whole factor, and by 1.6.
  for (const auto& [width, height] : {std::pair(320, 240), {400, 300}}) {
    SimulationCase simulation = table_case(1, 4);
    simulation.depth_width = width;
    simulation.depth_height = height;
    const TemporaryFolder folder;
    const Recording recording = simulated(simulation, 4, folder);
    const Expected<Scene> scene = build_scene(recording, BuildOptions(0.01, {2}));
    ASSERT_TRUE(scene) << scene.error().to_string();
    EXPECT_EQ(scene->quality.frames_used, 4U);
    EXPECT_GT(scene->mesh_base.triangles.size(), 1000U);
    // The sensor's noise is 2 to 3 mm; a grid that is half a pixel off would show here: 2 mm.
    EXPECT_LT(scene->quality.surface_rms.value(), 0.004);
    expect_placed(recording, *scene, 0.003, 0.01);
  }
}

TEST(ImageSize, TheSameBytesAtAnyNumberOfThreadsWithSmallerDepth) {
  SimulationCase simulation = table_case(1, 3);
  simulation.depth_width = 320;
  simulation.depth_height = 240;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 5, folder);
  const Expected<Scene> one = build_scene(recording, BuildOptions(0.01, {1}));
  const Expected<Scene> two = build_scene(recording, BuildOptions(0.01, {2}));
  ASSERT_TRUE(one);
  ASSERT_TRUE(two);
  EXPECT_EQ(one->mesh_base.vertices, two->mesh_base.vertices);
  EXPECT_TRUE(std::ranges::equal(one->mesh_base.colors, two->mesh_base.colors));
}

TEST(ImageSize, DepthOfAnotherAspectRatioOrOfTwoSizesIsRejected) {
  SimulationCase simulation = table_case(0, 3);
  simulation.width = 96;
  simulation.height = 72;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 1, folder);
  simulation.depth_width = 48;
  simulation.depth_height = 36;
  const TemporaryFolder smaller;
  const Recording half = simulated(simulation, 1, smaller);

  Recording mixed = recording;
  std::filesystem::copy_file(smaller.path() / half.frames[1].depth_path,
                             folder.path() / recording.frames[1].depth_path,
                             std::filesystem::copy_options::overwrite_existing);
  const Expected<Scene> two_sizes = build_scene(mixed, {});
  ASSERT_FALSE(two_sizes);
  EXPECT_NE(two_sizes.error().to_string().find("48 x 36 pixels; the first depth image is 96 x 72"),
            std::string::npos)
      << two_sizes.error().to_string();

  // An image of another aspect ratio can't be this camera's depth, whatever its size.
  RecordingWriter writer(folder.path(), recording.manifest);
  const Stamp later = Stamp::from_seconds(10.0);
  ASSERT_TRUE(writer.add_frame(later, ColorImage(96, 72), later, DepthImage(48, 40, 1.0F)));
  ASSERT_TRUE(writer.finish());
  const Expected<Scene> shape = build_scene(read_recording(folder.path()).value(), {});
  ASSERT_FALSE(shape);
  EXPECT_NE(shape.error().to_string().find(
                "is 48 x 40 pixels, not 96 x 72 nor smaller than that by one factor"),
            std::string::npos)
      << shape.error().to_string();
}

}  // namespace
}  // namespace pcavr
