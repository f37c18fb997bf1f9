// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/tracking/object_tracker.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tracking/object_scene.hpp"

namespace pcavr {
namespace {

using test::box_mesh;
using test::box_model;
using test::box_tags;
using test::box_tracker;
using test::kBoxSize;
using test::on_the_table;
using test::scene_camera;
using test::scene_camera_pose;
using test::SceneFrame;
using test::SceneRenderer;

constexpr double kDegree = 0.017453292519943295;

ObjectObservation track(ObjectTracker& tracker, const SceneFrame& scene) {
  return tracker.track(scene.frame, scene.detections, scene_camera_pose());
}

SceneFrame without_tags(SceneFrame scene) {
  scene.detections.clear();
  return scene;
}

double position_error(const ObjectObservation& observation, const Pose& T_base_box) {
  return translation_distance(observation.T_base_object, T_base_box);
}

TEST(ObjectTracker, HasNoPoseBeforeTheFirstTag) {
  SceneRenderer renderer(1);
  ObjectTracker tracker = box_tracker();
  const SceneFrame scene = renderer.frame_of_box(0, on_the_table(0, 0, 0.3));
  EXPECT_EQ(track(tracker, without_tags(scene)).evidence, ObjectEvidence::none);
}

// The project's requirement for a body at rest: 0.5 mm and 0.2 degrees.
TEST(ObjectTracker, AveragesABoxAtRest) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SceneRenderer renderer(seed);
    ObjectTracker tracker = box_tracker();
    const Pose T_base_box = on_the_table(0.03, -0.02, 0.4 * static_cast<double>(seed) - 1.0);
    ObjectObservation observation;
    for (int n = 0; n < 30; ++n) {
      observation = track(tracker, renderer.frame_of_box(n, T_base_box));
    }
    EXPECT_EQ(observation.evidence, ObjectEvidence::tags_and_shape);
    EXPECT_TRUE(observation.is_at_rest);
    EXPECT_LT(position_error(observation, T_base_box), 5e-4);
    EXPECT_LT(rotation_distance(observation.T_base_object, T_base_box), 0.2 * kDegree);
  }
}

TEST(ObjectTracker, RefinesTheTagsPoseWithDepth) {
  SceneRenderer renderer(2);
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  ObjectTrackerOptions tags_only;
  tags_only.refine_with_depth = false;
  ObjectTracker plain = box_tracker(tags_only);
  ObjectTracker refined = box_tracker();
  const SceneFrame scene = renderer.frame_of_box(0, T_base_box);
  const ObjectObservation by_tags = track(plain, scene);
  const ObjectObservation by_both = track(refined, scene);
  EXPECT_EQ(by_tags.evidence, ObjectEvidence::tags);
  EXPECT_EQ(by_tags.refinement_translation, 0.0);
  EXPECT_NEAR(by_both.refinement_translation,
              translation_distance(by_tags.T_base_object, by_both.T_base_object), 1e-12);
  EXPECT_GT(by_both.refinement_translation, 0.0);
  // 2 mm of noise and 1 mm of rounding.
  EXPECT_NEAR(by_both.surface_rms, 1.7e-3, 0.7e-3);
}

// A lag of one frame would be 3.3 mm.
TEST(ObjectTracker, FollowsAMovingBoxWithoutLag) {
  SceneRenderer renderer(3);
  ObjectTracker tracker = box_tracker();
  const Eigen::Vector3d velocity(0.0, 0.1, 0.0);  // [m/s]
  double lag = 0.0;
  int count = 0;
  for (int n = 0; n < 30; ++n) {
    const Pose T_base_box = on_the_table(0, -0.05 + 0.1 * n / 30.0, 0.2);
    const ObjectObservation observation = track(tracker, renderer.frame_of_box(n, T_base_box));
    EXPECT_LT(position_error(observation, T_base_box), 2e-3);
    if (n < 2) continue;
    EXPECT_FALSE(observation.is_at_rest) << n;
    lag += (T_base_box.translation() - observation.T_base_object.translation())
               .dot(velocity.normalized());
    ++count;
  }
  EXPECT_LT(std::abs(lag / count), 3e-4);
}

TEST(ObjectTracker, DetectsSlowSlidingDespiteAveraging) {
  SceneRenderer renderer(4);
  ObjectTracker tracker = box_tracker();
  for (int n = 0; n < 120; ++n) {
    const double displacement =
        std::max(0.0, 0.001 * (n - 30) / 30.0);  // 1 mm/s from the second second
    const Pose T_base_box = on_the_table(0, displacement, 0.2);
    EXPECT_LT(position_error(track(tracker, renderer.frame_of_box(n, T_base_box)), T_base_box),
              1e-3)
        << n;
  }
}

