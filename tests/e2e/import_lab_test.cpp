// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A push as a lab logs it, by three programs into three files, from their import to the friction.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"

#include "support/json_command.hpp"
#include "support/shared_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

constexpr double kFlange = 0.12;      // [m] from the flange to the tip, along the tool's z
constexpr double kSensorTurn = 30.0;  // [deg] of the force sensor about the tool's z
constexpr std::int64_t kStartMs = 1'741'771'234'567;  // 2025-03-12 09:20:34.567 UTC

Eigen::Quaterniond about_z(double degrees) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ()));
}
const Pose& T_base_world() {
  static const Pose kPose(about_z(25.0), Eigen::Vector3d(0.1, 0.4, 0.0));
  return kPose;
}
/// The tracked body's frame in the CAD model's.
const Pose& T_object_tracked() {
  static const Pose kPose(about_z(-40.0), Eigen::Vector3d(0.012, -0.020, 0.045));
  return kPose;
}
std::string text_of(const Pose& pose, char separator) {
  const Eigen::Vector3d& p = pose.translation();
  const Eigen::Quaterniond& q = pose.rotation();
  return fmt::format("{1:.9f}{0}{2:.9f}{0}{3:.9f}{0}{4:.9f}{0}{5:.9f}{0}{6:.9f}{0}{7:.9f}",
                     separator, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

/// The robot's log: the flange's pose, in milliseconds since 1970.
std::string robot_log(const Recording& recording) {
  std::string text = "timestamp_ms,x,y,z,qx,qy,qz,qw\n";
  const Pose T_tip_flange(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, -kFlange));
  for (const TimedPose& tip : recording.tool.poses()) {
    text += fmt::format("{:.3f},{}\n", static_cast<double>(kStartMs) + 1e3 * tip.stamp.seconds(),
                        text_of(tip.pose * T_tip_flange, ','));
  }
  return text;
}

/// The sensor's log: the load on it, in its own axes, with a bias.
std::string force_log(const Recording& recording) {
  std::string text = "Timestamp [ms];Fx [N];Fy [N];Fz [N];Tx [Nm];Ty [Nm];Tz [Nm]\n";
  const Eigen::Quaterniond R_sensor_tool = about_z(-kSensorTurn);
  for (const WrenchSample& sample : recording.wrench) {
    const Pose T_base_tip =
        recording.tool.at(sample.stamp).value_or(recording.tool.poses()[0].pose);
    const Eigen::Quaterniond R_sensor_base = R_sensor_tool * T_base_tip.rotation().conjugate();
    const Eigen::Vector3d f = Eigen::Vector3d(1.2, -3.4, 12.6) - R_sensor_base * sample.force;
    text += fmt::format("{:.3f};{:.6f};{:.6f};{:.6f};0;0;0\n",
                        static_cast<double>(kStartMs) + 1e3 * sample.stamp.seconds(), f.x(), f.y(),
                        f.z());
  }
  return text;
}

/// Motion capture's take of one body: local time, mm, y up.
std::string take_of(const Trajectory& T_base_object, const std::string& body) {
  std::string text =
      "Format Version,1.23,Take Name,push,Capture Frame Rate,100,Export Frame Rate,100,Capture "
      "Start Time,2025-03-12 10.20.34.567 AM,Rotation Type,Quaternion,Length "
      "Units,Millimeters,Coordinate Space,Global\n\n";
  const auto line = [&](const std::vector<std::string>& columns) {
    text += ',';
    for (const std::string& column : columns) text += "," + column;
    text += '\n';
  };
  line(std::vector<std::string>(7, "Rigid Body"));
  line(std::vector<std::string>(7, body));
  line(std::vector<std::string>(7, "\"1\""));
  line({"Rotation", "Rotation", "Rotation", "Rotation", "Position", "Position", "Position"});
  text += "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z\n";
  int frame = 0;
  for (const TimedPose& row : T_base_object.poses()) {
    const Pose seen = T_base_world().inverse() * row.pose * T_object_tracked();
    const Eigen::Vector3d p = 1e3 * seen.translation();
    const Eigen::Quaterniond& q = seen.rotation();
    text += fmt::format("{},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f},{:.6f},{:.6f}\n", frame++,
                        row.stamp.seconds(), q.x(), q.z(), -q.y(), q.w(), p.x(), p.z(), -p.y());
  }
  return text;
}

/// A mesh as CAD programs export it.
std::string in_millimetres(const std::string& obj) {
  std::istringstream lines(obj);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    double x = 0.0, y = 0.0, z = 0.0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
      line = fmt::format("v {} {} {}", 1e3 * x, 1e3 * y, 1e3 * z);
    }
    text += line + '\n';
  }
  return text;
}

