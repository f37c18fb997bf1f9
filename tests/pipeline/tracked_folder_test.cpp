// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

TEST(TrackedFolder, LeavesOutAPoseThatJumpsAndReturns) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "objects/box");
  std::string rows;
  for (int i = 0; i < 30; ++i) {
    const bool is_flipped = i == 22;
    rows += std::to_string(i / 30.0) + " 0.5 0.1 0.05 " +
            (is_flipped ? "0.7071068 0 0 0.7071068\n" : "0 0 0 1\n");
  }
  ASSERT_TRUE(write_file(folder.path() / "objects/box/tracked.txt", rows));
  const Expected<TrackedFile> tracked = read_tracked_poses(folder.path(), "box");
  ASSERT_TRUE(tracked) << tracked.error().message;
  EXPECT_EQ(tracked->poses.size(), 29U);
  EXPECT_TRUE(
      std::all_of(tracked->poses.begin(), tracked->poses.end(), [](const TrackedPose& pose) {
        return rotation_distance(pose.T_base_object, Pose()) < 0.01;
      }));
  ASSERT_EQ(tracked->left_out.size(), 1U);
  EXPECT_EQ(tracked->left_out[0].count, 1U);
  EXPECT_EQ(tracked->left_out[0].reason, "the pose jumps and returns, first at t = 0.733333 s");
}

TEST(TrackedFolder, NamesTheRowThatATimeInSecondsCantTellFromTheOneBefore) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "objects/box");
  const std::string pose = " 0.5 0.1 0.05 0 0 0 1\n";
  const std::string rows = "# t x y z qx qy qz qw\n4500000000.0" + pose + "4500000000.5" + pose +
                           "  4500000000.500000001" + pose;
  const fs::path file = folder.path() / "objects/box/tracked.txt";
  ASSERT_TRUE(write_file(file, rows));
  const Expected<TrackedFile> far = read_tracked_poses(folder.path(), "box");
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().file, file.string());
  EXPECT_EQ(far.error().line, 4);
  EXPECT_NE(far.error().message.find("4500000000.500000001"), std::string::npos)
      << far.error().message;
  const TrackedFileOptions near{.zero = Stamp::from_seconds(4.5e9)};
  const Expected<TrackedFile> tracked = read_tracked_poses(folder.path(), "box", near);
  ASSERT_TRUE(tracked) << tracked.error().message;
  EXPECT_EQ(tracked->poses.size(), 3U);
}

TEST(TrackedFolder, NamesARowOfTrackingWithANumberThatIsNone) {
  const TemporaryFolder folder;
  const fs::path object = folder.path() / "objects/box";
  fs::create_directories(object);
  ASSERT_TRUE(write_file(object / "tracked.txt", "0.5 0.5 0.1 0.05 0 0 0 1\n"));
  const std::string header = "t,method,tags,position_std,rotation_std,residual\n";
  ASSERT_TRUE(write_file(object / "tracking.csv", header + "0.5,tags,2,0.0002,0.001,0.4\n"));
  ASSERT_TRUE(read_tracked_poses(folder.path(), "box"));
  ASSERT_TRUE(write_file(object / "tracking.csv", header + "0.5,tags,2,0.0002,0.001,-inf\n"));
  const Expected<TrackedFile> tracked = read_tracked_poses(folder.path(), "box");
  ASSERT_FALSE(tracked);
  EXPECT_EQ(tracked.error().line, 2);
}

}  // namespace
}  // namespace pcavr
