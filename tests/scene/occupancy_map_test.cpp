// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/occupancy_map.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "scene/scene_builder.hpp"
#include "support/octomap_reference.hpp"
#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using Cell = OccupancyMap::Cell;

Pose a_pose(Random& random) {
  const Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0.0, 3.0), axis.normalized())),
              {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)});
}

/// Slanted walls with noise and holes, partly beyond the range.
DepthImage a_rough_image(Random& random, const CameraModel& camera) {
  DepthImage depth(camera.width, camera.height);
  const double near = random.uniform(0.5, 3.0);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (random.uniform() < 0.1) continue;
      const double z = near + 0.02 * u + (v > 60 ? 0.5 : 0.0) + 0.01 * random.normal();
      depth(u, v) = static_cast<float>(z);
    }
  }
  return depth;
}

OccupancyOptions with(double OccupancyOptions::*member, double value) {
  OccupancyOptions options;
  options.*member = value;
  return options;
}

TEST(OccupancyMap, AgreesWithOctomapOnRoughWallsFromAnywhere) {
  OccupancyOptions options = with(&OccupancyOptions::resolution, 0.05);
  options.max_range = 3.0;
  const CameraModel camera = a_small_camera();
  OccupancyMap ours(options);
  octomap::OcTree theirs = octomap_with(options);
  Random random(7);
  for (int frame = 0; frame < 5; ++frame) {
    const Pose T_base_camera = a_pose(random);
    const DepthImage depth = a_rough_image(random, camera);
    ours.integrate(depth, {}, camera, T_base_camera);
    insert(cloud_base_of(depth, camera, T_base_camera), T_base_camera, options, theirs);
  }
  const CellAgreement agreement = compare(ours, theirs);
  EXPECT_GT(agreement.known, 20'000U);
  // OctoMap computes in single precision: a ray through an edge may pass on its other side.
  EXPECT_GT(agreement.share(), 0.999);
}

TEST(OccupancyMap, AgreesWithOctomapOnARecording) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  const auto recording = read_recording(shared_data("tabletop"));
  ASSERT_TRUE(recording) << recording.error().to_string();
  const auto truth = read_trajectory(shared_data("tabletop/truth/camera.txt"));
  ASSERT_TRUE(truth) << truth.error().to_string();
  const OccupancyOptions options;
  OccupancyMap ours(options);
  octomap::OcTree theirs = octomap_with(options);
  for (const std::size_t i : {0U, 60U, 119U}) {
    const auto frame = decode_frame(*recording, i);
    ASSERT_TRUE(frame) << frame.error().to_string();
    const auto pose = truth->at(frame->depth_stamp);
    ASSERT_TRUE(pose.has_value());
    const CameraModel& camera = *recording->manifest.camera;
    ours.integrate(frame->depth, {}, camera, *pose);
    insert(cloud_base_of(frame->depth, camera, *pose), *pose, options, theirs);
  }
  EXPECT_GT(compare(ours, theirs).share(), 0.999);
}

/// One measurement on the optical axis of a camera at base's origin that looks along z.
OccupancyMap after_measurements(std::initializer_list<float> measurements) {
  OccupancyMap map(with(&OccupancyOptions::resolution, 0.1));
  const CameraModel camera{.width = 1, .height = 1, .fx = 1.0, .fy = 1.0};
  for (const float z : measurements) {
    map.integrate(DepthImage(1, 1, z), {}, camera, Pose::from_translation({0.05, 0.05, 0.05}));
  }
  return map;
}

TEST(OccupancyMap, MarksTraversedCellsFreeAndHitsOccupied) {
  const OccupancyMap map = after_measurements({1.0F});
  EXPECT_EQ(map.at({0.05, 0.05, 0.05}), Cell::free);
  EXPECT_EQ(map.at({0.05, 0.05, 0.95}), Cell::free);
  EXPECT_EQ(map.at({0.05, 0.05, 1.05}), Cell::occupied);
  EXPECT_EQ(map.at({0.05, 0.05, 1.15}), Cell::unknown);
  EXPECT_EQ(map.at({0.15, 0.05, 0.55}), Cell::unknown);
  EXPECT_EQ(map.counts().free, 10U);
  EXPECT_EQ(map.counts().occupied, 1U);
}

TEST(OccupancyMap, FreesAHitThatLaterRaysTraverse) {
  // One hit (+0.85) outweighs two misses (-0.81), and not three.
  EXPECT_EQ(after_measurements({1.0F, 2.0F, 2.0F}).at({0.05, 0.05, 1.05}), Cell::occupied);
  EXPECT_EQ(after_measurements({1.0F, 2.0F, 2.0F, 2.0F}).at({0.05, 0.05, 1.05}), Cell::free);
}

TEST(OccupancyMap, ClampingKeepsTheMapAdaptable) {
  // Three hits (+2.54) make it occupied after any number of misses (clamped at -2).
  EXPECT_EQ(after_measurements({2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 2, 1, 1, 1}).at({0.05, 0.05, 1.05}),
            Cell::occupied);
}

TEST(OccupancyMap, TruncatesRaysAtTheMaximumRange) {
  const OccupancyMap map = after_measurements({9.0F});
  EXPECT_EQ(map.at({0.05, 0.05, 4.95}), Cell::free);
  EXPECT_EQ(map.at({0.05, 0.05, 5.25}), Cell::unknown);
  EXPECT_EQ(map.counts().occupied, 0U);
}

