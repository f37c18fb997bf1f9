// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot_identification/contact_observer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/recordings/recording/import_joint_log.hpp"
#include "pcavr/robots/robot/link_meshes.hpp"
#include "pcavr/robots/robot_identification/log_checks.hpp"
#include "pcavr/robots/robot_identification/payload.hpp"
#include "pcavr/robots/robot_identification/sample_clock.hpp"

#include "robot_identification/simulated_arm.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

/// Adds the torque that holds the arm on its motion against a force on the tip from `onset` on.
JointLog pushed(JointLog log, const RobotModel& model, double onset, double end,
                const Eigen::Vector3d& force_base) {
  RobotDynamics kinematics(model);
  Matrix6Xd jacobian(6, log.position.cols());
  for (Eigen::Index i = 0; i < log.position.rows(); ++i) {
    const double t = log.t[static_cast<std::size_t>(i)];
    if (t < onset || t > end) continue;
    kinematics.jacobian(log.position.row(i).transpose(), default_tip(model), jacobian);
    log.torque.row(i) -= (jacobian.topRows<3>().transpose() * force_base).transpose();
  }
  return log;
}

/// A robot with known bodies, and no friction but what `friction` has.
std::vector<JointFit> without_friction(const RobotModel& model) {
  std::vector<JointFit> friction(model.dof);
  for (JointFit& joint : friction) joint.sign.smoothing_speed = 0.01;
  return friction;
}

// A first-order low pass of the true external torque, in closed form, without noise.
TEST(DetectableForce, IsStatedAlsoWhereAnAxisMovesNoJoint) {
  ObservedContacts contacts;
  contacts.usual_detectable_force = 7.49;
  contacts.detectable_force = 12.0;
  EXPECT_NE(detectable_force_text(contacts).find("12 N along"), std::string::npos);
  contacts.detectable_force = std::numeric_limits<double>::infinity();
  EXPECT_EQ(detectable_force_text(contacts).find("inf"), std::string::npos);
  EXPECT_NE(detectable_force_text(contacts).find("7.49 N"), std::string::npos);
  contacts.usual_detectable_force = contacts.detectable_force;
  EXPECT_NE(detectable_force_text(contacts).find("moves no joint"), std::string::npos);
}

TEST(ContactObserver, FollowsAStepWithItsTimeConstant) {
  const RobotModel model = pa10();
  ContactObserverOptions options;
  options.gain = 40.0;
  ContactObserver observer(model, without_friction(model), options);
  RobotDynamics dynamics(model);
  Eigen::VectorXd q(7), dq(7), ddq(7), tau(7), external = Eigen::VectorXd::Zero(7);
  const auto state_at = [&](double t) {
    for (Eigen::Index j = 0; j < 7; ++j) {
      const double w = 1.0 + 0.3 * static_cast<double>(j);
      q[j] = 0.8 * std::sin(w * t);
      dq[j] = 0.8 * w * std::cos(w * t);
      ddq[j] = -0.8 * w * w * std::sin(w * t);
    }
  };
  constexpr double kInterval = 0.0005;
  state_at(0.0);
  observer.reset(q, dq);
  for (int i = 1; i <= 4000; ++i) {
    const double t = kInterval * i;
    state_at(t);
    dynamics.inverse_dynamics(q, dq, ddq, tau);
    if (t > 1.0) external << 5.0, -3.0, 2.0, 1.0, 0.5, 0.2, 0.1;
    const Eigen::VectorXd& found = observer.update(q, dq, tau - external, kInterval);
    const double share = t > 1.0 ? 1.0 - std::exp(-40.0 * (t - 1.0)) : 0.0;
    ASSERT_LT((found - share * external).cwiseAbs().maxCoeff(), 0.12) << t;
  }
}

