// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A small recording without images; each test changes one of its files.
#include "pcavr/pipeline/doctor.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"
#include "support/two_joint_arm.hpp"

namespace pcavr {
namespace {

constexpr char kManifest[] =
    "format: pcavr-recording/1\n"
    "objects:\n"
    "  - {name: box, mesh: box.obj, mass: 1.0, movable: true,\n"
    "     pose: {t: [0.5, 0, 0.05], q: [0, 0, 0, 1]}}\n"
    "tool: {radius: 0.01}\n";

/// A box of 0.1 m about its origin.
constexpr char kBox[] =
    "v -0.05 -0.05 -0.05\nv 0.05 -0.05 -0.05\nv 0.05 0.05 -0.05\nv -0.05 0.05 -0.05\n"
    "v -0.05 -0.05 0.05\nv 0.05 -0.05 0.05\nv 0.05 0.05 0.05\nv -0.05 0.05 0.05\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

struct Series {
  double bias = 0.0;       ///< [N] along z
  double gap_at = 1e9;     ///< [s] from which samples are 0.4 s late
  double time_unit = 1.0;  ///< stamps in a second
};

class Doctor : public testing::Test {
 protected:
  void SetUp() override {
    write("recording.yaml", kManifest);
    write("box.obj", kBox);
    write_series({});
  }
  void write(const std::string& name, const std::string& text) {
    ASSERT_TRUE(write_file(folder_.path() / name, text));
  }
  /// 4 s of a tip that approaches the box, and of a force with some noise.
  void write_series(const Series& series) {
    std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
    std::string wrench = "t,fx,fy,fz,tx,ty,tz\n";
    for (int i = 0; i < 400; ++i) {
      const double at = 0.01 * i;
      const double t = (at + (at >= series.gap_at ? 0.4 : 0.0)) * series.time_unit;
      tool += fmt::format("{:.6f},{:.6f},0,0.05,0,0,0,1\n", t, 0.1 + 0.05 * at);
      wrench += fmt::format("{:.6f},{:.6f},0,{:.6f},0,0,0\n", 0.01 * i + 0.001,
                            0.01 * ((i * 37) % 11 - 5), series.bias + 0.01 * ((i * 53) % 13 - 6));
    }
    write("tool.csv", tool);
    write("wrench.csv", wrench);
  }
  DiagnosisReport diagnose() {
    const Expected<Recording> recording = read_recording(folder_.path());
    EXPECT_TRUE(recording) << recording.error().to_string();
    return diagnose_recording(*recording);
  }
  /// The rows of one verdict, a line each.
  static std::string rows_of(const DiagnosisReport& report, DiagnosisVerdict verdict) {
    std::string text;
    for (const DiagnosisRow& row : report.rows) {
      if (row.verdict == verdict) text += row.what + ": " + row.figure + "; " + row.cause + '\n';
    }
    return text;
  }
  /// Expects a disagreement that contains each of `texts`, and no other.
  void expect_disagreement(const std::vector<std::string>& texts) {
    const std::string rows = rows_of(diagnose(), DiagnosisVerdict::disagrees);
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1) << rows;
    for (const std::string& text : texts) {
      EXPECT_NE(rows.find(text), rows.npos) << "no '" << text << "' in: " << rows;
    }
  }

