// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// CSV files as the programs of robots, force sensors and motion capture write them.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/date_time.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {
namespace fs = std::filesystem;

/// What a folder's CSV files have, by topic: the stamp, then the message's numbers.
struct Tables {
  std::map<std::string, std::vector<std::vector<double>>> rows = {};
  std::vector<std::string> warnings = {};
  std::string error = {};
};

void append(const Eigen::Vector3d& vector, std::vector<double>& row) {
  row.insert(row.end(), {vector.x(), vector.y(), vector.z()});
}

std::vector<double> row_of(const RosMessage& message, Stamp stamp) {
  std::vector<double> row{stamp.seconds()};
  if (const auto* pose = std::get_if<RosPose>(&message)) {
    append(pose->position, row);
    append(pose->orientation->vec(), row);
    row.push_back(pose->orientation->w());
  }
  if (const auto* body = std::get_if<RosTransforms>(&message)) {
    append(body->transforms.at(0).translation, row);
    append(body->transforms.at(0).rotation.vec(), row);
    row.push_back(body->transforms.at(0).rotation.w());
  }
  if (const auto* wrench = std::get_if<RosWrench>(&message)) {
    append(wrench->force, row);
    append(wrench->torque, row);
  }
  return row;
}

class CsvTables : public ::testing::Test {
 protected:
  void write(const char* name, const std::string& text) const {
    ASSERT_TRUE(write_file(folder_.path() / name, text));
  }
  [[nodiscard]] Tables read(const CsvOptions& options = {}) const {
    Tables tables;
    auto reader = open_csv_series(folder_.path(), options);
    if (!reader) return {.error = reader.error().to_string()};
    for (;;) {
      const auto message = (*reader)->next();
      if (!message) tables.error = message.error().to_string();
      if (!message || !*message) break;
      const BagTopic& topic = (*reader)->topics()[(*message)->topic];
      const auto decoded = decode_ros_message(topic, (*message)->payload);
      EXPECT_TRUE(decoded) << decoded.error().to_string();
      if (decoded) tables.rows[topic.name].push_back(row_of(*decoded, (*message)->log_time));
    }
    tables.warnings = (*reader)->warnings();
    return tables;
  }
  static void expect_row(const std::vector<double>& row, const std::vector<double>& expected) {
    ASSERT_EQ(row.size(), expected.size());
    for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], expected[i], 1e-6) << i;
  }
  static bool mentions(const Tables& tables, const std::string& text) {
    return std::any_of(tables.warnings.begin(), tables.warnings.end(),
                       [&](const auto& warning) { return warning.find(text) != warning.npos; });
  }

  const TemporaryFolder folder_;
};

