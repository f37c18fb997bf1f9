// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/csv_series.hpp"

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/bag_survey.hpp"
#include "pcavr/recordings/bag_import/import_bag.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {
namespace fs = std::filesystem;

/// A square block of 100 mm is pushed by a tip of 5 mm, once from below and once from the left, and
/// turns by half a radian each time. The tracker stands 0.4 m away, turned by 0.3 rad; its block is
/// seen 20 ms before the row of the tip. Logs as by robots: three files a run, the sensor upside
/// down and with an offset, forces on the tool.
struct CsvTwin {
  static constexpr double kStart = 1'700'000'000.0, kDelay = 0.020, kRadius = 0.005, kHalf = 0.05;
  static constexpr int kRows = 400;  // at 100 Hz; contact from 1 s to 3.5 s

  static Pose T_base_world() {
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(0.4, -0.1, 0.02));
  }
  static Eigen::Quaterniond upside_down() { return {0.0, std::sqrt(0.5), std::sqrt(0.5), 0.0}; }
  /// The fraction of the push that is done.
  static double progress(double t) {
    const double s = std::clamp((t - 1.0) / 2.5, 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
  }
  static bool is_touched(double t) { return t > 1.0 && t < 3.5; }

  int side = 0;              ///< 0: its lower side is pushed, 1: its left one
  double turn = 1.0;         ///< factor; 0: it is pushed straight on
  double compression = 0.0;  ///< [m] by which tip and side give way while they touch

  [[nodiscard]] Pose T_base_object(double t) const {
    const double s = progress(t);
    const Eigen::Vector3d way =
        side == 0 ? Eigen::Vector3d(0.02, 0.15, 0.0) : Eigen::Vector3d(0.15, -0.02, 0.0);
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd((side == 0 ? 0.5 : -0.6) * turn * s,
                                                     Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(0.3, 0.1, 0.0) + s * way);
  }
  /// The tip is on the side, moving along it; before and after the push it is away from it.
  [[nodiscard]] Eigen::Vector3d p_base_tip(double t) const {
    const double away = std::max(0.0, 1.0 - t) + std::max(0.0, t - 3.5);
    const double along = 0.01 - 0.03 * progress(t);
    const double pressed = is_touched(t) ? compression : 0.0;
    const double off = -kHalf - kRadius - 0.05 * away + pressed;
    const Eigen::Vector3d p_object =
        side == 0 ? Eigen::Vector3d(along, off, 0.02) : Eigen::Vector3d(off, along, 0.02);
    return T_base_object(t) * p_object;
  }

  void write(const fs::path& prefix) const {
    std::string tip = "t_bag,t_header,x,y,z,qx,qy,qz,qw\n", object = tip;
    std::string force = "t_bag,t_header,fx,fy,fz,tx,ty,tz\n";
    const Eigen::Quaterniond q = upside_down();
    const auto row = [](double t, const Eigen::Vector3d& p, const auto& rest) {
      char text[300];
      const int size = std::snprintf(
          text, sizeof(text), "%.9f,%.9f,%.9f,%.9f,%.9f,%.12f,%.12f,%.12f", kStart + t + 0.003,
          kStart + t, p.x(), p.y(), p.z(), rest[0], rest[1], rest[2]);
      return std::string(text, static_cast<std::size_t>(size));
    };
    for (int i = 0; i < kRows; ++i) {
      const double t = 0.01 * i;
      tip += row(t, p_base_tip(t - kDelay), q.vec()) + "," + std::to_string(q.w()) + "\n";
      const Pose seen = T_base_world().inverse() * T_base_object(t);
      object += row(t, seen.translation(), seen.rotation().vec()) + "," +
                std::to_string(seen.rotation().w()) + "\n";
      const Eigen::Vector3d on_object =
          is_touched(t)
              ? Eigen::Vector3d((side == 0 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX()) *
                                2.0)
              : Eigen::Vector3d::Zero();
      const Eigen::Vector3d seen_force =
          Eigen::Vector3d(0.1, -2.1, 0.9) - q.conjugate() * on_object;
      force += row(t, seen_force, Eigen::Vector3d(0.01, 0.02, 0.03)) + "\n";
    }
    ASSERT_TRUE(write_file(prefix.string() + "_tip.csv", tip));
    ASSERT_TRUE(write_file(prefix.string() + "_obj.csv", object));
    ASSERT_TRUE(write_file(prefix.string() + "_ft.csv", force));
  }
};

class CsvSeriesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    CsvTwin{.side = 0}.write(folder_.path() / "run_1");
    CsvTwin{.side = 1}.write(folder_.path() / "run_10");
    fs::create_directory(folder_.path() / "out");
    options_.topics.wrench_topic = "ft";
    options_.topics.wrench_frame = "tool";
    options_.topics.objects = {{"block", "obj"}};
    options_.invert_wrench = true;
    options_.tare = 0.5;
    options_.manifest = folder_.path() / "bodies.yaml";
    ASSERT_TRUE(write_file(options_.manifest,
                           "format: pcavr-recording/1\nobjects:\n  - {name: block, mesh: b.obj}\n"
                           "tool: {radius: 0.005}\n"));
    ASSERT_TRUE(write_file(folder_.path() / "b.obj", "v 0 0 0\n"));
    const double h = CsvTwin::kHalf;
    options_.pushed_sides =
        PushedSides{.outline_object = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}},
                    .middle_object = 0.02,
                    .tip_radius = CsvTwin::kRadius};
  }
  [[nodiscard]] fs::path run(const char* name) const { return folder_.path() / name; }
  [[nodiscard]] fs::path out() const { return folder_.path() / "out"; }

  const TemporaryFolder folder_;
  BagImportOptions options_;
};

TEST_F(CsvSeriesTest, FilesAreTopicsOfTheRunThatIsNamed) {
  EXPECT_TRUE(has_csv_series(run("run_1")));
  EXPECT_FALSE(has_csv_series(run("run_2")));
  const Expected<BagSurvey> survey = survey_bag(run("run_1"));
  ASSERT_TRUE(survey);
  ASSERT_EQ(survey->topics.size(), 3U);  // not those of run_10
  EXPECT_EQ(survey->topics[0].topic.name, "ft");
  EXPECT_EQ(survey->topics[0].kind, RosMessageKind::wrench);
  EXPECT_EQ(survey->topics[2].kind, RosMessageKind::pose);
  EXPECT_EQ(survey->topics[2].messages, 400U);
  EXPECT_NEAR(*survey->topics[2].delay, 0.003, 1e-6);
}

TEST_F(CsvSeriesTest, ARecordingIsNoRun) {
  ASSERT_TRUE(write_file(out() / "recording.yaml", "format: pcavr-recording/1\n"));
  ASSERT_TRUE(write_file(out() / "tool.csv", "t,x,y,z,qx,qy,qz,qw\n"));
  EXPECT_FALSE(has_csv_series(out()));
}

TEST_F(CsvSeriesTest, ABadRowIsNamed) {
  ASSERT_TRUE(write_file(folder_.path() / "run_3_tip.csv", "t,x,y,z\n1,2,3,4\n2,3,four,5\n"));
  const Expected<BagSurvey> survey = survey_bag(run("run_3"));
  ASSERT_FALSE(survey);
  EXPECT_EQ(survey.error().line, 3);
  EXPECT_NE(survey.error().message.find("four"), std::string::npos);
}