  /// 4 s of a tool that turns by 60 degrees in the air, and the force of its weight.
  void write_turning_tool(bool in_tool_axes) {
    constexpr double kWeight = 3.0;  // [N]
    std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
    std::string wrench = "t,fx,fy,fz,tx,ty,tz\n";
    for (int i = 0; i < 400; ++i) {
      const double half = 0.5 * std::sin(0.004 * i) * 1.05;
      tool += fmt::format("{:.6f},0.2,0,0.3,0,{:.9f},0,{:.9f}\n", 0.01 * i, std::sin(half),
                          std::cos(half));
      const double turn = in_tool_axes ? 2.0 * half : 0.0;
      wrench += fmt::format("{:.6f},{:.6f},0,{:.6f},0,0,0\n", 0.01 * i + 0.001,
                            kWeight * std::sin(turn) + 0.01 * ((i * 37) % 11 - 5),
                            -kWeight * std::cos(turn) + 0.01 * ((i * 53) % 13 - 6));
    }
    write("tool.csv", tool);
    write("wrench.csv", wrench);
  }
  /// An arm of two joints whose flange the tool is on; joints.csv is `lag` [s] late.
  void write_arm(double lag) {
    write("recording.yaml", std::string(kManifest) + "robot: {urdf: robot.urdf, tip: flange}\n");
    write("robot.urdf", two_joint_urdf());
    std::string tool = "t,x,y,z,qx,qy,qz,qw\n", joints = "t,q_j1,q_j2\n";
    for (int i = 0; i < 400; ++i) {
      const double t = 0.01 * i, q1 = 0.5 * std::sin(3.0 * t), q2 = 0.2 * std::cos(2.0 * t);
      const double angle = 1.0 + q1;
      tool += fmt::format("{:.6f},{:.9f},{:.9f},0.8,0,0,{:.9f},{:.9f}\n", t, -q2 * std::sin(angle),
                          q2 * std::cos(angle), std::sin(0.5 * angle), std::cos(0.5 * angle));
      joints += fmt::format("{:.6f},{:.9f},{:.9f}\n", t + lag, q1, q2);
    }
    write("tool.csv", tool);
    write("joints.csv", joints);
  }
  /// The row of a check.
  DiagnosisRow row(const std::string& what) {
    const DiagnosisReport report = diagnose();
    const auto found = std::find_if(report.rows.begin(), report.rows.end(),
                                    [&](const DiagnosisRow& one) { return one.what == what; });
    EXPECT_NE(found, report.rows.end()) << what;
    return found == report.rows.end() ? DiagnosisRow() : *found;
  }

  TemporaryFolder folder_;
};

TEST_F(Doctor, FindsNothingInSoundInputsAndNamesWhatItCouldNotCheck) {
  const DiagnosisReport report = diagnose();
  EXPECT_FALSE(report.has_disagreement()) << rows_of(report, DiagnosisVerdict::disagrees);
  const std::string agreeing = rows_of(report, DiagnosisVerdict::agrees);
  for (const char* text : {"tool.csv: 400 rows over 3.990 s, 100.0 Hz; no gaps",
                           "CAD of box: closed, 0.1 x 0.1 x 0.1 m, 1 litres, 1000 kg/m^3"}) {
    EXPECT_NE(agreeing.find(text), agreeing.npos) << "no '" << text << "' in: " << agreeing;
  }
  const std::string open = rows_of(report, DiagnosisVerdict::not_checked);
  for (const char* text :
       {"rgb.txt, depth.txt: absent", "groundtruth.txt: absent", "tracking of box: absent",
        "tags, camera and depth: no images", "robot: recording.yaml names no URDF"}) {
    EXPECT_NE(open.find(text), open.npos) << "no '" << text << "' in: " << open;
  }
  EXPECT_TRUE(report.next.starts_with("pcavr identify friction '")) << report.next;
}

TEST_F(Doctor, NamesAGapWithItsLengthAndTime) {
  write_series({.gap_at = 2.0});
  expect_disagreement({"tool.csv: ", "1 gap, the longest of 0.410 s at t = 1.990 s"});
}

TEST_F(Doctor, TellsAClockThatWasSetFromSamplesThatWereLost) {
  const auto write_tool = [this](double set_ahead, double lost) {
    std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
    for (int i = 0; i < 400; ++i) {
      const double at = 0.01 * i, x = 0.1 + 0.05 * at + 1e-5 * ((i * 37) % 11 - 5);
      if (at > 2.0 && at < 2.0 + lost) continue;
      tool += fmt::format("{:.6f},{:.7f},0,0.05,0,0,0,1\n", at + (at > 2.0 ? set_ahead : 0.0), x);
    }
    write("tool.csv", tool);
  };
  write_tool(0.03, 0.0);
  expect_disagreement({"tool.csv: an interval of 40.0 ms at t = 2.000 s, where the others are 10.0",
                       "its clock was set ahead by 30.0 ms"});
  write_tool(-0.006, 0.0);
  expect_disagreement({"tool.csv: an interval of 4.0 ms", "its clock was set back by 6.0 ms"});
  write_tool(0.2, 0.0);
  expect_disagreement({"tool.csv: ", "1 gap", "its clock was set ahead by 200.0 ms"});
  write_tool(0.0, 0.035);
  expect_disagreement({"tool.csv: an interval of 40.0 ms", "samples were lost, or the logger"});
  write_tool(0.0, 0.2);
  expect_disagreement({"tool.csv: ", "1 gap", "samples were lost, or the logger paused"});
}

TEST_F(Doctor, NamesStretchesOfHeldSamples) {
  std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i < 400; ++i) {
    const int k = i > 200 && i < 260 ? i - i % 4 : i;
    tool += fmt::format("{:.6f},{:.7f},0,0.05,0,0,0,1\n", 0.01 * i,
                        0.1 + 0.0005 * k + 1e-5 * ((k * 37) % 11 - 5));
  }
  write("tool.csv", tool);
  expect_disagreement(
      {"tool.csv: ", "45 rows repeat the one before in 15 stretches", "held samples"});
}

