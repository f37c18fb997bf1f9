// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Each common mistake in a recording's inputs, injected into otherwise consistent observations.
#include <gtest/gtest.h>

#include "pipeline/checks/assess_consistency.hpp"
#include "pipeline/consistency_case.hpp"
#include "scene/scene_builder.hpp"

namespace pcavr {
namespace {

std::vector<ConsistencyFinding> findings_of(const ConsistencyCase& made,
                                            const Trajectory& groundtruth = {}) {
  Recording recording;
  recording.folder = "recording";
  recording.manifest = made.manifest;
  recording.groundtruth = groundtruth;
  for (const Stamp stamp : made.stamps) recording.frames.push_back({stamp, {}, stamp, {}});
  ConsistencyObservations seen;
  seen.tags = made.tags;
  return assess_consistency(recording, {}, seen, made.track, {});
}

/// The one finding, which is a contradiction of about this factor.
void expect_contradiction(const std::vector<ConsistencyFinding>& findings, const std::string& input,
                          double factor) {
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].input(), input);
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction) << findings[0].message;
  EXPECT_NEAR(findings[0].factor, factor, 0.02 * factor) << findings[0].message;  // the noise
}

template <typename Change>
Trajectory changed(const Trajectory& trajectory, const Change& change) {
  Trajectory result;
  for (const TimedPose& one : trajectory.poses()) result.append(one.stamp, change(one.pose));
  return result;
}

TEST(Consistency, FindsNothingWhereInputsAgree) {
  const ConsistencyCase made = a_consistency_case();
  EXPECT_TRUE(findings_of(made).empty());
  EXPECT_TRUE(findings_of(made, made.camera).empty());
}

TEST(Consistency, ToleratesTwoPercentOfDepthBiasAndOfPrinting) {
  ConsistencyCase made = a_consistency_case(0.02);
  for (MarkerEntry& marker : made.manifest.markers) marker.size *= 0.98;
  EXPECT_TRUE(findings_of(made, made.camera).empty());
}

TEST(Consistency, NamesTheOneTagWhoseSizeIsHalf) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers[0].size *= 0.5;
  const auto findings = findings_of(made);
  expect_contradiction(findings, "markers[0].size", 2.0);
  EXPECT_NE(findings[0].message.find("0.06 m across, but depth measures 0.12 m (factor 2.00"),
            std::string::npos)
      << findings[0].message;
  EXPECT_EQ(findings[0].hint, "check the printed size");
}

TEST(Consistency, NamesTheOneTagWhoseSizeIsInMillimetres) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers[1].size *= 1000.0;
  expect_contradiction(findings_of(made), "markers[1].size", 1000.0);
}

TEST(Consistency, NamesTheDepthScaleWhereAllTagsDisagreeAlike) {
  const ConsistencyCase made = a_consistency_case(4.0);
  const auto findings = findings_of(made);
  expect_contradiction(findings, "camera.depth_scale", 5.0);
  EXPECT_NE(findings[0].message.find("5000 units per metre, but 4 other inputs indicate about 2"),
            std::string::npos)
      << findings[0].message;
}

TEST(Consistency, NamesTagAndDepthScaleWhereOnlyOneTagIsSeen) {
  ConsistencyCase made = a_consistency_case(4.0);
  std::erase_if(made.tags, [](const TagMeasurement& tag) { return tag.marker != 0; });
  const auto findings = findings_of(made);
  expect_contradiction(findings, "markers[0].size", 5.0);
  EXPECT_EQ(findings[0].hint, "check the printed size or camera.depth_scale");
}

TEST(Consistency, DistinguishesOneTagAndTheDepthScaleByGroundtruth) {
  ConsistencyCase made = a_consistency_case(4.0);
  std::erase_if(made.tags, [](const TagMeasurement& tag) { return tag.marker != 0; });
  for (FramePlacement& frame : made.track.frames) {
    frame.T_segment_camera =
        Pose(frame.T_segment_camera.rotation(), 5.0 * frame.T_segment_camera.translation());
  }
  expect_contradiction(findings_of(made, made.camera), "camera.depth_scale", 5.0);
}

TEST(Consistency, WarnsBelowAFactorOfOneAndAHalf) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers[0].size *= 1.2;
  const auto findings = findings_of(made);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, FindingSeverity::warning);
  EXPECT_NEAR(findings[0].factor, 1.2, 0.02);
}

