// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/cloud/cloud_list.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class CloudNames : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& text = {}) const {
    std::ofstream(folder_.path() / name) << text;
  }
  [[nodiscard]] CloudList list(const std::string& name = {}) const {
    const auto list = list_clouds(name.empty() ? folder_.path() : folder_.path() / name, 10.0);
    if (!list) {
      ADD_FAILURE() << list.error().to_string();
      return {};
    }
    return *list;
  }
  void expect_error(const std::string& message) const {
    const auto list = list_clouds(folder_.path(), 10.0);
    ASSERT_FALSE(list.has_value());
    EXPECT_NE(list.error().message.find(message), std::string::npos) << list.error().to_string();
  }

  TemporaryFolder folder_;
};

TEST_F(CloudNames, SecondsInNames) {
  add("cloud_1305031480.050000.pcd");
  add("cloud_1305031480.000000.PCD");
  add("notes.txt");
  const CloudList clouds = list();
  ASSERT_EQ(clouds.clouds.size(), 2U);
  EXPECT_TRUE(clouds.has_times);
  EXPECT_EQ(clouds.clouds[0].stamp.nanoseconds, 1305031480'000000000LL);
  EXPECT_EQ(clouds.clouds[1].stamp.nanoseconds, 1305031480'050000000LL);
}

TEST_F(CloudNames, DigitsTellTheUnit) {
  add("a_1305031480000000001.ply");
  EXPECT_EQ(list().clouds[0].stamp.nanoseconds, 1305031480'000000001LL);
  EXPECT_TRUE(list("a_1305031480000000001.ply").clouds.size() == 1U);
}

TEST_F(CloudNames, FrameNumbersByTheRate) {
  add("frame2_0010.pcd");
  add("frame2_0009.pcd");
  const CloudList clouds = list();
  EXPECT_FALSE(clouds.has_times);
  EXPECT_EQ(clouds.clouds[0].stamp.nanoseconds, 900'000'000);
  EXPECT_EQ(clouds.clouds[1].stamp.nanoseconds, 1'000'000'000);
}

TEST_F(CloudNames, AListNamesFilesAndStamps) {
  add("b.pcd");
  add("a.ply");
  add("list.txt", "# clouds\n1.5 b.pcd\n2.5 a.ply\n");
  const CloudList clouds = list("list.txt");
  ASSERT_EQ(clouds.clouds.size(), 2U);
  EXPECT_EQ(clouds.clouds[0].file.filename(), "b.pcd");
  EXPECT_EQ(clouds.clouds[1].stamp.nanoseconds, 2'500'000'000);
}

TEST_F(CloudNames, MissingFilesOfAListAreErrors) {
  add("list.txt", "1.5 b.pcd\n");
  const auto clouds = list_clouds(folder_.path() / "list.txt", 10.0);
  ASSERT_FALSE(clouds.has_value());
  EXPECT_EQ(clouds.error().line, 1);
}

TEST_F(CloudNames, NamesThatGiveNoOrderAreErrors) {
  add("left.pcd");
  add("right.pcd");
  expect_error("no number");
}

TEST_F(CloudNames, EqualStampsAreErrors) {
  add("a_7.pcd");
  add("b_07.ply");
  expect_error("has the stamp of");
}

TEST_F(CloudNames, NamesOfTwoKindsAreErrors) {
  add("a_7.pcd");
  add("b_1305031480.050000.pcd");
  expect_error("vice versa");
}

TEST_F(CloudNames, AFolderWithoutCloudsIsAnError) {
  EXPECT_FALSE(has_clouds(folder_.path()));
  expect_error("names no clouds");
}

}  // namespace
}  // namespace pcavr