TEST_F(Doctor, NamesAForceAtRestAndTheToolWhoseWeightItMayBe) {
  write_series({.bias = -2.943});
  expect_disagreement({"2.94 N without contact", "z -2.94", "a tool of 0.30 kg", "--tare"});
}

TEST_F(Doctor, TellsTheToolsWeightFromABiasByItsOrientations) {
  const std::string what = "gravity of the tool by its orientation";
  EXPECT_EQ(row(what).verdict, DiagnosisVerdict::not_checked);  // it keeps its orientation
  write_turning_tool(false);
  const DiagnosisRow weight = row(what);
  EXPECT_EQ(weight.verdict, DiagnosisVerdict::disagrees) << weight.figure;
  EXPECT_NE(weight.cause.find("a tool of 0.31 kg"), std::string::npos) << weight.cause;
  write_turning_tool(true);
  const DiagnosisRow turned = row(what);
  EXPECT_EQ(turned.verdict, DiagnosisVerdict::disagrees) << turned.figure;
  EXPECT_NE(turned.cause.find("in the sensor's axes"), std::string::npos) << turned.cause;
}

TEST_F(Doctor, ComparesTheJointsWithTheToolThroughTheRobot) {
  const std::string what = "joints.csv against tool.csv through the URDF";
  EXPECT_EQ(row(what).verdict, DiagnosisVerdict::not_checked);
  write_arm(0.0);
  const DiagnosisRow agreeing = row(what);
  EXPECT_EQ(agreeing.verdict, DiagnosisVerdict::agrees) << agreeing.figure;
  EXPECT_NE(agreeing.figure.find("the tool is 0.100 m from link flange"), std::string::npos)
      << agreeing.figure;
  write_arm(0.1);
  const DiagnosisRow late = row(what);
  EXPECT_EQ(late.verdict, DiagnosisVerdict::disagrees) << late.figure;
  EXPECT_NE(late.cause.find("joints.csv is 100 ms later"), std::string::npos) << late.cause;
}

TEST_F(Doctor, StatesWhatACamerasFileSaysOfItself) {
  CameraFile content{
      .name = "camera",
      .camera = {.width = 640, .height = 480, .fx = 525.0, .fy = 525.0, .cx = 319.5, .cy = 239.5}};
  EXPECT_FALSE(diagnose_camera("camera.yaml", content).has_disagreement());
  content.camera.cx = 639.5;  // of twice the resolution
  const DiagnosisReport report = diagnose_camera("camera.yaml", content);
  EXPECT_NE(rows_of(report, DiagnosisVerdict::disagrees).find("of another resolution"),
            std::string::npos);
}

TEST_F(Doctor, NamesJointsInDegrees) {
  write("joints.csv", "t,q_a,q_b\n0,90,-45\n0.01,90.5,-45.1\n0.02,91,-45.2\n");
  expect_disagreement({"unit of joints.csv: positions within +- 91; degrees"});
}

TEST_F(Doctor, NamesAMeshThatCannotBeReadAndChecksTheRest) {
  write("box.obj", "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n");
  expect_disagreement({"box.obj"});
  const DiagnosisReport report = diagnose();
  EXPECT_NE(rows_of(report, DiagnosisVerdict::agrees).find("tool.csv: 400 rows"),
            std::string::npos);
  EXPECT_TRUE(report.next.starts_with("correct what disagrees")) << report.next;
}

TEST_F(Doctor, NamesTheFactorOfStampsInMilliseconds) {
  write_series({.time_unit = 1000.0});
  const std::string rows = rows_of(diagnose(), DiagnosisVerdict::disagrees);
  EXPECT_NE(rows.find("tool.csv: the stamps are probably in milliseconds"), rows.npos) << rows;
}

}  // namespace
}  // namespace pcavr