TEST(ObjectTracker, ResetsTheAverageAfterAPush) {
  SceneRenderer renderer(5);
  ObjectTracker tracker = box_tracker();
  Pose T_base_box = on_the_table(0, 0, 0.2);
  for (int n = 0; n < 20; ++n) (void)track(tracker, renderer.frame_of_box(n, T_base_box));
  T_base_box = on_the_table(0, 0.01, 0.2);
  ObjectObservation observation;
  for (int n = 20; n < 40; ++n) {
    observation = track(tracker, renderer.frame_of_box(n, T_base_box));
    EXPECT_LT(position_error(observation, T_base_box), 2e-3) << n;
  }
  EXPECT_TRUE(observation.is_at_rest);
  EXPECT_LT(position_error(observation, T_base_box), 5e-4);
}

TEST(ObjectTracker, TracksByShapeWhileTheTagsAreHidden) {
  SceneRenderer renderer(6);
  ObjectTracker tracker = box_tracker();
  for (int n = 0; n < 45; ++n) {
    const double y = n < 10 ? 0.0 : 0.05 * (n - 10) / 30.0;  // slides along its faces at 50 mm/s
    const Pose T_base_box = on_the_table(0, y, 0.1);
    const SceneFrame scene = renderer.frame_of_box(n, T_base_box);
    const bool is_hidden = n >= 5;
    const ObjectObservation observation = track(tracker, is_hidden ? without_tags(scene) : scene);
    EXPECT_EQ(observation.evidence,
              is_hidden ? ObjectEvidence::shape : ObjectEvidence::tags_and_shape);
    EXPECT_LT(position_error(observation, T_base_box), 3e-3) << n;
  }
}

