// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/results/evaluation/evaluate.hpp"

#include "run_samples.hpp"
#include "support/report_data.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Positions in text files have seven decimals.
constexpr double kFileRounding = 2e-7;

/// The position of the box of one_push(): it slides by 50 mm along y from 1.5 to 2 s.
double true_y(double t) { return 0.05 * std::clamp((t - 1.5) / 0.5, 0.0, 1.0); }

/// 100 poses a second for 4 s, off by `off(t)` along x.
template <typename Off>
Trajectory a_box(Off off) {
  Trajectory box;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.01 * i;
    box.append(at(t), Pose::from_translation({off(t), true_y(t), 0.0}));
  }
  return box;
}

std::vector<std::string> labels_of(const Json& plot) {
  std::vector<std::string> labels;
  for (const Json& series : plot["series"]) labels.push_back(series["label"]);
  return labels;
}

/// A recording with a truth, and a run of it whose every error is known: the prediction is 4 mm
/// off until 1.45 s and 1 mm from then on; the rendered force is 10 % too high; phases are measured
/// 10 ms late and predicted 30 ms late.
class EvaluateRun : public testing::Test {
 protected:
  void SetUp() override {
    write(truth() / "objects/box.txt", format_trajectory(a_box([](double) { return 0.0; })));
    write(truth() / "phase.csv",
          "t,object,phase\n0,box,free\n1.0,box,static\n1.2,box,critical\n1.5,box,sliding\n"
          "2.0,box,static\n2.5,box,free\n");
    write(truth() / "parameters.yaml", "box:\n  mass: 3\n  limiting_static_friction: 10\n");
    write(run() / "run.yaml",
          "format: pcavr-run/1\nrecording: nowhere\nforward_delay: 0.2\nbackward_delay: 0.2\n"
          "traffic: {correction_bytes: 200, streaming_bytes: 20000}\n");
    write(run() / "objects/box/predicted.txt",
          format_trajectory(a_box([](double t) { return t < 1.445 ? 0.004 : 0.001; })));
    write(run() / "objects/box/tracked.txt",
          format_trajectory(a_box([](double) { return 0.0005; })));
    write(run() / "phases.csv",
          "t,object,measured,predicted\n0,box,free,free\n1.01,box,static,free\n"
          "1.03,box,static,static\n1.21,box,critical,static\n1.23,box,critical,critical\n"
          "1.51,box,sliding,critical\n1.53,box,sliding,sliding\n2.01,box,static,sliding\n"
          "2.03,box,static,static\n2.51,box,free,static\n2.53,box,free,free\n");
    write(run() / "force.csv", forces());
    write(run() / "corrections.csv",
          "t,object,case,what,bytes\n1.05,box,2,position,120\n1.1,box,1.1,contact "
          "parameters+lost,80\n");
    write(run() / "parameters.csv",
          "t,object,parameter,running,transmitted\n1.0,box,mass,3.0,3.0\n"
          "1.2,box,mass,3.3,3.0\n1.6,box,mass,3.3,3.3\n");
    write(run() / "parameters.yaml", "box:\n  mass: 3.3\n  mass_std: 0.1\n");
    fs::create_directories(report());
  }

  static std::string forces() {
    std::string text = "t,object,measured,virtual\n";
    for (int i = 0; i <= 300; ++i) {
      const double t = 1.0 + 0.005 * i;
      const double force = 10.0 * std::min(1.0, (t - 1.0) / 0.2);
      text += std::to_string(t) + ",box," + std::to_string(force) + ',' +
              std::to_string(1.1 * force) + '\n';
    }
    return text;
  }

  static void write(const fs::path& file, const std::string& content) {
    fs::create_directories(file.parent_path());
    ASSERT_TRUE(write_file(file, content).has_value());
  }

  [[nodiscard]] Json metrics_against(const fs::path& reference) const {
    const auto json = evaluate({run(), reference}, report(), Parallelism{2});
    if (json) return Json::parse(*json);
    ADD_FAILURE() << json.error().to_string();
    return {};
  }