// A joint stops between two samples, by a torque that they do not show.
TEST(ContactObserver, AStopBetweenTwoSamplesIsUnresolved) {
  const RobotModel model = pa10();
  ContactObserver observer(model, without_friction(model));
  constexpr double kInterval = 0.01, kSpeed = 0.1;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(7), dq = Eigen::VectorXd::Zero(7);
  Eigen::VectorXd tau(7);
  RobotDynamics dynamics(model);
  dq[0] = kSpeed;
  observer.reset(q, dq);
  for (int i = 1; i <= 200; ++i) {
    if (i == 100) dq.setZero();
    q += kInterval * dq;
    dynamics.inverse_dynamics(q, dq, Eigen::VectorXd::Zero(7), tau);
    const double external = std::abs(observer.update(q, dq, tau, kInterval)[0]);
    const double unresolved = observer.unresolved()[0];
    if (i < 100) {
      ASSERT_LT(unresolved, 1e-3) << i;
    } else {
      ASSERT_LT(external, unresolved + 0.05) << i;
    }
    if (i == 100) {
      EXPECT_GT(external, 0.2);
    }
    if (i == 150) {
      EXPECT_LT(unresolved, 1e-3);
    }
  }
}

// Friction alone carries the joint at rest, and its motor's torque creeps away; then it moves on.
TEST(ContactObserver, FrictionThatHoldsAJointAtRestIsUnresolved) {
  constexpr double kInterval = 0.002, kSpeed = 0.1, kCoulomb = 5.0;
  const RobotModel model = pa10();
  std::vector<JointFit> friction = without_friction(model);
  friction[0].friction = {{FrictionTerm::coulomb, kCoulomb}};
  friction[0].sign.presliding_displacement = 0.002;
  ContactObserver observer(model, friction);
  RobotDynamics dynamics(model);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(7), dq = q, tau = q;
  dq[0] = kSpeed;
  observer.reset(q, dq);
  for (int i = 1; i <= 2000; ++i) {
    const double t = kInterval * i;
    const bool rests = t > 1.0 && t < 3.0;
    dq[0] = rests ? 0.0 : kSpeed;
    q += kInterval * dq;
    dynamics.inverse_dynamics(q, dq, Eigen::VectorXd::Zero(7), tau);
    tau[0] += rests ? kCoulomb * (2.0 - t) : kCoulomb;  // from one sign to the other
    const double external = std::abs(observer.update(q, dq, tau, kInterval)[0]);
    const double unresolved = observer.unresolved()[0];
    if (t < 0.99 || t > 3.4) {
      ASSERT_LT(external + unresolved, 0.05) << t;
    }
    if (t > 1.2 && t < 2.99) {
      ASSERT_NEAR(unresolved, kCoulomb, 0.01) << t;
      ASSERT_LE(external, unresolved + 0.01) << t;
    }
  }
}

TEST(TipForce, IsRecoveredFromItsJointTorques) {
  const RobotModel model = pa10();
  RobotDynamics kinematics(model);
  Matrix6Xd jacobian(6, 7);
  kinematics.jacobian(Eigen::VectorXd::Constant(7, 0.5), default_tip(model), jacobian);
  const Eigen::Vector3d force(3.0, -8.0, 5.0);
  const Eigen::VectorXd torque = jacobian.topRows<3>().transpose() * force;
  const auto found = tip_force(jacobian, torque, Eigen::VectorXd::Constant(7, 0.5));
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - force).norm(), 1e-9);
  jacobian.setZero();
  EXPECT_FALSE(tip_force(jacobian, torque, Eigen::VectorXd::Constant(7, 0.5)).has_value());
}