// A sphere's rotation is unobservable: the last value is kept, with growing covariance.
TEST(ObjectTracker, KeepsAnUnobservableRotation) {
  TriangleMesh ball = box_mesh({1, 1, 1});
  for (int round = 0; round < 4; ++round) {
    TriangleMesh finer;
    for (const auto& [a, b, c] : ball.triangles) {
      const Eigen::Vector3f p = ball.vertices[a];
      const Eigen::Vector3f q = ball.vertices[b];
      const Eigen::Vector3f r = ball.vertices[c];
      const auto first = static_cast<std::uint32_t>(finer.vertices.size());
      for (const Eigen::Vector3f& v :
           {p, q, r, Eigen::Vector3f((p + q) / 2), Eigen::Vector3f((q + r) / 2),
            Eigen::Vector3f((r + p) / 2)}) {
        finer.vertices.push_back(0.06F * v.normalized());
      }
      for (const auto& [i, j, k] :
           {std::array<std::uint32_t, 3>{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
        finer.triangles.push_back({first + i, first + j, first + k});
      }
    }
    ball = finer;
  }
  ObjectTracker tracker(make_cad_model(ball, "ball", "ball").value(), {}, scene_camera());
  const Pose T_base_ball = on_the_table(0, 0, 0.7);
  tracker.set_initial_pose(T_base_ball);
  SceneRenderer renderer(7);
  double last_std = 0.0;
  for (int n = 0; n < 10; ++n) {
    const ObjectObservation observation =
        track(tracker, renderer.frame(n, {transformed(T_base_ball, ball)}));
    ASSERT_EQ(observation.evidence, ObjectEvidence::shape);
    EXPECT_LT(position_error(observation, T_base_ball), 2e-3);
    EXPECT_LT(rotation_distance(observation.T_base_object, T_base_ball), 5.0 * kDegree);
    const double rotation_std = std::sqrt(observation.covariance.bottomRightCorner<3, 3>().trace());
    EXPECT_GT(rotation_std, last_std);
    last_std = rotation_std;
  }
}

TEST(ObjectTracker, StartsByShapeFromAGivenPose) {
  SceneRenderer renderer(8);
  ObjectTracker tracker = box_tracker();
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  tracker.set_initial_pose(on_the_table(0.006, -0.005, 0.22));
  ObjectObservation observation;
  for (int n = 0; n < 5; ++n) {
    observation = track(tracker, without_tags(renderer.frame_of_box(n, T_base_box)));
  }
  EXPECT_EQ(observation.evidence, ObjectEvidence::shape);
  EXPECT_LT(position_error(observation, T_base_box), 2e-3);
}

TEST(ObjectTracker, ReportsLostIfTheBodyIsGone) {
  SceneRenderer renderer(9);
  ObjectTracker tracker = box_tracker();
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  for (int n = 0; n < 5; ++n) (void)track(tracker, renderer.frame_of_box(n, T_base_box));
  for (int n = 5; n < 10; ++n) {
    EXPECT_EQ(track(tracker, renderer.frame(n, {})).evidence, ObjectEvidence::none);
  }
  const Pose elsewhere = on_the_table(-0.1, 0.1, 1.0);
  const ObjectObservation found = track(tracker, renderer.frame_of_box(10, elsewhere));
  EXPECT_EQ(found.evidence, ObjectEvidence::tags_and_shape);
  EXPECT_LT(position_error(found, elsewhere), 3e-3);
}

TEST(ObjectTracker, UsesTheTagsAloneIfTheCadModelIsWrong) {
  for (const float scale : {0.8F, 1.2F}) {
    SceneRenderer renderer(10);
    ObjectTracker tracker(box_model(scale), box_tags(), scene_camera());
    const Pose T_base_box = on_the_table(0, 0, 0.2);
    const ObjectObservation observation = track(tracker, renderer.frame_of_box(0, T_base_box));
    EXPECT_EQ(observation.evidence, ObjectEvidence::tags) << scale;
    EXPECT_EQ(observation.refinement_translation, 0.0);
    EXPECT_LT(position_error(observation, T_base_box), 3e-3);
  }
}

TEST(ObjectTracker, UsesTheTagsAloneWithoutDepth) {
  SceneRenderer renderer(11);
  ObjectTracker tracker = box_tracker();
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  SceneFrame scene = renderer.frame_of_box(0, T_base_box);
  for (float& z : scene.frame.depth.pixels()) z = 0.0F;
  const ObjectObservation observation = track(tracker, scene);
  EXPECT_EQ(observation.evidence, ObjectEvidence::tags);
  EXPECT_LT(position_error(observation, T_base_box),
            8e-3);  // accuracy of the corners alone along the ray
}

// A bar in front of the box, which hides one tag and a third of the box.
TEST(ObjectTracker, IsNotBiasedByAnOccluder) {
  SceneRenderer renderer(12);
  ObjectTracker tracker = box_tracker();
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  const TriangleMesh box = transformed(T_base_box, box_mesh(kBoxSize));
  const TriangleMesh bar =
      transformed(Pose::from_translation({0.15, 0.0, 0.07}), box_mesh({0.02F, 0.3F, 0.14F}));
  ObjectObservation observation;
  for (int n = 0; n < 20; ++n) {
    SceneFrame scene = renderer.frame_of_box(n, T_base_box);
    scene.detections.pop_back();  // the tag on the side
    scene.frame.depth = renderer.frame(n, {box, bar}).frame.depth;
    observation = track(tracker, scene);
  }
  EXPECT_EQ(observation.evidence, ObjectEvidence::tags_and_shape);
  EXPECT_LT(observation.inlier_ratio, 0.95);
  EXPECT_LT(position_error(observation, T_base_box), 1e-3);
}

// All readings 4 mm too far: `depth_bias` limits their effect.
TEST(ObjectTracker, LimitsTheEffectOfABiasedSensor) {
  const Pose T_base_box = on_the_table(0, 0, 0.2);
  double errors[2] = {};
  for (const double bias : {0.0, 0.003}) {
    SceneRenderer renderer(13);
    renderer.depth_offset = 0.004;
    ObjectTrackerOptions options;
    options.depth_bias = bias;
    ObjectTracker tracker = box_tracker(options);
    ObjectObservation observation;
    for (int n = 0; n < 30; ++n) {
      observation = track(tracker, renderer.frame_of_box(n, T_base_box));
    }
    errors[bias > 0.0 ? 1 : 0] = position_error(observation, T_base_box);
  }
  EXPECT_GT(errors[0], 2.5e-3);
  EXPECT_LT(errors[1], 0.5 * errors[0]);
}

TEST(ObjectTracker, UsesTheTimestampsOfColorAndDepth) {
  SceneRenderer renderer(14);
  ObjectTracker tracker = box_tracker();
  double lag = 0.0;
  for (int n = 0; n < 30; ++n) {
    const auto at = [&](double t) { return on_the_table(0, -0.05 + 0.15 * t, 0.2); };
    SceneFrame scene = renderer.frame_of_box(n, at(n / 30.0));
    // The colour image is 15 ms later, when the box has moved 2.2 mm.
    scene.detections = renderer.frame_of_box(n, at(n / 30.0 + 0.015)).detections;
    scene.frame.color_stamp = Stamp::from_seconds(1.0 + n / 30.0 + 0.015);
    const ObjectObservation observation = track(tracker, scene);
    if (n >= 10) {
      lag += (at(n / 30.0).translation() - observation.T_base_object.translation()).y() / 20.0;
    }
  }
  EXPECT_LT(std::abs(lag), 5e-4);
}

TEST(ObjectTracker, IsDeterministic) {
  const auto run = [] {
    SceneRenderer renderer(15);
    ObjectTracker tracker = box_tracker();
    std::vector<double> numbers;
    for (int n = 0; n < 12; ++n) {
      const SceneFrame scene = renderer.frame_of_box(n, on_the_table(0, 0.001 * n, 0.2));
      const ObjectObservation observation =
          track(tracker, n % 4 == 3 ? without_tags(scene) : scene);
      const Eigen::Matrix4d matrix = observation.T_base_object.matrix();
      numbers.insert(numbers.end(), matrix.data(), matrix.data() + 16);
    }
    return numbers;
  };
  EXPECT_EQ(run(), run());
}

TEST(ObjectTracker, RejectsFramesThatGoBackInTime) {
  SceneRenderer renderer(16);
  ObjectTracker tracker = box_tracker();
  const SceneFrame scene = renderer.frame_of_box(3, on_the_table(0, 0, 0.2));
  (void)track(tracker, scene);
  EXPECT_THROW((void)track(tracker, scene), ContractError);
}

}  // namespace
}  // namespace pcavr
