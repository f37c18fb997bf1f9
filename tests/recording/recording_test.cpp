// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/recording.hpp"

#include <string>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/time_series.hpp"

#include "recording/small_recording.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

const std::string kManifest = "format: pcavr-recording/1\n";

TEST(ReadRecording, FindsFramesInTheirOrder) {
  const SmallRecording folder;
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  ASSERT_EQ(recording->frames.size(), 3u);
  EXPECT_EQ(recording->frames[1].color_stamp, milliseconds(1050));
  EXPECT_EQ(recording->frames[1].depth_path, "depth/1.050000.png");
  EXPECT_EQ(recording->unpaired_color + recording->unpaired_depth, 0u);
}

TEST(ReadRecording, CountsUnpairedImages) {
  const SmallRecording folder;
  folder.write("rgb.txt", "1.0 rgb/1.000000.jpg\n1.075 rgb/1.050000.jpg\n1.12 rgb/1.100000.jpg");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_EQ(recording->frames.size(), 2u);
  EXPECT_EQ(recording->unpaired_color, 1u);
  EXPECT_EQ(recording->unpaired_depth, 1u);
}

TEST(ReadRecording, NeedsNoImages) {
  const TemporaryFolder folder;
  write_text(folder.path() / "recording.yaml", kManifest);
  write_text(folder.path() / "joints.csv", "t,q1,q2,tau1,tau2\n0.5,1,2,3,4\n");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_TRUE(recording->frames.empty());
  ASSERT_EQ(recording->joints.size(), 1u);
  EXPECT_EQ(recording->joints[0].torque, (std::vector<double>{3, 4}));
  EXPECT_TRUE(recording->joints[0].velocity.empty());
}