/// Pushes along each axis of base, one way at every other onset, with twice the force that reaches
/// some joint's threshold at the onset; where that takes more than 2 kN, no joint feels the axis.
/// Half the delay allowed is the observer's: its time constant of 20 ms.
template <typename Observe>
void expect_touches_in_time(const RobotModel& model, const JointLog& log, const Observe& observe,
                            const std::vector<double>& onsets) {
  constexpr double kMaxForce = 2000.0;  // [N]
  const Eigen::VectorXd thresholds = observe(log).thresholds;
  RobotDynamics kinematics(model);
  Matrix6Xd jacobian(6, log.position.cols());
  std::vector<double> delays;
  bool is_positive = false;
  for (const double onset : onsets) {
    const auto row = std::lower_bound(log.t.begin(), log.t.end(), onset) - log.t.begin();
    kinematics.jacobian(log.position.row(row).transpose(), default_tip(model), jacobian);
    const double sign = (is_positive = !is_positive) ? 1.0 : -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double share =
          jacobian.row(axis).transpose().cwiseAbs().cwiseQuotient(thresholds).maxCoeff();
      if (2.0 > share * kMaxForce) continue;
      const Eigen::Vector3d force = sign * 2.0 / share * Eigen::Vector3d::Unit(axis);
      const ObservedContacts found = observe(pushed(log, model, onset, onset + 0.5, force));
      ASSERT_FALSE(found.touches.empty()) << onset << ", " << force.transpose();
      delays.push_back(found.touches.front().t - onset);
      EXPECT_GE(delays.back(), 0.0) << onset << ", " << force.transpose();
      EXPECT_LE(delays.back(), 0.050) << onset << ", " << force.transpose();
    }
  }
  ASSERT_GE(delays.size(), 2 * onsets.size());
  std::sort(delays.begin(), delays.end());
  testing::Test::RecordProperty("delays", std::to_string(delays[delays.size() / 2]) + " median, " +
                                              std::to_string(delays.back()) + " max");
}

/// Adds a torque of the environment at one joint that rises to `torque` [N m] within 0.2 s.
JointLog with_torque_at(JointLog log, Eigen::Index joint, double onset, double torque) {
  for (Eigen::Index i = 0; i < log.position.rows(); ++i) {
    const double since = log.t[static_cast<std::size_t>(i)] - onset;
    if (since < 0.0 || since > 1.0) continue;
    log.torque(i, joint) -= torque * std::min(1.0, since / 0.2);
  }
  return log;
}

/// The highest light threshold [N m] of a joint in the half second from `t` on.
double highest_light_threshold(const JointLog& log, const ObservedContacts& free,
                               Eigen::Index joint, double t) {
  double highest = 0.0;
  for (std::size_t row = 0; row < log.t.size(); ++row) {
    if (log.t[row] < t || log.t[row] > t + 0.5) continue;
    highest = std::max(highest, free.light_thresholds(static_cast<Eigen::Index>(row), joint));
  }
  return highest;
}

/// Pushes each joint alone, with twice its light threshold where it moves as it did without
/// contact; `sign` is that of the log's torques. Returns how many joints were pushed.
template <typename Observe>
int expect_joints_found_alone(const JointLog& log, double sign, const Observe& observe) {
  const ObservedContacts free = observe(log);
  const double begin = log.t[free.first_judged] + 0.5, end = log.t.back() - 1.0;
  int pushed_joints = 0;
  for (Eigen::Index joint = 0; joint < log.position.cols(); ++joint) {
    double onset = begin;
    double threshold = highest_light_threshold(log, free, joint, onset);
    while (onset < end && !(threshold < 0.5 * free.thresholds[joint])) {
      onset += 0.25;
      threshold = highest_light_threshold(log, free, joint, onset);
    }
    if (onset >= end) continue;
    ++pushed_joints;
    const ObservedContacts found =
        observe(with_torque_at(log, joint, onset, 2.0 * sign * threshold));
    EXPECT_FALSE(found.touches.empty()) << joint;
    if (found.touches.empty()) continue;
    EXPECT_EQ(found.touches.front().joint, static_cast<std::size_t>(joint));
    EXPECT_GE(found.touches.front().t, onset);
    EXPECT_LE(found.touches.front().t, onset + 0.5) << joint;
  }
  return pushed_joints;
}

class IdentifiedArmTest : public testing::Test {
 protected:
  // Fitted on the first 65 %; thresholds from these rows, judged on the others.
  static void SetUpTestSuite() {
    model = new RobotModel(pa10());
    log = new JointLog(simulated_log(*model, {.duration = 60.0, .rate = 500.0, .seed = 11}));
    fit = new RobotFit(fit_robot(joint_signals(*log, {}), *model, {}));
  }
  static void TearDownTestSuite() {
    delete model;
    delete log;
    delete fit;
  }
  static inline RobotModel* model = nullptr;
  static inline JointLog* log = nullptr;
  static inline RobotFit* fit = nullptr;
};

TEST_F(IdentifiedArmTest, RaisesNoAlarmWithoutContact) {
  const ObservedContacts found =
      observe_contacts(*log, *model, *fit, false, 39.0, default_tip(*model));
  EXPECT_TRUE(found.touches.empty());
  EXPECT_GT(found.detectable_force, 0.0);
}