/// The samples of a wrench in a file of one row, in SI.
std::vector<double> wrench_of(const fs::path& folder, const std::string& text,
                              bool skip_bad = false) {
  EXPECT_TRUE(write_file(folder / "dialect_ft.csv", text));
  auto reader = open_csv_series(folder / "dialect", {.skip_bad = skip_bad});
  EXPECT_TRUE(reader) << reader.error().to_string();
  std::vector<double> numbers;
  for (;;) {
    const auto message = (*reader)->next();
    EXPECT_TRUE(message) << message.error().to_string();
    if (!message || !*message) return numbers;
    const auto decoded = decode_ros_message((*reader)->topics()[0], (*message)->payload);
    EXPECT_TRUE(decoded);
    const auto& wrench = std::get<RosWrench>(*decoded);
    numbers.push_back((*message)->log_time.seconds());
    for (const auto& vector : {wrench.force, wrench.torque}) {
      for (int i = 0; i < 3; ++i) numbers.push_back(vector[i]);
    }
  }
}

TEST_F(CsvSeriesTest, DialectsAreReadAlike) {
  const std::vector<double> expected{2.5, 1.0, -2.0, 0.5, 0.25, 0.0, -0.75};
  for (const char* text :
       {"t,fx,fy,fz,tx,ty,tz\n2.5,1,-2,0.5,0.25,0,-0.75\n",
        "t;fx;fy;fz;tx;ty;tz\n2.5;1;-2;0.5;0.25;0;-0.75\n",
        "t;fx;fy;fz;tx;ty;tz\n2,5;1;-2;0,5;0,25;0;-0,75\n",
        "t\tfx\tfy\tfz\ttx\tty\ttz\r\n2.5\t1\t-2\t0.5\t0.25\t0\t-0.75\r\n",
        "# t fx fy fz tx ty tz\n 2.5  1 -2 0.5 0.25 0 -0.75\n# end\n",
        "\xEF\xBB\xBF\"t\",\"fx\",\"fy\",\"fz\",\"tx\",\"ty\",\"tz\"\n"
        "\"2,5\",\"1\",\"-2\",\"0,5\",\"0.25\",0,-0.75\n",
        "Timestamp [ms];Fx [N];Fy [N];Fz [N];Tx [Nm];Ty [Nm];Tz "
        "[Nm]\n2500.0;1;-2;0.5;0.25;0;-0.75\n",
        "time_us,force_x,force_y,force_z,torque_x_nmm,torque_y_nmm,torque_z_nmm\n"
        "2500000,1,-2,0.5,250,0,-750\n",
        "Time (s),Force.X,Force.Y,Force.Z,Mx,My,Mz,valid\n2.5,1,-2,0.5,0.25,0,-0.75,yes\n"}) {
    EXPECT_EQ(wrench_of(folder_.path(), text), expected) << text;
  }
}

TEST_F(CsvSeriesTest, StampsSince1970MayBeInAnyUnit) {
  for (const char* stamp : {"1700000000.033333", "1700000000033.333", "1700000000033333",
                            "1700000000033333000", "1700000000033333000.000"}) {
    const std::string text = std::string("t,fx,fy,fz,tx,ty,tz\n") + stamp + ",1,2,3,4,5,6\n";
    ASSERT_TRUE(write_file(folder_.path() / "dialect_ft.csv", text));
    auto reader = open_csv_series(run("dialect"));
    ASSERT_TRUE(reader);
    const auto message = (*reader)->next();
    ASSERT_TRUE(message) << message.error().to_string();
    ASSERT_TRUE(*message);
    EXPECT_EQ((*message)->log_time, Stamp{1'700'000'000'033'333'000}) << stamp;
    ASSERT_TRUE((*reader)->next());
    EXPECT_EQ((*reader)->warnings().size(), std::string(stamp).find(".03") == 10 ? 0U : 1U);
  }
}

TEST_F(CsvSeriesTest, AStampOfNoUnitIsNamed) {
  ASSERT_TRUE(write_file(folder_.path() / "dialect_tip.csv", "t,x,y,z\n55000000000,1,2,3\n"));
  const Expected<BagSurvey> survey = survey_bag(run("dialect"));
  ASSERT_FALSE(survey);
  EXPECT_EQ(survey.error().line, 2);
  EXPECT_NE(survey.error().hint.find("time_ms"), std::string::npos);
}

