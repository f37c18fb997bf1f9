// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "sites/soak/two_sites_soak.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/pipeline/plant_robot.hpp"
#include "pcavr/simulation/plant_case.hpp"

#include "sites/soak/soak_checker.hpp"
#include "sites/soak/soak_network.hpp"
#include "sites/soak/soak_person.hpp"
#include "teleop/plant_input.hpp"
#include "teleoperation/sites/site_steps.hpp"

namespace pcavr {
namespace {

constexpr double kFirstFault = 3.0;    // [s]
constexpr double kMinFault = 0.02;     // [s] the shortest, and
constexpr double kMaxFault = 10.0;     // the longest, evenly distributed by their logarithm
constexpr double kRestartDelay = 0.5;  // [s] until an operator's program that has ended is started
constexpr double kSleep = 0.05;        // [s] of a machine whose clock steps
constexpr double kMaxBoot = 60.0;      // [s] on the clock of a machine that has just been started
// [s] until both sites have been started anew, or until the windows of processes that are not are
// full: twice that of the inputs.
constexpr double kFirstLife = 60.0;
constexpr double kFullWindows = 1200.0;
// [s] of a third of the samples: several processes end in it, or a window.
constexpr double kMinHeapThird = 560.0;
constexpr double kMinWait = 1e-7;  // [s] between two events of a site: rounding of its clock
constexpr double kPeriodOfReplay = 0.003;    // [s] between two repeated messages
constexpr double kPeriodOfIntruder = 0.007;  // [s]

/// The workspace contains the plant's table; what an operator pushes can't leave it. The limits of
/// step and force act often: the boxes slide at some 15 N.
MotionLimits soak_limits(Random random) {
  MotionLimits limits;
  limits.max_step = 0.005;
  limits.max_force = random.uniform(8.0, 25.0);
  limits.min_x = limits.min_y = -0.6;
  limits.max_x = limits.max_y = 0.8;
  limits.min_z = 0.0;
  limits.max_z = 0.6;
  return limits;
}

TeleopInput soak_world(std::uint64_t seed) {
  TeleopInput world;
  const PlantCase plant = make_plant_case(ToolTask::push, seed);
  for (const PlantBody& body : plant.bodies) {
    TeleopObject object{body.name,
                        box_model(body.name, body.parts.front().half_extents),
                        body.T_base_object,
                        {},
                        {}};
    object.parameters.mass = ParameterValue{body.parameters.mass};
    world.objects.push_back(std::move(object));
  }
  world.tool_radius = plant.tool.radius;
  return world;
}

/// A machine's clock (CLOCK_BOOTTIME): it drifts, goes on while a process does not run, and goes
/// back only when the machine is started anew.
class MachineClock {
 public:
  MachineClock(const double& true_time, double offset, double drift)
      : true_time_(true_time), offset_(offset), rate_(1.0 + drift) {}
  [[nodiscard]] double now() const { return offset_ + rate_ * true_time_; }
  [[nodiscard]] double true_duration(double duration) const { return duration / rate_; }
  void step(double by) { offset_ += by; }
  void begin(double now) { offset_ = now - rate_ * true_time_; }

 private:
  const double& true_time_;
  double offset_;
  double rate_;
};

/// The plant, which outlives the robot site's process, on the clock of the present one.
class SoakRobot final : public RobotInterface {
 public:
  SoakRobot(std::unique_ptr<RobotInterface> plant, const double& true_time, SoakChecker& checker)
      : plant_(std::move(plant)),
        true_time_(true_time),
        checker_(checker),
        p_base_setpoint_(plant_->p_base_start()) {}

  /// A new process, whose scene begins at time zero, takes the robot over.
  void attach() { start_ = newest_; }

  [[nodiscard]] std::string name() const override { return "soak"; }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return p_base_setpoint_; }
  void set_command(const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond& q) override {
    p_base_setpoint_ = p_base_tip;
    checker_.on_setpoint(true_time_, p_base_tip);
    plant_->set_command(p_base_tip, q);
  }
  void advance(double t, RobotSamples& samples) override {
    newest_ = start_ + t;
    plant_->advance(newest_, samples);
    for (RobotSamples::Tool& tool : samples.tool) tool.t -= start_;
    for (RobotSamples::Wrench& wrench : samples.wrench) wrench.t -= start_;
    for (RobotSamples::Tracked& tracked : samples.tracked) tracked.pose.t -= start_;
    // These samples were measured for the process before.
    std::erase_if(samples.tool, [](const auto& sample) { return sample.t <= 0.0; });
    std::erase_if(samples.wrench, [](const auto& sample) { return sample.t <= 0.0; });
    std::erase_if(samples.tracked, [](const auto& sample) { return sample.pose.t <= 0.0; });
    if (!samples.wrench.empty()) checker_.on_force(true_time_, samples.wrench.back().force_base);
  }