  /// This run's entry in the row of the papers' table with that source; `number`: of several rows.
  [[nodiscard]] std::string beside(const std::string& source, int number = 1) const {
    (void)metrics_against(truth());
    const Json data = Json::parse(report_data(report()));
    for (const Json& section : data["sections"]) {
      if (section["title"] != "Comparison with the papers") continue;
      for (const Json& row : section["blocks"][0]["tables"][0]["rows"]) {
        if (row[1] == source && --number == 0) return row[3];
      }
    }
    return "no row";
  }

  [[nodiscard]] fs::path truth() const { return folder_.path() / "recording/truth"; }
  [[nodiscard]] fs::path run() const { return folder_.path() / "run"; }
  [[nodiscard]] fs::path report() const { return folder_.path() / "report"; }

  TemporaryFolder folder_;
};

TEST_F(EvaluateRun, SplitsPositionErrorsByPhase) {
  const Json metrics = metrics_against(truth());
  const std::string key = "object.box.predicted.";
  EXPECT_NEAR(metrics[key + "phase.static.translation.median_m"], 0.001, kFileRounding);
  EXPECT_NEAR(metrics[key + "phase.static.translation.max_m"], 0.004, kFileRounding);
  EXPECT_NEAR(metrics[key + "phase.critical.translation.median_m"], 0.004, kFileRounding);
  EXPECT_NEAR(metrics[key + "phase.sliding.translation.rmse_m"], 0.001, kFileRounding);
  EXPECT_NEAR(metrics[key + "moving.translation.median_m"], 0.001, kFileRounding);
  EXPECT_EQ(metrics[key + "touched.translation.count"], 150);
  EXPECT_EQ(metrics[key + "touched.rotation.max_rad"], 0.0);
  // 45 of the 150 poses are 4 mm off.
  EXPECT_NEAR(metrics["predicted.touched.translation.p95_m"], 0.004, kFileRounding);
  EXPECT_NEAR(metrics["predicted.touched.translation.mean_m"], (45 * 0.004 + 105 * 0.001) / 150,
              kFileRounding);
  EXPECT_EQ(metrics["predicted.all.translation.count"], 401);
  EXPECT_NEAR(metrics["object.box.tracked.phase.sliding.translation.median_m"], 0.0005,
              kFileRounding);
}

TEST_F(EvaluateRun, ComparesForcesPhasesAndNodes) {
  const Json metrics = metrics_against(truth());
  EXPECT_NEAR(metrics["force.box.sliding.relative.median"], 0.1, 1e-6);
  EXPECT_NEAR(metrics["force.box.sliding.absolute.rmse_N"], 1.0, 1e-6);
  EXPECT_NEAR(metrics["force.box.in_contact.relative.max"], 0.1, 1e-6);
  EXPECT_NEAR(metrics["phases.measured.boundary.median_s"], 0.01, 1e-9);
  EXPECT_NEAR(metrics["phases.predicted.boundary.p95_s"], 0.03, 1e-9);
  EXPECT_NEAR(metrics["phases.predicted_to_measured.boundary.max_s"], 0.02, 1e-9);
  EXPECT_EQ(metrics["phases.predicted.boundary.missed"], 0);
  EXPECT_EQ(metrics["phases.measured.boundary.surplus"], 0);
  EXPECT_NEAR(metrics["phases.measured.agreement"], 1.0 - 0.05 / 4.0, 1e-9);
  EXPECT_NEAR(metrics["phases.measured.confusion.sliding.critical_s"], 0.01, 1e-9);
  EXPECT_EQ(metrics["nodes.t3.event"], "sliding");
  EXPECT_NEAR(metrics["nodes.t3.truth_s"], 1.5, 1e-9);
  EXPECT_NEAR(metrics["nodes.t3.predicted_s"], 1.53, 1e-9);
  EXPECT_FALSE(metrics.contains("nodes.t6.event"));
}