TEST(Consistency, NeedsThreeFramesOfAnObjectsTag) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers[1].size *= 0.5;
  std::erase_if(made.tags, [](const TagMeasurement& tag) { return tag.frame > 1; });
  EXPECT_TRUE(findings_of(made).empty());
}

TEST(Consistency, ComparesBaseTagsInAsFewFramesAsThereAre) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.markers[0].size *= 2.0;
  std::erase_if(made.tags,
                [](const TagMeasurement& tag) { return tag.frame > 1 && tag.marker == 0; });
  const auto findings = findings_of(made);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].place, "markers[0].size");
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
  // One of the two frames shows the size that is stated: the other may be misread.
  TagMeasurement& first = *std::find_if(made.tags.begin(), made.tags.end(),
                                        [](const TagMeasurement& tag) { return tag.marker == 0; });
  const Eigen::Vector3d centre = first.centre_camera();
  for (Eigen::Vector3d& corner : first.corners_camera) corner += corner - centre;
  EXPECT_TRUE(findings_of(made).empty());
}

TEST(Consistency, NamesFxByTheShapeOfTheTags) {
  ConsistencyCase made = a_consistency_case();
  made.manifest.camera->fx *= 0.5;
  for (TagMeasurement& tag : made.tags) {
    for (Eigen::Vector3d& corner : tag.corners_camera) corner.x() *= 2.0;
  }
  const auto findings = findings_of(made);
  expect_contradiction(findings, "camera.fx", 2.0);
  EXPECT_NE(findings[0].message.find("262.5 px, but"), std::string::npos) << findings[0].message;
}

TEST(Consistency, NamesBothFocalLengthsWhereTagsAreSeenAskew) {
  ConsistencyCase made = a_consistency_case();
  for (TagMeasurement& tag : made.tags) {
    for (Eigen::Vector3d& corner : tag.corners_camera) corner.head<2>() *= 2.0;
  }
  expect_contradiction(findings_of(made), "camera.fx, camera.fy", 2.0);
}

TEST(Consistency, NamesTheTagWithAWrongPose) {
  ConsistencyCase made = a_consistency_case();
  // The box's two tags become base tags, and the first one's pose is 0.5 m off.
  for (MarkerEntry& marker : made.manifest.markers) {
    if (marker.role == MarkerRole::base) continue;
    marker.role = MarkerRole::base;
    marker.object.clear();
    marker.T_parent_marker = Pose::from_translation({0.6, -0.1, 0.05}) * marker.T_parent_marker;
  }
  EXPECT_TRUE(findings_of(made).empty());
  Pose& pose = made.manifest.markers[0].T_parent_marker;
  pose = Pose(pose.rotation(), pose.translation() + Eigen::Vector3d(0.0, 0.5, 0.0));
  const auto findings = findings_of(made);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].place, "markers[0].pose") << findings[0].message;
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
}

// ---- groundtruth.txt

TEST(Consistency, NamesPosesThatAreAMetreOff) {
  const ConsistencyCase made = a_consistency_case();
  const auto findings = findings_of(made, changed(made.camera, [](const Pose& pose) {
                                      return Pose::from_translation({1.0, 0.0, 0.0}) * pose;
                                    }));
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].input(), "groundtruth.txt");
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
  EXPECT_NE(findings[0].message.find("the base tags lie 1 m from"), std::string::npos)
      << findings[0].message;
}

TEST(Consistency, ToleratesAHandEyeCalibrationsError) {
  const ConsistencyCase made = a_consistency_case();
  // 15 mm and 2 degrees, the error of an arm's commanded poses.
  const Pose error(Eigen::Quaterniond(Eigen::AngleAxisd(0.035, Eigen::Vector3d::UnitY())),
                   {0.015, 0.0, 0.0});
  EXPECT_TRUE(
      findings_of(made, changed(made.camera, [&](const Pose& pose) { return pose * error; }))
          .empty());
}

TEST(Consistency, NamesPosesInMillimetres) {
  const ConsistencyCase made = a_consistency_case();
  const auto findings = findings_of(made, changed(made.camera, [](const Pose& pose) {
                                      return Pose(pose.rotation(), 1000.0 * pose.translation());
                                    }));
  expect_contradiction(findings, "groundtruth.txt", 1000.0);
}