 private:
  std::unique_ptr<RobotInterface> plant_;
  const double& true_time_;
  SoakChecker& checker_;
  Eigen::Vector3d p_base_setpoint_;
  double start_ = 0.0;   ///< [s] of the plant, when the present process began
  double newest_ = 0.0;  ///< [s] of the plant
};

/// A process: running, paused, or killed and not yet started again.
template <typename Report>
struct SoakProcess {
  std::unique_ptr<SiteSteps<Report>> steps = {};
  double runs_from = 0.0;  ///< [s] paused until then
  double starts_at = 0.0;  ///< [s] if it does not exist
  double next = 0.0;       ///< [s] its next event but messages
};

class TwoSitesSoak final : private SiteLog {
 public:
  explicit TwoSitesSoak(const SoakOptions& options);
  SoakReport run();

 private:
  using Handler = void (TwoSitesSoak::*)(double length);
  struct FaultKind {
    const char* name;
    Handler handler;
  };
  static const std::array<FaultKind, 17> kFaults;

  // Faults of `length` [s].
  void drop_both(double length);
  void drop_to_robot(double length) { network_.drop_until(SoakNetwork::to_robot, t_ + length); }
  void drop_to_operator(double length) {
    network_.drop_until(SoakNetwork::to_operator, t_ + length);
    checker_.on_no_answers(t_ + length);
  }
  void stall_both(double length);
  void reconnect(double) { network_.reconnect(); }
  void kill_robot(double length);
  void kill_operator(double length);
  void reboot_robot(double length);
  void reboot_operator(double length);
  void pause_robot(double length) { robot_site_.runs_from = t_ + length; }
  void pause_operator(double length) { operator_site_.runs_from = t_ + length; }
  void step_robot_clock(double length);
  void step_operator_clock(double length) { operator_clock_.step(length); }
  void corrupt(double length) { network_.corrupt_until(t_ + length); }
  void replay(double length) { replay_until_ = t_ + length; }
  void intrude(double length) { intrude_until_ = t_ + length; }
  void revoke_operator(double length);
  void stop_robot() { person_.stop(); }

  // Events.
  void begin_fault();
  void attack();
  void start_processes();
  void step_robot_site();
  void step_operator_site();
  [[nodiscard]] double next_event() const;
  template <typename Report>
  [[nodiscard]] double next_event_of(const SoakProcess<Report>& process) const;
  [[nodiscard]] bool is_due(double next, double runs_from, SoakNetwork::Direction direction) const;
  void note_heap();
  [[nodiscard]] bool is_heap_growing() const;
  [[nodiscard]] double fault_length() {
    return kMinFault * std::pow(kMaxFault / kMinFault, random_.uniform());
  }

  // SiteLog.
  void on_session(std::uint32_t session, const std::string& key) override {
    ++report_.sessions;
    checker_.on_session(t_, session, key);
  }
  void on_executed(std::uint32_t session, const std::string& key,
                   const LinkCommand& command) override {
    checker_.on_executed(t_, session, key, command);
  }
  void on_composed(std::uint32_t session, const LinkCorrection& correction) override {
    checker_.on_composed(t_, session, correction);
  }
  void on_commanded(std::uint32_t session, const LinkCommand& command) override {
    checker_.on_commanded(t_, session, command);
  }
  void on_applied(double, std::uint32_t session, const LinkCorrection& correction,
                  bool is_valid) override {
    checker_.on_applied(t_, session, correction, is_valid);
  }