class ImportLab : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    run_json({"simulate", "push", "--no-images", "--seed", "12", "-o", path_of("sound")});
    const auto recording = read_recording(path_of("sound"));
    ASSERT_TRUE(recording) << recording.error().to_string();
    const auto poses = read_trajectory(path_of("sound/tracked/objects/box_1/tracked.txt"));
    ASSERT_TRUE(poses) << poses.error().to_string();
    std::filesystem::create_directory(path_of("log"));
    ASSERT_TRUE(write_file(path_of("log/robot.csv"), robot_log(*recording)));
    ASSERT_TRUE(write_file(path_of("log/ft.csv"), force_log(*recording)));
    ASSERT_TRUE(write_file(path_of("log/Take 2025-03-12.csv"), take_of(*poses, "block")));
    ASSERT_TRUE(write_file(path_of("log/block.obj"),
                           in_millimetres(read_file(path_of("sound/objects/box_1.obj")).value())));
    ASSERT_TRUE(write_file(path_of("log/bodies.yaml"),
                           "format: pcavr-recording/1\nobjects:\n  - {name: block, mesh: "
                           "block.obj, unit: mm, mass: " +
                               std::to_string(recording->manifest.objects[0].mass.value()) +
                               ", movable: true}\ntool: {radius: 0.01}\n"));
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path_of(const std::string& name) { return (folder_->path() / name).string(); }
  /// Imports the log, with more options.
  static void import(const std::string& log, const std::string& manifest, const std::string& name,
                     const std::vector<std::string>& more) {
    std::vector<std::string> words{"import", log, "-o", path_of(name)};
    const std::string offset = std::to_string(kFlange);
    words.insert(words.end(),
                 {"--tool-offset", "0", "0", offset, "--wrench-frame", "tool", "--invert-wrench",
                  "--tare", "0.3", "--manifest", manifest, "--T-tracked-object",
                  "block=" + text_of(T_object_tracked().inverse(), ',')});
    words.emplace_back("--T-base-world");
    const Eigen::Vector3d& p = T_base_world().translation();
    const Eigen::Quaterniond& q = T_base_world().rotation();
    for (const double number : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) {
      words.push_back(fmt::format("{:.9f}", number));
    }
    words.insert(words.end(), more.begin(), more.end());
    run_json(words);
  }
  /// [deg] The turn that a command proposes; 0 where it proposes none.
  static std::string named_turn(const CommandOutcome& outcome) {
    std::smatch turn;
    const bool is_named =
        std::regex_search(outcome.standard_error, turn, std::regex("--wrench-turn (-?[0-9.]+)"));
    EXPECT_TRUE(is_named) << outcome.standard_error;
    return is_named ? turn[1].str() : "0";
  }
  static nlohmann::json finding_of(const std::string& recording, const std::string& object) {
    const std::string file = recording + ".yaml";
    run_json({"identify", "friction", path_of(recording), "-o", path_of(file)});
    return coefficient_in(file, object);
  }
  static nlohmann::json coefficient_in(const std::string& file, const std::string& object) {
    const std::string text = read_file(path_of(file)).value();
    const std::size_t begin = text.find("\n" + object + ":");
    EXPECT_NE(begin, text.npos) << text;
    const auto number = [&](const std::string& key) {
      return std::stod(text.substr(text.find(key, begin) + key.size()));
    };
    return {{"value", number("sliding_friction_coefficient: ")},
            {"std", number("sliding_friction_coefficient_std: ")}};
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ImportLab::folder_ = nullptr;

TEST_F(ImportLab, InspectNamesEachFileAndTheNextCommand) {
  const CommandOutcome outcome = run_pcavr({"inspect", path_of("log")});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* text : {"block", "ft", "robot", "[wrench]",
                           "not read, as no CSV files: block.obj", "next: pcavr import"}) {
    EXPECT_NE(outcome.standard_output.find(text), std::string::npos) << outcome.standard_output;
  }
}

TEST_F(ImportLab, TheSensorsTurnIsFoundAndTheFrictionIsThatOfTheSoundRecording) {
  import(path_of("log"), path_of("log/bodies.yaml"), "as_logged", {});
  // A warning, as only one contact shows it; several are refused.
  const CommandOutcome warned =
      run_pcavr({"identify", "friction", path_of("as_logged"), "-o", path_of("warned.yaml")});
  EXPECT_EQ(warned.exit_code, 0);
  const std::string turn = named_turn(warned);
  EXPECT_NEAR(std::stod(turn), kSensorTurn, 2.0);
  import(path_of("log"), path_of("log/bodies.yaml"), "turned", {"--wrench-turn", turn});
  const nlohmann::json found = finding_of("turned", "block");
  const nlohmann::json sound = finding_of("sound", "box_1");
  const auto friction = sound["value"].get<double>();
  EXPECT_NEAR(found["value"].get<double>(), friction, sound["std"].get<double>());
  // What the warning says may be wrong is withheld, or covered.
  const nlohmann::json doubted = coefficient_in("warned.yaml", "block");
  EXPECT_NEAR(doubted["value"].get<double>(), friction, 1.5 * doubted["std"].get<double>());
  EXPECT_EQ(read_file(path_of("warned.yaml"))->find("tool_friction"), std::string::npos);
}

/// Eight contacts of a plant that shares no code with pcavr.
TEST_F(ImportLab, ATurnThatSeveralContactsShowIsRefused) {
  PCAVR_NEEDS_SHARED_DATA("lab_log/probe-1");
  const std::string log = shared_data("lab_log/probe-1").string();
  std::filesystem::create_directory(path_of("shared"));
  std::filesystem::copy_file(shared_data("lab_log/body.obj"), path_of("shared/body.obj"));
  ASSERT_TRUE(write_file(path_of("shared/bodies.yaml"),
                         "format: pcavr-recording/1\nobjects:\n  - {name: block, mesh: body.obj, "
                         "mass: 1.2515, movable: true}\ntool: {radius: 0.01}\n"));
  import(log, path_of("shared/bodies.yaml"), "shared_as_logged", {});
  const CommandOutcome refused = run_pcavr(
      {"identify", "friction", path_of("shared_as_logged"), "-o", path_of("refused.yaml")});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(path_of("refused.yaml")));
  const std::string turn = named_turn(refused);
  EXPECT_NEAR(std::stod(turn), kSensorTurn, 1.0);
  import(log, path_of("shared/bodies.yaml"), "shared_turned", {"--wrench-turn", turn});
  const nlohmann::json found = finding_of("shared_turned", "block");
  EXPECT_NEAR(found["value"].get<double>(), 0.2308, 2.0 * found["std"].get<double>());
  EXPECT_LT(found["std"].get<double>(), 0.01);
}

}  // namespace
}  // namespace pcavr