TEST_F(IdentifiedArmTest, ReportsATouchWithin50Milliseconds) {
  const auto observed = [](const JointLog& pushed_log) {
    return observe_contacts(pushed_log, *model, *fit, false, 39.0, default_tip(*model));
  };
  expect_touches_in_time(*model, *log, observed, {42.0, 47.5, 53.0});
}

TEST_F(IdentifiedArmTest, FindsALightTorqueAtOneJointAlone) {
  const auto observed = [](const JointLog& pushed_log) {
    return observe_contacts(pushed_log, *model, *fit, false, 39.0, default_tip(*model));
  };
  EXPECT_EQ(expect_joints_found_alone(*log, 1.0, observed), 7);
}

/// 2 kg, 6 cm from the last joint's axis.
RigidInertia test_load() {
  RigidInertia load;
  load.mass = 2.0;
  load.centre_of_mass = {0.06, -0.02, 0.10};
  load.inertia_at_com = 0.004 * Eigen::Matrix3d::Identity();
  return load;
}

RobotModel with_load(RobotModel model, const RigidInertia& load) {
  model.joints.back().body = model.joints.back().body + load;
  return model;
}

// Another seed, another motion.
TEST_F(IdentifiedArmTest, RecoversALoadWithin3Percent) {
  const RigidInertia load = test_load();
  const RobotModel loaded = with_load(*model, load);
  const JointLog run = simulated_log(loaded, {.duration = 60.0, .rate = 500.0, .seed = 12});
  const Payload found = identify_payload(joint_signals(run, {}), *model, *fit);
  EXPECT_NEAR(found.mass, load.mass, 0.03 * load.mass);
  EXPECT_LT((found.centre_of_mass - load.centre_of_mass).norm(), 0.005);
  EXPECT_LT(std::abs(found.mass - load.mass), 3.0 * found.mass_std);
  RecordProperty("mass", std::to_string(found.mass) + " +- " + std::to_string(found.mass_std));
}

TEST_F(IdentifiedArmTest, RecoversTheLoadOfARunWhoseTorquesAreLate) {
  const RigidInertia load = test_load();
  const RobotModel loaded = with_load(*model, load);
  const JointLog run =
      simulated_log(loaded, {.duration = 20.0, .torque_delay = 0.02, .seed = 2302});
  const Payload found = identify_payload(joint_signals(run, {}), *model, *fit);
  EXPECT_NEAR(found.mass, load.mass, 0.01 * load.mass);
}

/// A real log without contact, ready for the observer.
struct RealLog {
  JointLog log;
  RobotModel model;
  RobotFit fit;
  bool is_sign_changed = false;
  double calibration_end = 0.0;  ///< [s] end of the fitted rows
};

RealLog real_log(const std::string& log, const std::string& urdf, const std::vector<double>& gains,
                 std::optional<double> period) {
  JointLog read = import_joint_log(shared_data("real/" + log), {.period = period}).value().log;
  if (read.torque.rows() == 0) read.torque = read.current;
  for (std::size_t j = 0; j < gains.size(); ++j) {
    read.torque.col(static_cast<Eigen::Index>(j)) *= gains[j];
  }
  const MatchedRobot matched =
      match_joints(read, read_urdf(shared_data("real/" + urdf)).value()).value();
  RealLog real{reordered(read, matched.columns), matched.model, {}, false, 0.0};
  EXPECT_TRUE(check_rows(real.log, real.model, 0.2).errors.empty());
  (void)correct_sample_clock(real.log);
  JointSignals signals = joint_signals(real.log, {});
  (void)check_hypotheses(signals, real.model);
  real.is_sign_changed = signals.is_sign_changed;
  real.fit = fit_robot(signals, real.model, {});
  real.calibration_end = signals.t[real.fit.train_rows];
  return real;
}

ObservedContacts observe(const RealLog& real, const JointLog& log) {
  return observe_contacts(log, real.model, real.fit, real.is_sign_changed, real.calibration_end,
                          default_tip(real.model));
}