  SoakOptions options_;
  std::size_t heap_before_ = 0;
  std::vector<std::size_t> heap_;  ///< in use above that, each second
  Random random_;
  double t_ = 0.0;  ///< [s] true time
  RobotSiteOptions robot_options_;
  OperatorSiteOptions operator_options_;
  TeleopOptions teleop_;
  TeleopInput world_;
  SiteScene scene_;
  SoakChecker checker_;
  SoakNetwork network_;
  SoakServer server_{network_};
  SoakClient client_{network_};
  MachineClock robot_clock_;
  MachineClock operator_clock_;
  std::unique_ptr<SoakRobot> robot_;
  SoakPerson person_;
  std::optional<LiveRobotSite> live_robot_site_;
  SoakProcess<RobotSiteReport> robot_site_;
  SoakProcess<OperatorSiteReport> operator_site_;
  double next_fault_ = kFirstFault;
  double replay_until_ = -1.0;
  double intrude_until_ = -1.0;
  double next_replay_ = 0.0;
  double next_intrusion_ = 0.0;
  std::optional<double> authorize_at_;
  std::uint32_t sessions_ = 0;
  SimulatedNetwork no_network_;  ///< the operator's site has none of its own
  Observer observer_;
  SoakReport report_;
};

const std::array<TwoSitesSoak::FaultKind, 17> TwoSitesSoak::kFaults{{
    {"drop both", &TwoSitesSoak::drop_both},
    {"drop to robot", &TwoSitesSoak::drop_to_robot},
    {"drop to operator", &TwoSitesSoak::drop_to_operator},
    {"stall both", &TwoSitesSoak::stall_both},
    {"reconnect", &TwoSitesSoak::reconnect},
    {"kill robot's site", &TwoSitesSoak::kill_robot},
    {"kill operator's site", &TwoSitesSoak::kill_operator},
    {"start robot's machine anew", &TwoSitesSoak::reboot_robot},
    {"start operator's machine anew", &TwoSitesSoak::reboot_operator},
    {"pause robot's site", &TwoSitesSoak::pause_robot},
    {"pause operator's site", &TwoSitesSoak::pause_operator},
    {"step robot's clock", &TwoSitesSoak::step_robot_clock},
    {"step operator's clock", &TwoSitesSoak::step_operator_clock},
    {"corrupt", &TwoSitesSoak::corrupt},
    {"replay", &TwoSitesSoak::replay},
    {"intrude", &TwoSitesSoak::intrude},
    {"revoke operator's key", &TwoSitesSoak::revoke_operator},
}};

LinkConditions::Options soak_conditions(Random random) {
  LinkConditions::Options options;
  options.delay = random.uniform(0.001, 0.1);
  options.jitter = random.uniform(0.0, 0.01);
  options.loss = random.uniform(0.0, 0.05);
  options.burst = 3.0;
  options.reorder = random.uniform(0.0, 0.02);
  options.duplicate = random.uniform(0.0, 0.02);
  return options;
}

RobotSiteOptions soak_robot_options(std::uint64_t seed) {
  RobotSiteOptions options;
  options.limits = soak_limits(Random(seed).fork(5));
  return options;
}

std::vector<Eigen::Vector3d> places_of(const TeleopInput& world) {
  std::vector<Eigen::Vector3d> places;
  for (const TeleopObject& object : world.objects) {
    places.push_back(object.T_base_object.translation());
  }
  return places;
}

SiteScene soak_scene(const TeleopInput& world) {
  SiteScene scene{
      .name = "soak", .version = "soak", .objects = {}, .tool_radius = world.tool_radius};
  for (const TeleopObject& object : world.objects) scene.objects.push_back(object.name);
  return scene;
}

TwoSitesSoak::TwoSitesSoak(const SoakOptions& options)
    : options_(options),
      heap_before_(options.heap_bytes ? options.heap_bytes() : 0),
      random_(Random(options.seed).fork(1)),
      robot_options_(soak_robot_options(options.seed)),
      world_(soak_world(options.seed)),
      scene_(soak_scene(world_)),
      checker_({.commands = robot_options_.commands,
                .limits = robot_options_.limits,
                .cycle = robot_options_.cycle}),
      network_(soak_conditions(Random(options.seed).fork(2)),
               soak_conditions(Random(options.seed).fork(3)), Random(options.seed).fork(4),
               checker_),
      robot_clock_(t_, random_.uniform(0.0, 1e5), random_.uniform(-5e-5, 5e-5)),
      operator_clock_(t_, random_.uniform(0.0, 1e5), random_.uniform(-5e-5, 5e-5)),
      robot_(std::make_unique<SoakRobot>(
          make_plant_robot(ToolTask::push, options.seed, world_, teleop_.pose.tracking_latency)
              .value(),
          t_, checker_)),
      person_(robot_options_.limits, robot_->p_base_start(), places_of(world_),
              teleop_.predictor.step) {
  if (!std::isfinite(options.fault_interval)) next_fault_ = options.fault_interval;
  network_.set_authorized(SoakNetwork::kOperatorKey, true);
  network_.set_authorized(SoakNetwork::kIntruderKey, false);
  network_.set_running(SoakNetwork::to_robot, false);
  network_.set_running(SoakNetwork::to_operator, false);
}

void TwoSitesSoak::drop_both(double length) {
  drop_to_robot(length);
  drop_to_operator(length);
}

void TwoSitesSoak::stall_both(double length) {
  for (const auto direction : SoakNetwork::kDirections) {
    network_.stall_until(direction, t_ + length);
  }
}

void TwoSitesSoak::kill_robot(double length) {
  robot_site_.steps.reset();
  live_robot_site_.reset();
  robot_site_.starts_at = t_ + length;
  network_.set_running(SoakNetwork::to_robot, false);
}

void TwoSitesSoak::kill_operator(double length) {
  operator_site_.steps.reset();
  operator_site_.starts_at = t_ + length;
  network_.set_running(SoakNetwork::to_operator, false);
}

/// The machine's clock begins again near zero.
void TwoSitesSoak::reboot_robot(double length) {
  kill_robot(length);
  robot_clock_.begin(random_.uniform(0.0, kMaxBoot));
}
void TwoSitesSoak::reboot_operator(double length) {
  kill_operator(length);
  operator_clock_.begin(random_.uniform(0.0, kMaxBoot));
}

/// The machine sleeps for longer than the others' clocks show: CLOCK_BOOTTIME never goes back.
void TwoSitesSoak::step_robot_clock(double length) {
  robot_clock_.step(length);
  pause_robot(kSleep);
}

void TwoSitesSoak::revoke_operator(double length) {
  network_.set_authorized(SoakNetwork::kOperatorKey, false);
  authorize_at_ = t_ + length;
}

void TwoSitesSoak::begin_fault() {
  next_fault_ += -options_.fault_interval * std::log(1.0 - random_.uniform());
  const FaultKind& kind = kFaults[random_.below(kFaults.size())];
  const double length = fault_length();
  if (random_.below(10) == 0) stop_robot();
  ++report_.faults[kind.name];
  (this->*kind.handler)(length);
}

/// Repeated messages and the second operator's.
void TwoSitesSoak::attack() {
  if (t_ < replay_until_ && t_ >= next_replay_) {
    network_.replay_one();
    next_replay_ = t_ + kPeriodOfReplay;
  }
  if (t_ < intrude_until_ && t_ >= next_intrusion_) {
    network_.send_as_intruder();
    next_intrusion_ = t_ + kPeriodOfIntruder;
  }
  if (authorize_at_ && t_ >= *authorize_at_) {
    network_.set_authorized(SoakNetwork::kOperatorKey, true);
    authorize_at_.reset();
  }
}

void TwoSitesSoak::start_processes() {
  if (!robot_site_.steps && t_ >= robot_site_.starts_at) {
    robot_->attach();
    checker_.on_robot_start(t_);
    live_robot_site_.emplace(LiveRobotSite::create(world_, teleop_, 0.0).value());
    const SiteRuntime runtime{.clock = [this] { return robot_clock_.now(); },
                              .new_session = {},
                              .prepares_at_once = true,
                              .log = this};
    robot_site_.steps = make_robot_site_steps(server_, *robot_, *live_robot_site_, scene_,
                                              robot_options_, observer_, runtime);
    robot_site_.next = t_;
    network_.set_running(SoakNetwork::to_robot, true);
  }
  if (!operator_site_.steps && t_ >= operator_site_.starts_at) {
    const SiteRuntime runtime{.clock = [this] { return operator_clock_.now(); },
                              .new_session = [this] { return ++sessions_; },
                              .prepares_at_once = true,
                              .log = this};
    operator_site_.steps =
        make_operator_site_steps(client_, person_, world_, teleop_, scene_, operator_options_,
                                 no_network_, observer_, runtime);
    operator_site_.next = t_;
    network_.set_running(SoakNetwork::to_operator, true);
  }
}

bool TwoSitesSoak::is_due(double next, double runs_from, SoakNetwork::Direction direction) const {
  return t_ >= runs_from && (t_ >= next || network_.has_arrived(direction));
}

void TwoSitesSoak::step_robot_site() {
  if (!robot_site_.steps) return;
  if (!is_due(robot_site_.next, robot_site_.runs_from, SoakNetwork::to_robot)) return;
  robot_site_.steps->step();
  const double wait = robot_clock_.true_duration(robot_site_.steps->until_due());
  robot_site_.next = t_ + std::max(wait, kMinWait);
}

void TwoSitesSoak::step_operator_site() {
  if (!operator_site_.steps) return;
  if (!is_due(operator_site_.next, operator_site_.runs_from, SoakNetwork::to_operator)) return;
  operator_site_.steps->step();
  if (operator_site_.steps->is_finished()) {
    const Expected<OperatorSiteReport> ended = operator_site_.steps->finish();
    ++report_.endings[ended ? "without an error" : ended.error().message];
    return kill_operator(kRestartDelay);
  }
  const double wait = operator_clock_.true_duration(operator_site_.steps->until_due());
  operator_site_.next = t_ + std::max(wait, kMinWait);
}

template <typename Report>
double TwoSitesSoak::next_event_of(const SoakProcess<Report>& process) const {
  return process.steps ? std::max(process.next, process.runs_from) : process.starts_at;
}

double TwoSitesSoak::next_event() const {
  double next = std::min(
      {options_.duration, next_event_of(robot_site_), next_event_of(operator_site_), next_fault_});
  if (const auto arrival = network_.next_arrival()) next = std::min(next, *arrival);
  return std::max(next, t_);
}

void TwoSitesSoak::note_heap() {
  if (!options_.heap_bytes) return;
  heap_.push_back(options_.heap_bytes() - heap_before_);
  report_.heap_peak = std::max(report_.heap_peak, heap_.back());
}

bool TwoSitesSoak::is_heap_growing() const {
  const double fill = std::isfinite(options_.fault_interval) ? kFirstLife : kFullWindows;
  if (heap_.empty() || options_.duration < fill + 3.0 * kMinHeapThird) return false;
  return heap_grows(std::span(heap_).subspan(static_cast<std::size_t>(fill)));
}

SoakReport TwoSitesSoak::run() {
  const double last_fault = options_.duration - options_.quiet_end - kMaxFault;
  double next_heap = 0.0;
  if (options_.heap_bytes) heap_.reserve(static_cast<std::size_t>(options_.duration) + 1);
  while (t_ < options_.duration) {
    t_ = network_.now = next_event();
    if (t_ >= next_fault_) {
      if (t_ < last_fault) {
        begin_fault();
      } else {
        next_fault_ = options_.duration + 1.0;
      }
    }
    attack();
    start_processes();
    network_.deliver();
    step_robot_site();
    step_operator_site();
    if (t_ >= next_heap) {
      note_heap();
      next_heap = t_ + 1.0;
    }
  }
  checker_.check_recovered(t_);
  report_.violations = checker_.violations();
  if (is_heap_growing()) report_.violations.emplace_back("the use of memory grows");
  report_.pressed = checker_.pressed();
  report_.digest = checker_.digest();
  report_.commands = checker_.executed();
  report_.corrections = checker_.applied();
  report_.max_age = checker_.max_age();
  report_.path = checker_.path();
  kill_operator(0.0);
  kill_robot(0.0);
  return std::move(report_);
}

}  // namespace

bool heap_grows(std::span<const std::size_t> samples) {
  constexpr std::size_t kMargin =
      500'000;  // bytes: what a process that has just started differs by
  const std::size_t third = samples.size() / 3;
  if (third == 0) return false;
  return std::ranges::min(samples.last(third)) > std::ranges::min(samples.first(third)) + kMargin;
}

SoakReport run_two_sites_soak(const SoakOptions& options) {
  SoakReport report;
  const std::size_t before = options.heap_bytes ? options.heap_bytes() : 0;
  report = TwoSitesSoak(options).run();
  if (options.heap_bytes) report.heap_rest = options.heap_bytes() - before;
  return report;
}

}  // namespace pcavr