TEST(OccupancyMap, IgnoresEmptyAndDynamicPixels) {
  const CameraModel camera = a_small_camera();
  OccupancyMap map;
  map.integrate(DepthImage(160, 120, 0.0F), {}, camera, Pose());
  map.integrate(DepthImage(160, 120, std::numeric_limits<float>::quiet_NaN()), {}, camera, Pose());
  map.integrate(DepthImage(160, 120, -1.0F), {}, camera, Pose());
  map.integrate(DepthImage(160, 120, 1.0F), MaskImage(160, 120, 1), camera, Pose());
  EXPECT_EQ(map.counts().free + map.counts().occupied, 0U);
  EXPECT_EQ(map.at({0, 0, 0.5}), Cell::unknown);
}

TEST(OccupancyMap, IgnoresAFrameBeyondOctomapsKeyRange) {
  OccupancyMap map;
  map.integrate(DepthImage(160, 120, 1.0F), {}, a_small_camera(),
                Pose::from_translation({1e6, 0, 0}));
  EXPECT_EQ(map.counts().free, 0U);
  EXPECT_EQ(map.at({1e30, 0, 0}), Cell::unknown);
  EXPECT_EQ(map.at({std::numeric_limits<double>::quiet_NaN(), 0, 0}), Cell::unknown);
}

TEST(OccupancyMap, RejectsOptionsOutOfRange) {
  EXPECT_THROW(OccupancyMap(with(&OccupancyOptions::resolution, 0.0)), ContractError);
  EXPECT_THROW(OccupancyMap(with(&OccupancyOptions::max_range, 0.001)), ContractError);
  EXPECT_THROW(OccupancyMap(with(&OccupancyOptions::prob_hit, 0.5)), ContractError);
  EXPECT_THROW(OccupancyMap(with(&OccupancyOptions::prob_miss, 0.5)), ContractError);
}

TEST(OccupancyMap, ClearsCellsWithoutASurface) {
  OccupancyMap map;
  const CameraModel camera = a_small_camera();
  // A table one metre below the camera, and an object 0.3 m above a part of it that was removed
  // since.
  DepthImage depth(160, 120, 1.0F);
  for (int v = 50; v < 70; ++v) {
    for (int u = 70; u < 90; ++u) depth(u, v) = 0.7F;
  }
  map.integrate(depth, {}, camera, a_view_from_above());
  ASSERT_EQ(map.at({0.5, 0.0, 0.3}), Cell::occupied);
  const OccupancyMap::Counts before = map.counts();
  const TriangleMesh table = a_level_square({0.5, 0.0, 0.0}, 2.0, 3);
  const std::size_t cleared = map.clear_unsupported(table);
  EXPECT_GT(cleared, 0U);
  EXPECT_EQ(map.at({0.5, 0.0, 0.3}), Cell::unknown);
  EXPECT_EQ(map.at({0.7, 0.2, 0.0}), Cell::occupied);
  EXPECT_EQ(map.at({0.5, 0.0, 0.1}), Cell::unknown)
      << "the space behind the removed object was not observed";
  EXPECT_EQ(map.counts().occupied, before.occupied - cleared);
  EXPECT_EQ(map.counts().free, before.free);
  EXPECT_EQ(map.clear_unsupported(table), 0U);
}

TEST(OccupancyMap, IsReadByOctomapCellByCell) {
  const TemporaryFolder folder;
  const Scene scene = a_box_on_a_table();
  const auto file = folder.path() / "occupancy.bt";
  ASSERT_TRUE(scene.occupancy.write(file));
  octomap::OcTree tree(1.0);
  ASSERT_TRUE(tree.readBinary(file.string()));
  EXPECT_DOUBLE_EQ(tree.getResolution(), scene.occupancy.options().resolution);
  const CellAgreement agreement = compare(scene.occupancy, tree);
  EXPECT_GT(agreement.known, 10'000U);
  EXPECT_EQ(agreement.same, agreement.known);
}

TEST(OccupancyMap, OccupiesTheCellsThatASurfaceIntersects) {
  OccupancyMap map(with(&OccupancyOptions::resolution, 0.02));
  TriangleMesh square;
  square.vertices = {{-0.205F, -0.205F, 0.01F}, {0.205F, -0.205F, 0.01F}, {0.205F, 0.205F, 0.01F}};
  square.triangles = {{0, 1, 2}};
  map.mark_occupied(square);
  EXPECT_EQ(map.at({0.1, 0.0, 0.011}), Cell::occupied);
  EXPECT_EQ(map.at({0.1, 0.0, 0.03}), Cell::unknown);
  EXPECT_EQ(map.at({-0.1, 0.1, 0.011}), Cell::unknown);  // beyond the slanted edge
  EXPECT_EQ(map.counts().free, 0U);
  EXPECT_EQ(map.counts().occupied, 22U * 23U / 2U + 21U);  // 22 columns, and the diagonal's steps
}

TEST(OccupancyMap, ReportsAFileThatCantBeWritten) {
  const auto written = OccupancyMap().write("/nowhere/at/all/occupancy.bt");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().to_string().find("/nowhere/at/all/occupancy.bt"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