TEST(Consistency, NamesQuaternionsThatBeginWithW) {
  const ConsistencyCase made = a_consistency_case();
  const Trajectory given = changed(made.camera, [](const Pose& pose) {
    const Eigen::Quaterniond& q = pose.rotation();
    return Pose(Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), pose.translation());
  });
  for (const bool has_tags : {true, false}) {
    ConsistencyCase seen = made;
    if (!has_tags) seen.tags.clear();
    const auto findings = findings_of(seen, given);
    ASSERT_FALSE(findings.empty()) << has_tags;
    EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction) << findings[0].message;
    EXPECT_NE(findings[0].hint.find("qw qx qy qz"), std::string::npos) << findings[0].hint;
  }
}

TEST(Consistency, NamesPosesThatAreInverted) {
  const ConsistencyCase made = a_consistency_case();
  const auto findings =
      findings_of(made, changed(made.camera, [](const Pose& pose) { return pose.inverse(); }));
  ASSERT_TRUE(has_contradiction(findings));
  EXPECT_NE(findings[0].hint.find("inverted"), std::string::npos)
      << findings[0].message << "; " << findings[0].hint;
}

// ---- CAD bodies

/// A box of 0.16 x 0.16 x 0.1 m with a tag on its top and one on its side, as in the case above.
struct CadCase {
  ConsistencyCase made = a_consistency_case();
  CadModel model;

  std::vector<ConsistencyFinding> findings(float scale, const Eigen::Vector3f& shift = {0, 0, 0}) {
    TriangleMesh mesh = a_box({0.16F, 0.16F, 0.1F});
    for (Eigen::Vector3f& vertex : mesh.vertices) vertex = scale * (vertex + shift);
    model = make_cad_model(mesh, "box", "box.obj").value();
    return check_body(made.manifest, made.manifest.objects[0], model,
                      SurfaceQuery(model.mesh_object));
  }
};

TEST(ConsistencyOfABody, FindsNothingWhereItsTagsLieOnIt) {
  CadCase cad;
  cad.made.manifest.objects[0].mass = 3.0;
  EXPECT_TRUE(cad.findings(1.0F).empty());
}

TEST(ConsistencyOfABody, NamesAMeshInMillimetres) {
  CadCase cad;
  cad.made.manifest.objects[0].mass = 3.0;
  const auto findings = cad.findings(1000.0F);
  ASSERT_EQ(findings.size(), 3U);
  EXPECT_EQ(findings[0].place, "objects[0].mesh");
  EXPECT_EQ(findings[0].severity, FindingSeverity::contradiction);
  EXPECT_NE(findings[0].message.find("scaled by 0.001"), std::string::npos) << findings[0].message;
  EXPECT_NE(findings[1].message.find("160 x 160 x 100 m"), std::string::npos);
  EXPECT_NE(findings[2].message.find("which no material has"), std::string::npos);
}

TEST(ConsistencyOfABody, OnlyWarnsOfATagOnAMast) {
  CadCase cad;
  std::erase_if(cad.made.manifest.markers, [](const auto& marker) { return marker.id.id == 6; });
  cad.made.manifest.markers[1].T_parent_marker = Pose::from_translation({0.0, 0.0, 0.15});
  const auto findings = cad.findings(1.0F);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].severity, FindingSeverity::warning) << findings[0].message;
}

TEST(ConsistencyOfABody, FindsNoWrongUnitForATagNearAFrameOnTheBodysFace) {
  CadCase cad;
  // The frame lies on the bottom face, the tags 30 mm off the top and side faces.
  for (MarkerEntry& marker : cad.made.manifest.markers) {
    if (marker.id.id == 5) marker.T_parent_marker = Pose::from_translation({0.0, 0.0, 0.13});
    if (marker.id.id == 6) marker.T_parent_marker = Pose::from_translation({0.11, 0.0, 0.0});
  }
  for (const auto& finding : cad.findings(1.0F, {0, 0, 0.05F})) {
    EXPECT_EQ(finding.severity, FindingSeverity::warning) << finding.message;
  }
}