TEST_F(EvaluateRun, BeginsWithTheMainMetrics) {
  const Json headline = metrics_against(truth())["headline"];
  const auto value_of = [&](const std::string& name) {
    for (const Json& metric : headline) {
      if (metric["name"] == name) return metric["value"].get<double>();
    }
    ADD_FAILURE() << "no " << name;
    return 0.0;
  };
  EXPECT_EQ(headline[0]["name"], "Predicted position error in contact or moving, median");
  EXPECT_NEAR(headline[0]["value"], 1.0, 1e3 * kFileRounding);
  EXPECT_NEAR(value_of("Predicted position error, whole run, max"), 4.0, 1e3 * kFileRounding);
  EXPECT_NEAR(value_of("Rendered force error in contact, median"), 10.0, 1e-4);
  EXPECT_NEAR(value_of("Rendered force error, whole run, max"), 1.0, 1e-5);
  EXPECT_NEAR(value_of("Phase boundaries predicted, 95th percentile of the error"), 30.0, 1e-6);
  EXPECT_NEAR(value_of("Correction bytes relative to streaming"), 1.0, 1e-9);
  EXPECT_NEAR(value_of("box: error of the mass"), 10.0, 1e-9);
}

TEST_F(EvaluateRun, CountsCorrectionsAndTheirEffects) {
  const Json metrics = metrics_against(truth());
  EXPECT_EQ(metrics["corrections.count"], 2);
  EXPECT_EQ(metrics["corrections.lost"], 1);
  EXPECT_EQ(metrics["corrections.bytes"], 200);
  EXPECT_NEAR(metrics["corrections.share_of_streaming"], 0.01, 1e-12);
  EXPECT_EQ(metrics["corrections.bytes_saved"], 19800.0);
  EXPECT_EQ(metrics["corrections.case.1.1"], 1);
  EXPECT_EQ(metrics["corrections.what.position"], 1);
  // The error is within tolerance from 1.45 s on; the correction for 1.05 s arrived at that
  // instant.
  EXPECT_NEAR(metrics["corrections.recovery.median_s"], 0.4, 1e-9);
  EXPECT_EQ(metrics["corrections.object.box.until_good.count"], 1);
  EXPECT_EQ(metrics["corrections.object.box.until_settled.count"], 0);
}

TEST_F(EvaluateRun, ShowsTransmittedBesideRunningParameters) {
  const Json json = metrics_against(truth());
  // The rendered force is 10 % too large throughout.
  EXPECT_EQ(json["history.box.arrival.1.t_s"], 1.6);
  EXPECT_EQ(json["history.box.arrival.1.parameters"], "mass");
  EXPECT_NEAR(json["history.box.arrival.1.force_error_before"].get<double>(), 0.1, 1e-4);
  EXPECT_NEAR(json["history.box.arrival.1.force_error_after"].get<double>(), 0.1, 1e-4);
  const Json data = Json::parse(report_data(report()));
  bool has_plot = false;
  for (const Json& section : data["sections"]) {
    has_plot = has_plot || section["title"] == "box: parameters at both sites";
  }
  EXPECT_TRUE(has_plot);
}

TEST_F(EvaluateRun, ComparesParameters) {
  const Json metrics = metrics_against(truth());
  EXPECT_NEAR(metrics["parameters.box.mass.error_relative"], 0.1, 1e-12);
  EXPECT_NEAR(metrics["parameters.box.mass.error_in_std"], 3.0, 1e-9);
  EXPECT_EQ(metrics["parameters.box.limiting_static_friction.truth"], 10.0);
  EXPECT_FALSE(metrics.contains("parameters.box.limiting_static_friction.value"));

  const auto alone = evaluate({run() / "parameters.yaml", truth()}, report(), Parallelism{1});
  ASSERT_TRUE(alone.has_value()) << alone.error().to_string();
  const Json file = Json::parse(*alone);
  EXPECT_EQ(file["subject_kind"], "parameter file");
  EXPECT_NEAR(file["parameters.box.mass.error_relative"], 0.1, 1e-12);
  const Json page = Json::parse(report_data(report()));
  EXPECT_EQ(page["heading"], "Errors of identified parameters");
  EXPECT_EQ(page["verdict"],
            "Of 1 identified parameters, 0 lie within their stated std of the true value; the "
            "largest error is 3.00 std.");
  const auto nothing = evaluate({run() / "parameters.yaml"}, report(), Parallelism{1});
  ASSERT_FALSE(nothing.has_value());
  EXPECT_NE(nothing.error().hint.find("--truth"), std::string::npos);
}