// Fit and thresholds from the first 65 % of each log; the options are the defaults, which were not
// chosen on these logs. The forces are added to the held-out torques.
void expect_touches_found(const RealLog& real) {
  const ObservedContacts free = observe(real, real.log);
  EXPECT_TRUE(free.touches.empty()) << free.touches.front().t;
  const double span = real.log.t.back() - real.calibration_end;
  std::vector<double> onsets;
  for (const double share : {0.1, 0.35, 0.6}) onsets.push_back(real.calibration_end + share * span);
  const auto observed = [&](const JointLog& log) { return observe(real, log); };
  expect_touches_in_time(real.model, real.log, observed, onsets);
}

TEST(RealContacts, AreFoundOnAPandaWithoutFalseAlarms) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_dynamics");
  expect_touches_found(real_log("franka_dynamics", "robots/panda/panda.urdf", {}, {}));
}

TEST(RealContacts, AreFoundOnAnLbrMedWithoutFalseAlarms) {
  PCAVR_NEEDS_SHARED_DATA("real/lbr_med");
  expect_touches_found(real_log("lbr_med/measurements.csv", "lbr_med/med7dock.urdf", {}, 0.01));
}

// The drive gains are the origin's. Forces up to 1.3 kN: joint torques from currents show little of
// a push towards the axes of the shoulder.
TEST(RealContacts, AreFoundOnAUr10eWithoutFalseAlarms) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  expect_touches_found(real_log("ur10e/identification_data/ur-20_02_12-50sec_12harm.csv",
                                "ur10e/ur10e.urdf", {10.0, 10.6956, 8.4566, 9.0029, 9.48, 10.1232},
                                {}));
}

/// A log with the drive gains of its origin.
RealLog ur10e_log(const std::string& run) {
  return real_log("ur10e/identification_data/ur-" + run + ".csv", "ur10e/ur10e.urdf",
                  {10.0, 10.6956, 8.4566, 9.0029, 9.48, 10.1232}, {});
}

void expect_no_alarm(const std::vector<std::string>& runs) {
  for (const std::string& run : runs) {
    const RealLog real = ur10e_log(run);
    const ObservedContacts free = observe(real, real.log);
    EXPECT_TRUE(free.touches.empty()) << run << ": " << free.touches.front().t << " s";
  }
}

// Logs of 20 s: little to fit, and arms that stop at once at the end.
TEST(RealContacts, ShortRunsRaiseNoAlarm) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  expect_no_alarm({"20_02_05-20sec_8harm", "20_02_05-20sec_12harm", "20_02_06-20sec_10harm",
                   "20_02_06-20sec_5harm", "20_02_10-20sec_7harm"});
}

// Other days, loads, and motions of 30 to 50 s.
TEST(RealContacts, FurtherRunsRaiseNoAlarm) {
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  expect_no_alarm({"20_02_10-30sec_12harm", "20_02_12-40sec_12harm", "20_02_19_14harm50sec",
                   "20_02_19_15harm50sec", "20_01_31-unload", "20_01_31-load", "20_01_13-load_2600",
                   "19_12_23_free", "20_02_19_14harm50secLoad"});
}

// The joints are all of the Panda, which never rests, and of the others those that move within the
// positions and speeds without contact for long enough.
TEST(RealContacts, OfOneJointAloneAreFoundBelowHalfTheThresholdOfAllMotion) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_dynamics");
  PCAVR_NEEDS_SHARED_DATA("real/lbr_med");
  PCAVR_NEEDS_SHARED_DATA("real/ur10e");
  const auto pushed_joints = [](const RealLog& real) {
    const auto observed = [&](const JointLog& log) { return observe(real, log); };
    return expect_joints_found_alone(real.log, real.is_sign_changed ? -1.0 : 1.0, observed);
  };
  EXPECT_GE(pushed_joints(real_log("franka_dynamics", "robots/panda/panda.urdf", {}, {})), 5);
  EXPECT_GE(pushed_joints(real_log("lbr_med/measurements.csv", "lbr_med/med7dock.urdf", {}, 0.01)),
            1);
  EXPECT_GE(pushed_joints(ur10e_log("20_02_12-50sec_12harm")), 5);
}

}  // namespace
}  // namespace pcavr