/// Depth of a box on a table, and the fit of a scaled mesh to it.
OutlineFit outline_fit(float mesh_scale) {
  const ConsistencyCase made = a_consistency_case();
  const CameraModel camera = made.manifest.camera->downsampled(4);
  const Pose T_base_box = Pose::from_translation({0.6, -0.1, 0.05});
  TriangleMesh box = a_box({0.16F, 0.16F, 0.1F});
  TriangleMesh scene = transformed(T_base_box, box);
  TriangleMesh table =
      transformed(Pose::from_translation({0.6, 0.0, -0.01}), a_box({4.0F, 4.0F, 0.02F}));
  const auto offset = static_cast<std::uint32_t>(scene.vertices.size());
  scene.vertices.insert(scene.vertices.end(), table.vertices.begin(), table.vertices.end());
  for (auto triangle : table.triangles) {
    for (std::uint32_t& vertex : triangle) vertex += offset;
    scene.triangles.push_back(triangle);
  }
  scene.normals.clear();
  scene.colors.clear();
  const SurfaceQuery surface(scene);
  for (Eigen::Vector3f& vertex : box.vertices) vertex *= mesh_scale;
  const SurfaceQuery scaled(box);
  OutlineFit fit;
  for (std::size_t i = 0; i < 4; ++i) {
    const Pose T_base_camera = made.camera.poses()[3 * i].pose;
    add_outline(scaled, T_base_camera.inverse() * T_base_box, camera,
                render_depth(surface, camera, T_base_camera), DepthNoise(), fit);
  }
  return fit;
}

TEST(ConsistencyOfABody, IsComparedWithTheDepthInItsOutline) {
  const ConsistencyCase made = a_consistency_case();
  const auto finding = [&](float scale) {
    return check_outline(made.manifest, made.manifest.objects[0], outline_fit(scale), 3);
  };
  EXPECT_FALSE(finding(1.0F));
  EXPECT_FALSE(finding(1.05F)) << "a slightly inaccurate CAD model";
  for (const float scale : {2.0F, 0.5F}) {
    const auto found = finding(scale);
    ASSERT_TRUE(found) << scale;
    EXPECT_EQ(found->severity, FindingSeverity::contradiction);
    EXPECT_DOUBLE_EQ(found->factor, 2.0);
  }
}

// ---- measurement

TEST(MeasureTag, PutsTheCornersOnThePlaneThatDepthShows) {
  const CameraModel camera{
      .width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  const Pose T_camera_tag(Eigen::Quaterniond(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitX())),
                          {0.1, -0.05, 0.9});
  const Eigen::Vector3d normal = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  const double offset = normal.dot(T_camera_tag.translation());
  DepthImage depth(640, 480);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const Eigen::Vector3d ray = camera.normalise({x, y}).homogeneous();
      const double z = offset / normal.dot(ray);
      // Every seventh reading is an outlier in front of the tag.
      depth(x, y) = static_cast<float>((x + 3 * y) % 7 == 0 ? 0.5 : z);
    }
  }
  TagDetection detection{.id = {"tag36h11", 0}, .corners = {}};
  const auto corners = tag_corners(0.1);
  for (std::size_t i = 0; i < 4; ++i) {
    detection.corners[i] = camera.project(T_camera_tag * corners[i]);
  }
  const auto tag = measure_tag(depth, camera, detection);
  ASSERT_TRUE(tag);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((tag->corners_camera[i] - T_camera_tag * corners[i]).norm(), 1e-4) << i;  // [m]
  }
  EXPECT_FALSE(measure_tag(DepthImage(640, 480), camera, detection)) << "without depth";
}

// ---- a scene without a surface

TEST(EmptyScene, NamesTheLikelyCause) {
  const DepthNoise noise;
  const CameraSteps still{.frames_used = 20, .translation = 0.01, .rotation = 0.01};
  const auto cause = [&](float z, const CameraSteps& steps) {
    DepthSummary depth;
    for (int i = 0; i < 20; ++i) depth.add(DepthImage(64, 48, z), noise);
    const EmptySceneCause found = explain_empty_scene(depth, noise, 1000.0, steps, 2.0);
    return found.message + "; " + found.hint;
  };
  const std::string too_near = cause(0.16F, still);
  EXPECT_NE(too_near.find("median depth is 0.16 m, and 0.0 % of the readings"), std::string::npos)
      << too_near;
  EXPECT_NE(too_near.find("depth_scale (1000"), std::string::npos) << too_near;
  const std::string one = cause(1.0F, {.frames_used = 1});
  EXPECT_NE(one.find("1 of 20 frames"), std::string::npos) << one;
  const std::string scattered = cause(1.0F, {.frames_used = 20, .translation = 30.0});
  EXPECT_NE(scattered.find("scattered"), std::string::npos) << scattered;
}

}  // namespace
}  // namespace pcavr