TEST(ReadRecording, ReadsEverySeries) {
  const SmallRecording folder;
  folder.write("groundtruth.txt", "# t tx ty tz qx qy qz qw\n1.0 1 2 3 0 0 0 1\n");
  folder.write("tool.csv", "t,x,y,z,qx,qy,qz,qw\n0.1,1,2,3,0,0,1,0\n0.2,1,2,3,0,0,1,0\n");
  folder.write("wrench.csv", "t,fx,fy,fz,tx,ty,tz\n0.1,1,2,3,4,5,6\n");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_EQ(recording->groundtruth.poses()[0].pose.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(recording->tool.size(), 2u);
  EXPECT_EQ(recording->tool.poses()[0].pose.rotation().z(), 1.0);
  EXPECT_EQ(recording->wrench[0].torque, Eigen::Vector3d(4, 5, 6));
}

TEST(ReadRecording, AcceptsWindowsLineEndsAndAByteOrderMark) {
  const SmallRecording folder;
  folder.write("wrench.csv", "\xEF\xBB\xBFt,fx,fy,fz,tx,ty,tz\r\n0.1,1,2,3,4,5,6\r\n\r\n");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_EQ(recording->wrench.size(), 1u);
}

/// One file of a valid recording replaced, and the expected error.
struct FileFault {
  const char* name;
  const char* file;
  const char* text;
  int line;
  const char* message;  ///< a part of it
};

void PrintTo(const FileFault& fault, std::ostream* out) { *out << fault.name; }

class RecordingFault : public testing::TestWithParam<FileFault> {};

TEST_P(RecordingFault, IsReportedWithFileLineAndHint) {
  const FileFault& fault = GetParam();
  const SmallRecording folder;
  folder.write(fault.file, fault.text);
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_FALSE(recording.has_value());
  const Error& error = recording.error();
  EXPECT_EQ(error.file, (folder.path() / fault.file).string());
  EXPECT_EQ(error.line, fault.line) << error.to_string();
  EXPECT_NE(error.message.find(fault.message), std::string::npos) << error.to_string();
  EXPECT_FALSE(error.hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Each, RecordingFault,
    testing::Values(
        FileFault{"ImageMissing", "rgb.txt", "# c\n1.0 rgb/none.jpg\n", 2, "none.jpg is missing"},
        FileFault{"StampGoesBack", "depth.txt", "2.0 depth/1.000000.png\n1.0 depth/1.050000.png\n",
                  2, "not after"},
        FileFault{"StampRepeats", "groundtruth.txt", "1 0 0 0 0 0 0 1\n1.000 0 0 0 0 0 0 1\n", 2,
                  "not after"},
        FileFault{"PathLeaves", "rgb.txt", "1.0 rgb/../../x.jpg\n", 1, "does not lie"},
        FileFault{"PathAbsolute", "rgb.txt", "1.0 /etc/passwd\n", 1, "does not lie"},
        FileFault{"ListColumns", "rgb.txt", "1.0 rgb/1.000000.jpg extra\n", 1, "3 columns, not 2"},
        FileFault{"NotAStamp", "rgb.txt", "one rgb/1.000000.jpg\n", 1, "not a time"},
        FileFault{"NotANumber", "wrench.csv",
                  "t,fx,fy,fz,tx,ty,tz\n0,0,0,0,0,0,0\n1,nan,0,0,0,0,0\n", 3,
                  "'nan' is not a finite number"},
        FileFault{"Infinite", "wrench.csv", "t,fx,fy,fz,tx,ty,tz\n1,0,-inf,0,0,0,0\n", 2, "-inf"},
        FileFault{"TooFewColumns", "wrench.csv", "t,fx,fy,fz,tx,ty,tz\n1,0,0,0,0,0\n", 2,
                  "6 columns, not 7"},
        FileFault{"WrongHeader", "wrench.csv", "t,fx,fz,fy,tx,ty,tz\n1,0,0,0,0,0,0\n", 1, "header"},
        FileFault{"NoHeader", "tool.csv", "0.1,1,2,3,0,0,1,0\n", 1, "header"},
        FileFault{"Empty", "tool.csv", "", 0, "empty"},
        FileFault{"QuaternionOfNormZero", "tool.csv", "t,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,0\n", 2,
                  "norm"},
        FileFault{"CoordinateOfAnotherUnit", "tool.csv", "t,x,y,z,qx,qy,qz,qw\n1,0,2e4,0,0,0,0,1\n",
                  2, "out of range for a coordinate"},
        FileFault{"ForceOfAnotherUnit", "wrench.csv", "t,fx,fy,fz,tx,ty,tz\n1,1e300,0,0,0,0,0\n", 2,
                  "1e+300 is out of range for a force"},
        FileFault{"JointOutOfRange", "joints.csv", "t,q1\n1,-1e12\n", 2,
                  "out of range for a joint"},
        FileFault{"ClockChangesWithinASeries", "tool.csv",
                  "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1305031102,0,0,0,0,0,0,1\n", 0,
                  "more than ten hours"},
        FileFault{"JointHeader", "joints.csv", "t,q1,q2,dq1\n", 1, "header"},
        FileFault{"UnknownKey", "recording.yaml", "format: pcavr-recording/1\ncamra: 1\n", 2,
                  "unknown key 'camra'"},
        FileFault{"ImagesWithoutCamera", "recording.yaml", "format: pcavr-recording/1\n", 0,
                  "'camera' is missing"},
        FileFault{"MeshMissing", "recording.yaml",
                  "format: pcavr-recording/1\nobjects:\n  - {name: a, mesh: a.obj}\n", 3,
                  "a.obj is missing"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ReadRecording, RefusesListsWithoutAPair) {
  const SmallRecording folder;
  folder.write("rgb.txt", "# nothing\n");
  folder.write("depth.txt", "");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_FALSE(recording.has_value());
  EXPECT_NE(recording.error().message.find("no frames"), std::string::npos);
}

TEST(ReadRecording, RefusesDepthWithoutColour) {
  const SmallRecording folder;
  std::filesystem::remove(folder.path() / "rgb.txt");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_FALSE(recording.has_value());
  EXPECT_EQ(recording.error().message, "rgb.txt is missing");
}

TEST(ReadRecording, ReadsColourAlone) {
  const SmallRecording folder;
  const std::size_t frames = read_recording(folder.path()).value().frames.size();
  std::filesystem::remove(folder.path() / "depth.txt");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_FALSE(recording->has_depth);
  ASSERT_GE(recording->frames.size(), frames);
  const Expected<RgbdFrame> frame = decode_frame(*recording, 0);
  ASSERT_TRUE(frame.has_value()) << frame.error().to_string();
  EXPECT_EQ(frame->depth_stamp, frame->color_stamp);
  EXPECT_EQ(frame->depth.width(), frame->color.width());
  for (const float z : frame->depth.pixels()) ASSERT_EQ(z, 0.0F);
}

TEST(ReadRecording, RefusesAFolderThatIsNotARecording) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_recording(folder.path()).has_value());
  EXPECT_FALSE(read_recording(folder.path() / "absent").has_value());
}

TEST(ReadRecording, SkipsAndCountsBadRowsWithSkipBad) {
  const SmallRecording folder;
  folder.write("rgb.txt", "1.0 rgb/1.000000.jpg\n1.05 rgb/gone.jpg\n1.1 rgb/1.100000.jpg\n");
  folder.write("wrench.csv",
               "t,fx,fy,fz,tx,ty,tz\n1,0,0,0,0,0,0\n0,0,0,0,0,0,0\n2,x,0,0,0,0,0\n"
               "3,0,0,0,0,0,0\n");
  ReadOptions options;
  options.skip_bad = true;
  const Expected<Recording> recording = read_recording(folder.path(), options);
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  EXPECT_EQ(recording->frames.size(), 2u);
  EXPECT_EQ(recording->unpaired_depth, 1u);
  EXPECT_EQ(recording->wrench.size(), 2u);
  EXPECT_EQ(recording->skipped_rows(), 3u);
}

TEST(ReadRecording, ListsSkippedRowsByFileAndReason) {
  const SmallRecording folder;
  folder.write("rgb.txt", "1.0 rgb/1.000000.jpg\n1.05 rgb/gone.jpg\n1.1 rgb/1.100000.jpg\n");
  folder.write("tool.csv",
               "t,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n2,nan,0,0,0,0,0,1\n3,1e9,0,0,0,0,0,1\n"
               "4,0,0,0,0,0,0,9\n5,0,0\n0,0,0,0,0,0,0,1\n6,0,inf,0,0,0,0,1\n");
  ReadOptions options;
  options.skip_bad = true;
  const Expected<Recording> recording = read_recording(folder.path(), options);
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  std::string listed;
  for (const auto& [file, reason, count] : recording->left_out) {
    listed += file + ": " + reason + ": " + std::to_string(count) + '\n';
  }
  EXPECT_EQ(listed,
            "rgb.txt: image is missing: 1\n"
            "tool.csv: not a finite number: 2\n"
            "tool.csv: number out of range: 1\n"
            "tool.csv: no unit quaternion: 1\n"
            "tool.csv: wrong number of columns: 1\n"
            "tool.csv: time is not after the one before: 1\n");
  EXPECT_EQ(recording->skipped_rows(), 7U);
}

TEST(ReadRecording, AcceptsALastLineWithoutALineEndAndWarnsWhereItIsShort) {
  const SmallRecording folder;
  const std::string rows = "t,fx,fy,fz,tx,ty,tz\n0.1,1.25,2.25,3.25,4,5,6.125\n";
  folder.write("wrench.csv", rows + "0.2,1.25,2.25,3.25,4,5,6.125");
  const Expected<Recording> whole = read_recording(folder.path());
  ASSERT_TRUE(whole.has_value()) << whole.error().to_string();
  EXPECT_EQ(whole->wrench.size(), 2U);
  EXPECT_TRUE(whole->warnings.empty());

  folder.write("wrench.csv", rows + "0.2,1.25,2.25,3.25,4,5,6.1");
  const Expected<Recording> cut = read_recording(folder.path());
  ASSERT_TRUE(cut.has_value()) << cut.error().to_string();
  EXPECT_EQ(cut->wrench.size(), 2U);
  ASSERT_EQ(cut->warnings.size(), 1U);
  EXPECT_NE(cut->warnings[0].find("wrench.csv:3: the last line has no line end"), std::string::npos)
      << cut->warnings[0];
}

TEST(ReadRecording, WarnsOfATruncationAlsoAfterShortRows) {
  const SmallRecording folder;
  std::string rows = "t,fx,fy,fz,tx,ty,tz\n0.0,0,0,0,0,0,0\n";
  for (int i = 1; i < 10; ++i) {
    rows += "0." + std::to_string(i) + ",1.25,2.25,-3.2512345678,4,5,6.125\n";
  }
  folder.write("wrench.csv", rows + "1.0,1.25,2.25,-3.2512345678,4,5,-0.00");
  const Expected<Recording> cut = read_recording(folder.path());
  ASSERT_TRUE(cut.has_value()) << cut.error().to_string();
  EXPECT_TRUE(cut->warnings.empty());  // as long as its neighbours

  folder.write("wrench.csv", rows + "1.0,1.25,2.25,-3.25,4,5,6.125");
  const Expected<Recording> short_row = read_recording(folder.path());
  ASSERT_TRUE(short_row.has_value());
  ASSERT_EQ(short_row->warnings.size(), 1U);
  EXPECT_NE(short_row->warnings[0].find("no line end"), std::string::npos);
}

TEST(ReadRecording, ReadsImagesWithSpacesInTheirNames) {
  const SmallRecording folder;
  std::filesystem::create_directories(folder.path() / "my images");
  std::filesystem::rename(folder.path() / "rgb/1.000000.jpg", folder.path() / "my images/a #1.jpg");
  std::filesystem::rename(folder.path() / "rgb/1.050000.jpg",
                          folder.path() / "my images/say \"b\".jpg");
  folder.write("rgb.txt",
               "# a comment\n1.0 \"my images/a #1.jpg\" # another\n"
               "1.05 my\\ images/say\\ \\\"b\\\".jpg\n1.1\t rgb/1.100000.jpg\n");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
  ASSERT_EQ(recording->frames.size(), 3U);
  EXPECT_EQ(recording->frames[0].color_path, "my images/a #1.jpg");
  EXPECT_EQ(recording->frames[1].color_path, "my images/say \"b\".jpg");
  EXPECT_EQ(recording->frames[2].color_path, "rgb/1.100000.jpg");
}

TEST(ReadRecording, HintsHowToQuoteANameWithSpaces) {
  const SmallRecording folder;
  folder.write("rgb.txt", "1.0 my image.jpg\n");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_FALSE(recording.has_value());
  EXPECT_NE(recording.error().hint.find("\"...\""), std::string::npos) << recording.error().hint;
}

TEST(ReadRecording, RefusesADanglingLinkInPlaceOfAnOptionalFile) {
  const SmallRecording folder;
  std::filesystem::create_symlink("nowhere", folder.path() / "tool.csv");
  const Expected<Recording> recording = read_recording(folder.path());
  ASSERT_FALSE(recording.has_value());
  EXPECT_NE(recording.error().to_string().find("tool.csv: is a symbolic link"), std::string::npos);
}

TEST(Trajectory, RoundTripIsLossless) {
  Trajectory trajectory;
  trajectory.append({-1'500'000'001}, Pose::from_translation({0.1, 1e-9, -3e3}));
  trajectory.append({1'305'031'480'050'000'000},
                    Pose(Eigen::Quaterniond(0.1, 0.2, 0.3, 0.9), {1.0 / 3.0, 2.0, 3.0}));
  const TemporaryFolder folder;
  write_text(folder.path() / "t.txt", format_trajectory(trajectory));
  const Expected<Trajectory> again = read_trajectory(folder.path() / "t.txt");
  ASSERT_TRUE(again.has_value()) << again.error().to_string();
  ASSERT_EQ(again->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again->poses()[i].stamp, trajectory.poses()[i].stamp);
    EXPECT_EQ(again->poses()[i].pose.translation(), trajectory.poses()[i].pose.translation());
    // Reading normalises again, which may change the last bit.
    EXPECT_LT(rotation_distance(again->poses()[i].pose, trajectory.poses()[i].pose), 1e-12);
  }
}

TEST(ReadRecording, AcceptsTheSharedRecordings) {
  PCAVR_NEEDS_SHARED_DATA("tabletop");
  for (const auto& [name, frames] : {std::pair("tabletop", 120u), {"push_two_boxes", 180u}}) {
    const Expected<Recording> recording = read_recording(shared_data(name));
    ASSERT_TRUE(recording.has_value()) << recording.error().to_string();
    EXPECT_EQ(recording->frames.size(), frames);
  }
}

TEST(TimeSeries, ReservesItsRowsAtOnce) {
  std::string text = "t,fx,fy,fz,tx,ty,tz\n";
  for (int i = 0; i < 1000; ++i) text += std::to_string(i) + ".0,1,2,3,0,0,0\n";
  const auto wrench = parse_wrench({.file = "wrench.csv", .text = text});
  ASSERT_TRUE(wrench.has_value()) << wrench.error().to_string();
  EXPECT_EQ(wrench->content.size(), 1000U);
  EXPECT_LE(wrench->content.capacity(), 1002U);  // a header, and perhaps a row without a newline
}

}  // namespace
}  // namespace pcavr
