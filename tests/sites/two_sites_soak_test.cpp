// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "sites/soak/two_sites_soak.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "sites/soak/soak_checker.hpp"
#include "support/heap_watermark.hpp"

namespace pcavr {
namespace {

constexpr double kDuration = 75.0;            // [s] of virtual time
constexpr double kDurationOfRepeat = 40.0;    // [s]
constexpr std::size_t kMaxHeap = 60'000'000;  // bytes above the use at the start
constexpr std::size_t kMaxRest = 100'000;     // bytes after both sites have ended

std::string lines(const std::vector<std::string>& violations) {
  std::string text;
  for (const std::string& violation : violations) text += violation + '\n';
  return text;
}

class TwoSitesSoak : public testing::TestWithParam<std::uint64_t> {};

TEST_P(TwoSitesSoak, HoldsThroughRandomFaults) {
  const SoakReport report = run_two_sites_soak(
      {.seed = GetParam(), .duration = kDuration, .heap_bytes = [] { return heap_bytes.load(); }});
  EXPECT_TRUE(report.violations.empty()) << lines(report.violations);
  EXPECT_GE(report.faults.size(), 4U);
  EXPECT_GT(report.sessions, 2U);
  EXPECT_GT(report.commands, 20'000U);
  EXPECT_GT(report.corrections, 5U);
  EXPECT_GT(report.path, 1.0);
  EXPECT_LT(report.heap_peak, kMaxHeap);
  EXPECT_LT(report.heap_rest, kMaxRest);
}
INSTANTIATE_TEST_SUITE_P(Seeds, TwoSitesSoak, testing::Values(1, 3, 4));

TEST(TwoSitesSoakRun, CanBeReproducedToTheBit) {
  const SoakOptions options{.seed = 2, .duration = kDurationOfRepeat};
  const std::uint64_t first = run_two_sites_soak(options).digest;
  EXPECT_EQ(run_two_sites_soak(options).digest, first);
  SoakOptions other = options;
  other.seed = 5;
  other.duration = 1.0;
  EXPECT_NE(run_two_sites_soak(other).digest, first);
}

/// Two sites that do nothing wrong: one command sent and executed, one correction sent and applied.
class SoakCheckerTest : public testing::Test {
 protected:
  SoakCheckerTest() {
    checker_.authorize("key");
    checker_.on_robot_start(0.0);
    checker_.on_session(1.0, 7, "key");
    checker_.on_commanded(1.0, 7, command_);
    checker_.on_delivered(1.02, 1.0);
    checker_.on_composed(1.0, 7, correction_);
    checker_.on_composed(1.01, 7, later_);
  }
  [[nodiscard]] bool has(const std::string& part) const {
    return checker_.violations().size() == 1 &&
           checker_.violations().front().find(part) != std::string::npos;
  }

  LinkCommand command_{.t = 5.0, .is_engaged = true};
  LinkCorrection correction_{1, 4.0, 4.0, {1, 2, 3}};
  LinkCorrection later_{2, 4.1, 4.1, {4}};
  SoakChecker checker_{SoakChecker::Options()};
};

TEST_F(SoakCheckerTest, AcceptsWhatIsRight) {
  checker_.on_executed(1.03, 7, "key", command_);
  checker_.on_applied(1.04, 7, later_, true);  // together, in the order of their times
  checker_.on_applied(1.04, 7, correction_, true);
  checker_.on_setpoint(1.040, {0.0, 0.0, 0.0});
  checker_.on_setpoint(1.041, {5e-6, 0.0, 0.0});
  checker_.check_recovered(1.1);
  EXPECT_TRUE(checker_.violations().empty()) << lines(checker_.violations());
}

TEST_F(SoakCheckerTest, NoticesAStaleCommand) {
  checker_.on_executed(2.5, 7, "key", command_);
  EXPECT_TRUE(has("after it was sent"));
}

TEST_F(SoakCheckerTest, NoticesARepeatedCommand) {
  checker_.on_executed(1.03, 7, "key", command_);
  checker_.on_session(1.04, 7, "key");  // forgets the order, not the command
  checker_.on_executed(1.05, 7, "key", command_);
  EXPECT_TRUE(has("or twice"));
}

TEST_F(SoakCheckerTest, NoticesACommandOfAnotherSession) {
  checker_.on_session(1.02, 8, "key");
  checker_.on_executed(1.03, 7, "key", command_);
  EXPECT_TRUE(has("of another session"));
}

TEST_F(SoakCheckerTest, NoticesACommandOfARevokedKey) {
  checker_.revoke(0.4, "key");
  checker_.on_executed(1.03, 7, "key", command_);
  EXPECT_TRUE(has("revoked 0.630 s before"));
}

TEST_F(SoakCheckerTest, NoticesASessionOfARevokedKey) {
  checker_.revoke(1.0, "key");
  checker_.on_session(1.1, 9, "key");
  EXPECT_TRUE(has("not authorised"));
}

TEST_F(SoakCheckerTest, NoticesALostCorrection) {
  checker_.on_executed(1.03, 7, "key", command_);
  checker_.on_applied(1.04, 7, later_, true);
  checker_.check_recovered(1.1);
  EXPECT_TRUE(has("correction 1 of session 7 was lost"));
}

TEST_F(SoakCheckerTest, NoticesACorrectionThatIsNeverApplied) {
  checker_.on_applied(1.04, 7, correction_, true);
  LinkCommand recent = command_;
  recent.t = 9.0;
  checker_.on_commanded(4.9, 7, recent);
  checker_.on_executed(4.95, 7, "key", recent);
  checker_.check_recovered(5.0);
  EXPECT_TRUE(has("correction 2 has not been applied"));
}

TEST_F(SoakCheckerTest, NoticesADoubledCorrection) {
  checker_.on_applied(1.04, 7, correction_, true);
  checker_.on_applied(1.05, 7, correction_, true);
  EXPECT_TRUE(has("applied twice"));
}

TEST_F(SoakCheckerTest, NoticesMotionInSilence) {
  checker_.on_setpoint(1.500, {0.0, 0.0, 0.0});
  checker_.on_setpoint(1.501, {1e-6, 0.0, 0.0});
  EXPECT_TRUE(has("after the last message"));
}

TEST_F(SoakCheckerTest, NoticesExceededLimits) {
  const MotionLimits limits;
  checker_.on_setpoint(1.100, {limits.max_x + 1e-6, 0.0, 0.0});
  EXPECT_TRUE(has("outside the workspace"));
}

TEST_F(SoakCheckerTest, NoticesThatTheToolPressesOn) {
  const MotionLimits limits;
  const Eigen::Vector3d force(limits.max_force + 1.0, 0.0, 0.0);
  checker_.on_force(1.1, force);
  const auto move = [this](double speed) {  // [m/s]
    for (int i = 0; i < 200; ++i) {
      checker_.on_setpoint(1.1 + 1e-3 * i, {1e-3 * speed * i, 0.0, 0.0});
    }
  };
  move(-0.01);
  EXPECT_TRUE(checker_.violations().empty()) << lines(checker_.violations());
  checker_.on_robot_start(1.1);
  checker_.on_force(1.1, force);
  move(0.0015);
  EXPECT_TRUE(has("presses on by 0.10 mm with 61.0 N"));
}

// A tool that leaves what it presses moves along an outlier of the force until it has stopped.
TEST_F(SoakCheckerTest, GivesTimeToStopToAForceThatTurns) {
  const MotionLimits limits;
  const Eigen::Vector3d force(limits.max_force + 1.0, 0.0, 0.0);
  checker_.on_force(1.1, force);
  const auto leave = [this](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      checker_.on_setpoint(1.1 + 1e-3 * i, {-1e-3 * 0.01 * i, 0.0, 0.0});
    }
  };
  leave(0, 150);
  checker_.on_force(1.25, -force);
  leave(150, 200);
  EXPECT_TRUE(checker_.violations().empty()) << lines(checker_.violations());
  leave(200, 270);
  EXPECT_TRUE(has("presses on by"));
}

TEST_F(SoakCheckerTest, NoticesASpeedThatTheStepForbids) {
  SoakChecker::Options options;
  options.limits.max_step = 0.005;  // 0.22 m/s
  checker_ = SoakChecker(options);
  checker_.on_robot_start(1.0);
  checker_.on_delivered(1.0, 1.0);
  for (int i = 0; i < 90; ++i) checker_.on_setpoint(1.0 + 1e-3 * i, {2.2e-4 * i, 0.0, 0.0});
  EXPECT_TRUE(checker_.violations().empty()) << lines(checker_.violations());
  checker_.on_robot_start(1.1);
  for (int i = 0; i < 90; ++i) checker_.on_setpoint(1.1 + 1e-3 * i, {2.5e-4 * i, 0.0, 0.0});
  ASSERT_FALSE(checker_.violations().empty());
  EXPECT_NE(checker_.violations().front().find("the setpoint moved"), std::string::npos);
}

/// [bytes] each second of half an hour, of a process that starts anew after some 40 s: its windows
/// fill at 0.1 MB/s until they are full, `window` [s]. `leak` [bytes/s] beyond that.
std::vector<std::size_t> heap_of_lives(double mean_life, double window, double leak) {
  Random random(11);
  std::vector<std::size_t> samples;
  double age = 0.0, life = 0.0;
  for (int second = 0; second < 1800; ++second, age += 1.0) {
    if (age >= life) {
      age = 0.0;
      life = -mean_life * std::log(1.0 - random.uniform());
    }
    samples.push_back(300'000 + static_cast<std::size_t>(1e5 * std::min(age, window) +
                                                         leak * static_cast<double>(second)));
  }
  return samples;
}

TEST(SoakHeap, DoesNotGrowAsWindowsFill) {
  const double kMeanLife = 40.0;
  EXPECT_FALSE(heap_grows(heap_of_lives(kMeanLife, 600.0, 0.0)));
  std::vector<std::size_t> samples = heap_of_lives(kMeanLife, 600.0, 0.0);
  std::fill(samples.end() - 300, samples.end(), 60'000'000);  // an old process at the end
  EXPECT_FALSE(heap_grows(samples));
}

TEST(SoakHeap, GrowsByALeakThatOutlivesProcesses) {
  EXPECT_TRUE(heap_grows(heap_of_lives(40.0, 600.0, 1000.0)));
}

TEST(SoakHeap, GrowsByALeakInAProcessOnceItsWindowsAreFull) {
  const double kForever = 1e9, kWindow = 300.0;
  for (const double leak : {0.0, 1000.0}) {
    const std::vector<std::size_t> samples = heap_of_lives(kForever, kWindow, leak);
    EXPECT_EQ(heap_grows(std::span(samples).subspan(300)), leak > 0.0);
  }
}

// A hundred cycles at once, each of them within the limits.
TEST_F(SoakCheckerTest, NoticesMotionThatIsMadeUpFor) {
  for (int i = 0; i < 100; ++i) checker_.on_setpoint(1.1 + 1e-6 * i, {4e-4 * i, 0.0, 0.0});
  ASSERT_FALSE(checker_.violations().empty());
  EXPECT_NE(checker_.violations().front().find("the setpoint moved"), std::string::npos);
}

TEST_F(SoakCheckerTest, NoticesAnAcceleration) {
  checker_.on_setpoint(1.100, {0.0, 0.0, 0.0});
  checker_.on_setpoint(1.101, {0.0, 0.0, 0.0});
  checker_.on_setpoint(1.102, {6e-6, 0.0, 0.0});
  EXPECT_TRUE(has("acceleration is 6.000"));
}

TEST_F(SoakCheckerTest, NoticesThatNothingIsExecutedOfWhatArrives) {
  checker_.on_executed(1.03, 7, "key", command_);
  for (double t = 1.1; t < 12.0; t += 0.01) {
    checker_.on_delivered(t, t - 0.02);
    checker_.on_setpoint(t, Eigen::Vector3d::Zero());
  }
  EXPECT_TRUE(has("although messages arrive"));
}

TEST_F(SoakCheckerTest, ExpectsNoCommandInSilenceOrAPauseOrWithoutAnswersOrOfARevokedKey) {
  checker_.on_executed(1.03, 7, "key", command_);
  for (double t = 1.1; t < 50.0; t += 0.01) {
    if (t > 30.0 && t < 30.015) checker_.on_no_answers(39.5);
    if (t > 40.0) checker_.revoke(t, "key");
    const bool is_silent = t > 8.0 && t < 9.0;
    const bool is_paused = t > 16.0 && t < 25.0;
    if (!is_silent) checker_.on_delivered(t, t - 0.02);
    if (!is_paused) checker_.on_setpoint(t, Eigen::Vector3d::Zero());
  }
  EXPECT_TRUE(checker_.violations().empty()) << lines(checker_.violations());
}

TEST_F(SoakCheckerTest, NoticesThatNothingIsExecuted) {
  checker_.check_recovered(2.0);
  EXPECT_TRUE(has("no command was executed"));
}

}  // namespace
}  // namespace pcavr