TEST_F(CsvTables, AUrLogHasPosesByRotationVectorAndForces) {
  write("ur.csv",
        "timestamp actual_TCP_pose_0 actual_TCP_pose_1 actual_TCP_pose_2 actual_TCP_pose_3 "
        "actual_TCP_pose_4 actual_TCP_pose_5 actual_TCP_force_0 actual_TCP_force_1 "
        "actual_TCP_force_2 actual_TCP_force_3 actual_TCP_force_4 actual_TCP_force_5 robot_mode\n"
        "12.5 0.1 -0.2 0.3 0 3.14159265 0 1 2 3 0.1 0.2 0.3 7\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  ASSERT_EQ(tables.rows.size(), 2U);
  expect_row(tables.rows.at("ur").at(0), {12.5, 0.1, -0.2, 0.3, 0.0, 1.0, 0.0, 0.0});
  expect_row(tables.rows.at("ur/force").at(0), {12.5, 1, 2, 3, 0.1, 0.2, 0.3});
}

TEST_F(CsvTables, ASensorOfThreeAxesHasNoTorques) {
  write("optoforce.csv", "time_ms;Fx [N];Fy [N];Fz [N]\n100;1;-2;3\n110;1;-2;4\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  expect_row(tables.rows.at("optoforce").at(0), {0.1, 1, -2, 3, 0, 0, 0});
  EXPECT_TRUE(mentions(tables, "torques are 0"));
}

TEST_F(CsvTables, ATableNamedAfterADeclaredObjectIsItsPoses) {
  const char* const pose = "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0.1,0,0,0,1\n";
  for (const char* const name : {"block.csv", "robot.csv"}) write(name, pose);
  ASSERT_TRUE(
      write_file(folder_.path() / "bodies.yaml",
                 "format: pcavr-recording/1\nobjects:\n  - {name: block, movable: true}\n"));
  const TemporaryFolder target;
  BagImportOptions options;
  options.manifest = folder_.path() / "bodies.yaml";
  const auto report = import_bag(folder_.path(), target.path(), options);
  ASSERT_TRUE(report) << report.error().to_string();
  EXPECT_TRUE(fs::exists(target.path() / "tool.csv"));
  EXPECT_TRUE(fs::exists(target.path() / "tracked/objects/block/tracked.txt"));
}

TEST_F(CsvTables, AFrankaLogHasAMatrixColumnAfterColumn) {
  std::string header = "time [ms]", row = "1700000000000";
  // A quarter turn about z.
  const std::vector<double> T{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0.3, 0.4, 0.5, 1};
  for (std::size_t i = 0; i < T.size(); ++i) {
    header += ",O_T_EE[" + std::to_string(i) + "]";
    row += "," + std::to_string(T[i]);
  }
  write("franka.csv", header + "\n" + row + "\n");
  const double h = std::sqrt(0.5);
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  expect_row(tables.rows.at("franka").at(0), {1.7e9, 0.3, 0.4, 0.5, 0, 0, h, h});
  row.replace(row.find("1.000000"), 8, "3.000000");
  write("franka.csv", header + "\n" + row + "\n");
  EXPECT_NE(read().error.find("franka.csv:2"), std::string::npos) << read().error;
}

TEST_F(CsvTables, AKukaLogIsInMillimetresAndDegrees) {
  write("kuka.csv", "t;X;Y;Z;A;B;C\n1,5;100;200;300;90;0;180\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  // About x by half a turn, then about z by a quarter.
  const double h = std::sqrt(0.5);
  const std::vector<double>& row = tables.rows.at("kuka").at(0);
  expect_row({row.begin(), row.begin() + 4}, {1.5, 0.1, 0.2, 0.3});
  EXPECT_NEAR(std::abs(row[4] * h + row[5] * h), 1.0, 1e-9);
  EXPECT_TRUE(mentions(tables, "mm and degrees"));
}

TEST_F(CsvTables, ColumnsNamedAfterBodiesAreATopicForEach) {
  write("log.csv",
        "__time,/tool/pose/position/x,/tool/pose/position/y,/tool/pose/position/z,"
        "/tool/pose/orientation/x,/tool/pose/orientation/y,/tool/pose/orientation/z,"
        "/tool/pose/orientation/w,/ft/wrench/force/x,/ft/wrench/force/y,/ft/wrench/force/z,"
        "/ft/wrench/torque/x,/ft/wrench/torque/y,/ft/wrench/torque/z\n"
        "1.0,1,2,3,0,0,0,1,,,,,,\n"
        "1.1,,,,,,,,4,5,6,0.4,0.5,0.6\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  ASSERT_EQ(tables.rows.at("log/tool").size(), 1U);
  ASSERT_EQ(tables.rows.at("log/ft").size(), 1U);
  expect_row(tables.rows.at("log/tool").at(0), {1.0, 1, 2, 3, 0, 0, 0, 1});
  expect_row(tables.rows.at("log/ft").at(0), {1.1, 4, 5, 6, 0.4, 0.5, 0.6});
}

TEST_F(CsvTables, StampsMayBeDates) {
  write("ft.csv", "time,fx,fy,fz,tx,ty,tz\n2025-03-12T10:20:34.567+01:00,1,2,3,4,5,6\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  expect_row(tables.rows.at("ft").at(0), {1741771234.567, 1, 2, 3, 4, 5, 6});
  EXPECT_TRUE(tables.warnings.empty());
  write("ft.csv", "time,fx,fy,fz,tx,ty,tz\n2025-03-12 10:20:34,1,2,3,4,5,6\nnoon,1,2,3,4,5,6\n");
  EXPECT_NE(read().error.find("'noon' is no date"), std::string::npos);
}

TEST_F(CsvTables, AnyColumnCanStandForAQuantity) {
  write("ft.csv", "millis,A,B,C,D,E,F,fx\n2500,1,2,3,4,5,6,9\n");
  EXPECT_FALSE(has_csv_series(folder_.path()));
  const CsvOptions options{.columns = {{"t", "millis"},
                                       {"fx", "C"},
                                       {"fy", "B"},
                                       {"fz", "A"},
                                       {"tx", "D"},
                                       {"ty", "E"},
                                       {"tz", "F"}},
                           .units = {{"t", "ms"}, {"fz", "kN"}}};
  EXPECT_TRUE(has_csv_series(folder_.path(), options));
  const Tables tables = read(options);
  ASSERT_EQ(tables.error, "");
  expect_row(tables.rows.at("ft").at(0), {2.5, 3, 2, 1000, 4, 5, 6});
  EXPECT_NE(read({.columns = {{"t", "when"}}}).error.find("no file has the column 'when'"),
            std::string::npos);
}

/// A take of two bodies, in local time; the second is lost in the second frame.
const char* const kTake =
    "Format Version,1.23,Take Name,push,Capture Frame Rate,100.0,Export Frame Rate,100.0,Capture "
    "Start Time,2025-03-12 10.20.34.567 AM,Total Frames in Take,2,Total Exported Frames,2,Rotation "
    "Type,Quaternion,Length Units,Millimeters,Coordinate Space,Global\n\n"
    ",,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid "
    "Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"
    ",,box,box,box,box,box,box,box,lid,lid,lid,lid,lid,lid,lid\n"
    ",,\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"1\",\"2\",\"2\",\"2\",\"2\",\"2\",\"2\",\"2\"\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Rotation,Rotation,Rotation,"
    "Rotation,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,X,Y,Z,W,X,Y,Z\n"
    "0,0.000,0,0.6,0,0.8,100,20,-300,0,0,0,1,1,2,3\n"
    "1,0.010,0,0.6,0,0.8,110,20,-300,,,,,,,\n";

TEST_F(CsvTables, ATakeIsATopicForEachBody) {
  write("Take 2025-03-12.csv", kTake);
  write("ft.csv", "Timestamp [ms];fx;fy;fz;tx;ty;tz\n1741771234600;1;2;3;4;5;6\n");
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  ASSERT_EQ(tables.rows.at("box").size(), 2U);
  ASSERT_EQ(tables.rows.at("lid").size(), 1U);
  // An hour east of UTC; y up becomes z up.
  expect_row(tables.rows.at("box").at(1),
             {1741771234.577, 0.110, 0.300, 0.020, 0.0, 0.0, 0.6, 0.8});
  EXPECT_TRUE(mentions(tables, "UTC+01:00, nearest to ft.csv"));
  EXPECT_TRUE(mentions(tables, "lid was not seen in 1 of 2 frames"));
  EXPECT_TRUE(mentions(tables, "--up z"));
}

TEST_F(CsvTables, TwoTakesOfOneBodyAreTwoTopics) {
  write("Take 1.csv", kTake);
  write("Take 2.csv", kTake);
  const Tables tables = read();
  ASSERT_EQ(tables.error, "");
  EXPECT_EQ(tables.rows.at("box").size(), 2U);
  EXPECT_EQ(tables.rows.at("Take 2/box").size(), 2U);
}

TEST_F(CsvTables, ATakeMayHaveZUpAndBeAlone) {
  write("take.csv", kTake);
  const Tables tables = read({.up = 'z'});
  ASSERT_EQ(tables.error, "");
  expect_row(tables.rows.at("box").at(0),
             {1741774834.567, 0.100, 0.020, -0.300, 0.0, 0.6, 0.0, 0.8});
  EXPECT_TRUE(mentions(tables, "no other file has a date"));
  EXPECT_FALSE(mentions(tables, "--up z"));
}

TEST_F(CsvTables, ATakeThatCantBeReadSaysHowToExportIt) {
  std::string text = kTake;
  text.replace(text.find("Quaternion"), 10, "XYZ");
  write("take.csv", text);
  EXPECT_NE(read().error.find("Rotation Type Quaternion"), std::string::npos);
  text = kTake;
  text.replace(text.find("Millimeters"), 11, "Inches");
  write("take.csv", text);
  EXPECT_NE(read().error.find("'Inches'"), std::string::npos);
}

/// Three programs' files of a push; the tracker's body is not the CAD frame, and its world is not
/// the base.
TEST_F(CsvTables, ALabsThreeFilesAreOneRecording) {
  PCAVR_NEEDS_SHARED_DATA("lab_log/probe-1");
  BagImportOptions options;
  options.topics.wrench_frame = "tool";
  options.invert_wrench = true;
  options.tare = 1.0;
  const auto degrees = [](double angle) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(angle * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ()));
  };
  options.T_base_world = Pose(degrees(25.0), Eigen::Vector3d(0.1, 0.4, 0.0));
  const Pose T_object_tracked(degrees(-40.0), Eigen::Vector3d(0.012, -0.020, 0.045));
  options.T_tracked_object = {{"block", T_object_tracked.inverse()}};
  const auto report = import_bag(shared_data("lab_log/probe-1"), folder_.path(), options);
  ASSERT_TRUE(report) << report.error().to_string();
  const auto tracked = read_trajectory(folder_.path() / "tracked/objects/block/tracked.txt");
  const auto truth = read_trajectory(shared_data("lab_log/probe-1/truth/objects/body.txt"));
  ASSERT_TRUE(tracked);
  ASSERT_TRUE(truth);
  const Stamp begin = tracked->poses().front().stamp;
  int compared = 0;
  for (const TimedPose& seen : tracked->poses()) {
    const auto pose = truth->at(Stamp{} + (seen.stamp - begin));
    if (!pose) continue;
    EXPECT_LT((pose->translation() - seen.pose.translation()).norm(), 3e-3);
    EXPECT_LT(pose->rotation().angularDistance(seen.pose.rotation()), 0.02);
    ++compared;
  }
  EXPECT_GT(compared, 1200);
}

TEST(DateTime, IsReadAsProgramsWriteIt) {
  struct Case {
    const char* text;
    double seconds;
    bool has_zone;
  };
  for (const Case& c : {Case{"1970-01-01T00:00:00Z", 0.0, true},
                        Case{"2025-03-12 10.20.34.567 AM", 1741774834.567, false},
                        Case{"2025-03-12 12:20:34 AM", 1741738834.0, false},
                        Case{"2025/03/12 1.20.34 PM", 1741785634.0, false},
                        Case{"2025-03-12T10:20:34,5-0230", 1741783834.5, true},
                        Case{" 2024-02-29 23:59:59.123456789 ", 1709251199.123456789, false}}) {
    const auto date = parse_date_time(c.text);
    ASSERT_TRUE(date) << c.text;
    EXPECT_NEAR(date->stamp.seconds(), c.seconds, 1e-6) << c.text;
    EXPECT_EQ(date->has_zone, c.has_zone) << c.text;
  }
  for (const char* text :
       {"", "1741771234", "2025-02-29 10:20:34", "2025-13-01 10:20:34", "2025-03-12",
        "2025-03-12 24:00:00", "2025-03-12 13:20:34 PM", "2025-03-12 10:20:34 CET",
        "2025-03-12 10:20:34+1", "2025-03-12 10:20:34Zx"}) {
    EXPECT_FALSE(parse_date_time(text)) << text;
  }
}

}  // namespace
}  // namespace pcavr