TEST_F(CsvSeriesTest, AnUnknownUnitIsNamed) {
  ASSERT_TRUE(write_file(folder_.path() / "dialect_ft.csv",
                         "t,Fx [lbf],Fy [lbf],Fz [lbf],Tx,Ty,Tz\n1,1,2,3,4,5,6\n"));
  const Expected<BagSurvey> survey = survey_bag(run("dialect"));
  ASSERT_FALSE(survey);
  EXPECT_NE(survey.error().message.find("'lbf' of column 'Fx [lbf]'"), std::string::npos);
}

TEST_F(CsvSeriesTest, ARowOfNanIsNamedOrSkipped) {
  const std::string text =
      "t,fx,fy,fz,tx,ty,tz\n1,nan,nan,nan,nan,nan,nan\n2,1,2,3,4,5,6\n3,1,2,3\n";
  EXPECT_EQ(wrench_of(folder_.path(), text, true), (std::vector<double>{2, 1, 2, 3, 4, 5, 6}));
  const Expected<BagSurvey> strict = survey_bag(run("dialect"));
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().line, 2);
  EXPECT_NE(strict.error().message.find("'nan' is not a finite number"), std::string::npos);
  EXPECT_NE(strict.error().hint.find("--skip-bad"), std::string::npos);
  const Expected<BagSurvey> lenient = survey_bag(run("dialect"), {}, {.skip_bad = true});
  ASSERT_TRUE(lenient);
  ASSERT_EQ(lenient->warnings.size(), 1U);
  EXPECT_NE(lenient->warnings[0].find("2 rows are skipped, the first: line 2"), std::string::npos);
}

TEST_F(CsvSeriesTest, ColumnsThatAreNotKnownAreNamed) {
  ASSERT_TRUE(write_file(folder_.path() / "dialect_a.csv", "when;up;down\n1;2;3\n"));
  const auto unknown = unknown_csv_columns(run("dialect"));
  ASSERT_TRUE(unknown);
  EXPECT_NE(unknown->message.find("when, up, down"), std::string::npos);
  EXPECT_FALSE(unknown_csv_columns(run("run_1")));
}

TEST_F(CsvSeriesTest, WorldAndDelayAreFoundByContact) {
  options_.world_bags = {run("run_10")};
  const Expected<BagImportReport> report = import_bag(run("run_1"), out(), options_);
  ASSERT_TRUE(report) << report.error().to_string();
  ASSERT_TRUE(report->world.has_value());
  const Pose error = CsvTwin::T_base_world().inverse() * report->world->T_base_world;
  EXPECT_LT(error.translation().norm(), 2e-4);
  EXPECT_LT(error.log().tail<3>().norm(), 1e-3);
  EXPECT_NEAR(report->world->tool_delay, CsvTwin::kDelay, 1e-3);
  EXPECT_LT(report->world->residual, 1e-4);
  const auto recording = read_recording(out());
  ASSERT_TRUE(recording) << recording.error().to_string();
}

TEST_F(CsvSeriesTest, ForcesAreTaredAndTurnedFromTheToolsAxes) {
  options_.world_bags = {run("run_10")};
  const Expected<BagImportReport> report = import_bag(run("run_1"), out(), options_);
  ASSERT_TRUE(report) << report.error().to_string();
  const auto text = read_file(out() / "wrench.csv");
  ASSERT_TRUE(text);
  const std::string row = text->substr(text->find("1700000002.0"));
  double t = 0, fx = 1, fy = 0, fz = 1;
  ASSERT_EQ(std::sscanf(row.c_str(), "%lf,%lf,%lf,%lf", &t, &fx, &fy, &fz), 4);
  EXPECT_NEAR(fx, 0.0, 1e-6);
  EXPECT_NEAR(fy, 2.0, 1e-6);
  EXPECT_NEAR(fz, 0.0, 1e-6);
}