TEST_F(EvaluateRun, WithoutTruthComparesThePredictionWithTheTracking) {
  const Json metrics = metrics_against({});
  EXPECT_EQ(metrics["reference_kind"], "tracking");
  EXPECT_NEAR(metrics["object.box.predicted.phase.sliding.translation.median_m"], 0.0005,
              kFileRounding);
  EXPECT_FALSE(metrics.contains("object.box.tracked.absolute.translation.max_m"));
  EXPECT_FALSE(metrics.contains("phases.measured.boundary.median_s"));
  EXPECT_NEAR(metrics["phases.predicted_to_measured.boundary.median_s"], 0.02, 1e-9);
  EXPECT_NEAR(metrics["nodes.t1.measured_s"], 1.01, 1e-9);
  EXPECT_FALSE(metrics.contains("nodes.t1.truth_s"));
  EXPECT_EQ(metrics["parameters.box.mass.value"], 3.3);
  EXPECT_FALSE(metrics.contains("parameters.box.mass.error_relative"));
}

TEST_F(EvaluateRun, HandlesAnObjectWithoutContactAndNoCorrections) {
  write(truth() / "phase.csv", "t,object,phase\n0,box,free\n");
  write(run() / "phases.csv", "t,object,measured,predicted\n0,box,free,free\n");
  write(run() / "corrections.csv", "t,object,case,what,bytes\n");
  fs::remove(run() / "force.csv");
  const Json metrics = metrics_against(truth());
  EXPECT_EQ(metrics["corrections.count"], 0);
  EXPECT_EQ(metrics["phases.measured.agreement"], 1.0);
  EXPECT_EQ(metrics["phases.measured.boundary.count"], 0);
  EXPECT_FALSE(metrics.contains("object.box.predicted.touched.translation.max_m"));
  EXPECT_FALSE(metrics.contains("nodes.t1.event"));
  EXPECT_EQ(report_data(report()).find("nan"), std::string::npos);
}

TEST_F(EvaluateRun, HandlesATruthThatLacksAnObject) {
  write(run() / "objects/ball/predicted.txt", format_trajectory(a_box([](double) { return 0.0; })));
  write(run() / "phases.csv",
        "t,object,measured,predicted\n0,ball,free,free\n0,box,free,free\n1,ball,static,static\n");
  write(run() / "force.csv", "t,object,measured,virtual\n1,ball,5,6\n");
  const Json metrics = metrics_against(truth());
  EXPECT_FALSE(metrics.contains("object.ball.predicted.absolute.translation.max_m"));
  EXPECT_NEAR(metrics["force.ball.all.relative.median"], 0.2, 1e-12);
  EXPECT_EQ(metrics["phases.measured.object.box.boundary.missed"], 5);
}

TEST_F(EvaluateRun, ReturnsItsMetricsWithoutWritingThem) {
  const auto metrics = evaluation_metrics({run(), truth()}, Parallelism{1});
  ASSERT_TRUE(metrics.has_value());
  EXPECT_TRUE(fs::is_empty(report()));
  EXPECT_EQ(*evaluate({run(), truth()}, report(), Parallelism{4}), *metrics);
}