TEST_F(CsvSeriesTest, ATurnedSensorIsTurnedBack) {
  options_.pushed_sides.reset();
  options_.wrench_turn = 0.5 * std::numbers::pi;
  ASSERT_TRUE(import_bag(run("run_1"), out(), options_));
  const auto recording = read_recording(out());
  ASSERT_TRUE(recording) << recording.error().to_string();
  // The tool is upside down: its x is base's y, and its y base's x.
  const Eigen::Vector3d force = recording->wrench[200].force;
  EXPECT_LT((force - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 1e-6) << force.transpose();
  options_.topics.wrench_frame.clear();
  const auto refused = import_bag(run("run_1"), out(), options_);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().place, "--wrench-turn");
}

TEST_F(CsvSeriesTest, TheGivenWorldPlacesTheObjectAndItsStart) {
  options_.pushed_sides.reset();
  options_.T_base_world = CsvTwin::T_base_world();
  options_.tool_delay = CsvTwin::kDelay;
  const Expected<BagImportReport> report = import_bag(run("run_1"), out(), options_);
  ASSERT_TRUE(report) << report.error().to_string();
  const auto manifest = read_file(out() / "recording.yaml");
  ASSERT_TRUE(manifest);
  EXPECT_NE(manifest->find("pose"), std::string::npos);
  const auto tracked = read_trajectory(out() / "tracked/objects/block/tracked.txt");
  ASSERT_TRUE(tracked);
  const Pose error = CsvTwin{}.T_base_object(2.0).inverse() * tracked->poses()[200].pose;
  EXPECT_LT(error.translation().norm(), 1e-6);
  const auto tool = read_file(out() / "tool.csv");
  ASSERT_TRUE(tool);
  EXPECT_NE(tool->find("1699999999.98"), std::string::npos);
}

TEST_F(CsvSeriesTest, APushThatDoesNotTurnTheObjectIsRefused) {
  CsvTwin{.side = 0, .turn = 0.0}.write(run("run_4"));
  const Expected<BagImportReport> report = import_bag(run("run_4"), out(), options_);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().place, "--find-world");
  EXPECT_NE(report.error().message.find("is known to"), std::string::npos);
}

TEST_F(CsvSeriesTest, TheWorldIsFoundWhereTheContactGivesWay) {
  CsvTwin{.side = 0, .compression = 0.004}.write(run("run_1"));
  CsvTwin{.side = 1, .compression = 0.004}.write(run("run_10"));
  options_.world_bags = {run("run_10")};
  const Expected<BagImportReport> report = import_bag(run("run_1"), out(), options_);
  ASSERT_TRUE(report) << report.error().to_string();
  const Pose error = CsvTwin::T_base_world().inverse() * report->world->T_base_world;
  EXPECT_LT(error.translation().head<2>().norm(), 3.0 * report->world->position_std + 1e-4);
  EXPECT_NEAR(report->world->tool_delay, CsvTwin::kDelay, 3.0 * report->world->delay_std + 1e-3);
}

TEST_F(CsvSeriesTest, APushThatTurnsTheObjectALittleShowsNoPlaceAlongItsSide) {
  for (const double turn : {0.01, 0.03, 0.1}) {
    CsvTwin{.side = 0, .turn = turn, .compression = 0.002}.write(run("run_4"));
    const Expected<BagImportReport> report = import_bag(run("run_4"), out(), options_);
    if (!report) continue;
    const Pose error = CsvTwin::T_base_world().inverse() * report->world->T_base_world;
    EXPECT_LT(error.translation().norm(), 3.0 * report->world->position_std) << turn;
  }
}

TEST_F(CsvSeriesTest, ForcesInTheAirFindNoWorld) {
  options_.tare = 0.0;
  options_.topics.wrench_topic.clear();
  fs::remove(folder_.path() / "run_1_ft.csv");
  const Expected<BagImportReport> report = import_bag(run("run_1"), out(), options_);
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("0 samples"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