TEST_F(EvaluateRun, ShowsPhasesMotionForceAndTheComparisonWithThePapers) {
  (void)metrics_against(truth());
  const std::string text = report_data(report());
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const Json data = Json::parse(text);
  EXPECT_EQ(data["heading"], "Run evaluation");
  const Json& overview = data["sections"][0]["blocks"];
  EXPECT_EQ(overview[0]["title"], "Phases over time");
  EXPECT_EQ(overview[0]["lanes"].size(), 3U);  // truth, measured, predicted
  EXPECT_EQ(overview[1]["tables"][0]["title"], "Time nodes");
  EXPECT_EQ(data["sections"][1]["title"], "box: motion and force");
  const Json& plots = data["sections"][1]["blocks"][0]["plots"];
  ASSERT_EQ(plots.size(), 2U);
  EXPECT_EQ(labels_of(plots[0]), (std::vector<std::string>{"tracked", "true", "predicted"}));
  EXPECT_EQ(labels_of(plots[1]), (std::vector<std::string>{"measured", "rendered (virtual)"}));
  EXPECT_EQ(plots[1]["marks"][2]["label"], "t3");
  EXPECT_EQ(plots[0]["pin_label"], "correction arrives");
  EXPECT_EQ(plots[0]["hollow_pin_label"], "correction lost");
  const auto papers = std::find_if(
      data["sections"].begin(), data["sections"].end(),
      [](const Json& section) { return section["title"] == "Comparison with the papers"; });
  ASSERT_NE(papers, data["sections"].end());
}

TEST_F(EvaluateRun, ComparesWithThePapersOnlyWhatTheRunHas) {
  // The only correction with parameters was lost.
  EXPECT_EQ(beside("C, Fig. 9"), "–");
  EXPECT_EQ(beside("C, Fig. 10").substr(0, 14), "median 1.00 mm");
  EXPECT_NE(beside("C, Fig. 10").find(", with 200 + 200 ms"), std::string::npos);
  EXPECT_EQ(beside("C, table 1"), "–");
  EXPECT_EQ(beside("C, table 2", 2), "box 10.00 %");
  // Nothing is known of the tool: no press, no slotting.
  EXPECT_EQ(beside("B, table 3"), "no row");
  EXPECT_EQ(beside("B, hole slotting"), "no row");
}

TEST_F(EvaluateRun, MeasuresForcesFromTheFirstParametersOn) {
  write(run() / "corrections.csv",
        "t,object,case,what,bytes\n1.6,box,1.3,position+friction parameters,120\n");
  // 20 % too high before 2.0 s, when they arrive.
  std::string text = "t,object,measured,virtual\n";
  for (int i = 0; i <= 100; ++i) {
    const double t = 1.5 + 0.01 * i;
    text += std::to_string(t) + ",box,10," + (t < 1.9999 ? "12" : "10.5") + '\n';
  }
  write(run() / "force.csv", text);
  EXPECT_EQ(beside("C, Fig. 9").substr(0, 13), "median 5.00 %");
  EXPECT_NE(beside("C, Fig. 9").find("max 5.00 %"), std::string::npos);
}

TEST_F(EvaluateRun, StatesTheRunsOwnDelays) {
  write(run() / "run.yaml",
        "format: pcavr-run/1\nrecording: nowhere\nforward_delay: 0.05\nbackward_delay: 0.1\n");
  EXPECT_NE(beside("C, Fig. 11").find(", with 50.0 + 100 ms"), std::string::npos);
  write(run() / "run.yaml",
        "format: pcavr-run/1\nrecording: nowhere\nforward_delay: 0\nbackward_delay: 0\n");
  EXPECT_NE(beside("C, Fig. 11").find(", without delay"), std::string::npos);
}

TEST_F(EvaluateRun, ComparesPressesWithPaperB) {
  // The tip comes down at 20 mm/s on a box that does not slide.
  write(truth() / "phase.csv", "t,object,phase\n0,box,free\n1.0,box,static\n2.5,box,free\n");
  std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i <= 400; ++i) {
    const double z = 0.1 - 0.02 * std::min(0.01 * i, 1.3);
    tool += std::to_string(0.01 * i) + ",0,0," + std::to_string(z) + ",0,0,0,1\n";
  }
  write(truth().parent_path() / "tool.csv", tool);
  write(truth().parent_path() / "recording.yaml", "format: pcavr-recording/1\n");
  // Figure 6 needs a restitution.
  write(run() / "parameters.yaml",
        "box:\n  contact: {stiffness: 2e5, exponent: 1.5, restitution: 0.3, impact_speed: 0.1}\n");
  EXPECT_EQ(beside("B, table 3"), "10.0 % of 1 press");
  EXPECT_EQ(beside("B, hole slotting"), "no row");
  const std::string data = report_data(report());
  EXPECT_NE(data.find("Presses by speed [paper B, table 3]"), std::string::npos);
  EXPECT_NE(data.find("18.35"), std::string::npos);
  EXPECT_NE(data.find("[paper B, figure 6]"), std::string::npos);
  EXPECT_NE(data.find("box: at 0.3"), std::string::npos);
  EXPECT_EQ(data.find("[paper B, table 4]"), std::string::npos);
}

TEST_F(EvaluateRun, ComparesNoImpactWithPaperBsPresses) {
  // The tip comes down at 200 mm/s: no press of B's is faster than 60 mm/s.
  write(truth() / "phase.csv", "t,object,phase\n0,box,free\n1.0,box,static\n2.5,box,free\n");
  std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i <= 400; ++i) {
    const double z = 0.3 - 0.2 * std::min(0.01 * i, 1.02);
    tool += std::to_string(0.01 * i) + ",0,0," + std::to_string(z) + ",0,0,0,1\n";
  }
  write(truth().parent_path() / "tool.csv", tool);
  write(truth().parent_path() / "recording.yaml", "format: pcavr-recording/1\n");
  EXPECT_EQ(beside("B, table 3"), "no row");
  EXPECT_EQ(beside("B, table 4"), "no row");
}

TEST_F(EvaluateRun, ComparesSoftPressesWithPaperBsTable4) {
  // 12 mm deep until the force's peak.
  write(truth() / "phase.csv", "t,object,phase\n0,box,free\n1.0,box,static\n2.5,box,free\n");
  std::string tool = "t,x,y,z,qx,qy,qz,qw\n";
  for (int i = 0; i <= 400; ++i) {
    const double z = 0.1 - 0.06 * std::min(0.01 * i, 1.3);
    tool += std::to_string(0.01 * i) + ",0,0," + std::to_string(z) + ",0,0,0,1\n";
  }
  write(truth().parent_path() / "tool.csv", tool);
  write(truth().parent_path() / "recording.yaml", "format: pcavr-recording/1\n");
  EXPECT_EQ(beside("B, table 4"), "10.0 % of 1 press");
  EXPECT_NE(report_data(report()).find("[paper B, table 4]"), std::string::npos);
  EXPECT_EQ(beside("B, table 3"), "no row");
}

TEST_F(EvaluateRun, HasNoErrorOfAGivenMass) {
  write(run() / "parameters.yaml", "box:\n  mass: 3\n");
  const Json metrics = metrics_against(truth());
  EXPECT_EQ(metrics["parameters.box.mass.source"], "given");
  EXPECT_FALSE(metrics.contains("parameters.box.mass.error_relative"));
  EXPECT_EQ(metrics["headline"].dump().find("error of the mass"), std::string::npos);
  EXPECT_EQ(beside("C, table 2", 2), "box given");
}

TEST_F(EvaluateRun, IsTheSameBytesForAnyNumberOfThreads) {
  (void)metrics_against(truth());
  const std::string data = report_data(report());
  for (const int threads : {1, 4}) {
    ASSERT_TRUE(evaluate({run(), truth()}, report(), Parallelism{threads}).has_value());
    EXPECT_EQ(report_data(report()), data);
  }
}

TEST_F(EvaluateRun, NamesTheLineOfABadFile) {
  write(run() / "force.csv", "t,object,measured,virtual\n1,box,5,soft\n");
  const auto result = evaluate({run(), truth()}, report(), Parallelism{1});
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().line, 2);
  EXPECT_EQ(result.error().file, (run() / "force.csv").string());
}

TEST_F(EvaluateRun, WithoutTruthNeedsAPrediction) {
  fs::remove(run() / "objects/box/predicted.txt");
  const auto result = evaluate({run()}, report(), Parallelism{1});
  ASSERT_FALSE(result.has_value());
  EXPECT_NE(result.error().hint.find("--truth"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
