// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "command_schedule.hpp"
#include "connection_attempt.hpp"
#include "connection_faults.hpp"
#include "correction_intake.hpp"
#include "link_leads.hpp"
#include "operator_connection.hpp"
#include "picture_view.hpp"
#include "robot_view.hpp"
#include "safety_requests.hpp"
#include "site_priority.hpp"
#include "site_reporter.hpp"
#include "site_steps.hpp"
#include "world_preparation.hpp"

namespace pcavr {
namespace {

constexpr double kFirstPingInterval = 0.01;  // [s] until the first command
constexpr double kPingInterval = 0.1;        // [s]
constexpr double kLinkInterval = 1.0;        // [s] between two statistics in the log
constexpr std::size_t kMinRoundTrips = 10;
constexpr double kIdleWait = 0.002;  // [s] while there is no cycle to wait for
// Cycles behind, of more this site did not run: it begins anew from the robot's state.
constexpr double kMaxOperatorBacklog = 200.0;
constexpr std::uint32_t kCyclesPerSlice = 100;  // its newest second is not read

class OperatorSiteLoop final : public SiteSteps<OperatorSiteReport> {
 public:
  OperatorSiteLoop(OperatorTransport& client, OperatorInterface& interface,
                   const TeleopInput& world, const TeleopOptions& teleop, const SiteScene& scene,
                   const OperatorSiteOptions& options, const SimulatedNetwork& network,
                   const Observer& observer, const SiteRuntime& runtime)
      : client_(client),
        interface_(interface),
        world_(world),
        teleop_(teleop),
        scene_(scene),
        options_(options),
        reporter_(observer, runtime.log),
        log_(reporter_.log()),
        predictions_(runtime.predictions),
        world_preparation_(runtime.prepares_at_once),
        schedule_(teleop.predictor.step),
        clock_(runtime.clock),
        cpu_before_(thread_cpu()),
        next_event_(clock_.now() + kIdleWait),
        link_(client, network, log_, clock_, runtime.new_session),
        attempt_(options.connection_timeout),
        corrections_(log_) {
    log_.on_start(clock_.now());
  }

  [[nodiscard]] double until_due() const override {
    // A simulated arrival is also an event.
    double until = next_event_;
    if (const auto event = link_.next_event()) until = std::min(until, *event);
    return until - clock_.now();
  }

  void step() override {
    exchange();
    if (is_finished() || clock_.now() < next_event_) return;
    act(clock_.now());
    link_.transmit();
    // A recording may begin later: until then round trips keep the session alive.
    const double idle = clock_.now() + (site_ ? kFirstPingInterval : kIdleWait);
    next_event_ = site_ && !is_after_end() ? std::min(next_local_time(), idle) : idle;
  }

  [[nodiscard]] bool is_finished() const override { return is_done_ || fault_; }

  [[nodiscard]] Expected<OperatorSiteReport> finish() override {
    if (welcome_) {
      link_.send(LinkReject{LinkRejection::ended, "the operator's site has ended"});
      link_.flush();
    }
    report_.cpu = thread_cpu() - cpu_before_;
    if (fault_) return *fault_;
    return describe();
  }

 private:
  void act(double now) {
    reporter_.check_log();
    check_link(now);
    if (site_) log_link(now);
    if (!site_) interface_.wait(link_at(now));
    request(now);
    if (site_ && is_after_end()) {
      link_.ping(now, kFirstPingInterval);
      is_done_ = now > next_local_time() + schedule_.lead();  // the last command was executed
    } else if (site_ && now < next_local_time()) {
      link_.ping(now, kFirstPingInterval);
    } else if (site_) {
      timed_cycle(now);
    } else {
      connect(now);
    }
  }

  void exchange() {
    link_.transmit();
    while (!fault_) {
      Expected<std::optional<LinkMessage>> message = link_.receive();
      if (!message) {
        fault_ = message.error();
      } else if (*message) {
        on_message(std::move(**message), clock_.now());
      } else {
        break;
      }
    }
  }

  void on_message(LinkMessage message, double now) {
    if (const auto* rejected = std::get_if<LinkReject>(&message.content)) {
      on_reject(*rejected);
    } else if (auto* welcome = std::get_if<LinkWelcome>(&message.content)) {
      on_welcome(std::move(*welcome), now);
    } else if (auto* correction = std::get_if<LinkCorrection>(&message.content)) {
      corrections_.add(std::move(*correction));
    } else if (auto* state = std::get_if<LinkState>(&message.content)) {
      on_state(message.header, std::move(*state), now);
    } else if (const auto* picture = std::get_if<LinkPicture>(&message.content)) {
      if (!pictures_.add(message.header, *picture, now, link_)) return;
      interface_.show_picture(*picture,
                              clock_.monotonic(link_.shared_clock().local_at(picture->t)));
    }
  }

  void on_state(const LinkHeader& header, LinkState state, double now) {
    if (!robot_.add_state(header, std::move(state), link_.shared_clock(), clock_, now)) return;
    report_.delays.add(*robot_.delays());
    log_.on_delays(now, *robot_.delays());
  }

  void log_link(double now) {
    if (now < next_link_) return;
    next_link_ = now + kLinkInterval;
    log_.on_link(now, link_.statistics(now, schedule_.lead()));
  }

  [[nodiscard]] OperatorLink link_at(double now) const {
    return {.now = clock_.monotonic(now),
            .is_connected = site_.has_value(),
            .silence = link_.silence(now),
            .lead = schedule_.lead(),
            .round_trip = link_.shared_clock().is_known() ? link_.shared_clock().min_delay() : 0.0,
            .clock_std = link_.shared_clock().is_known() ? link_.shared_clock().std() : 0.0,
            .robot = robot_.state(),
            .delays = robot_.delays()};
  }

  void request(double now) {
    requests_.add(interface_.take_requests(), now);
    if (!welcome_) return requests_.drop_releases();
    for (const LinkStop stop : requests_.due(robot_.state(), now)) link_.send(stop);
  }

  void on_reject(const LinkReject& rejected) {
    if (rejected.reason == LinkRejection::ended) {
      // A site without an end of its own waits for the robot's to be started again.
      is_done_ = interface_.cycles().has_value();
      if (!is_done_ && welcome_) lose(clock_.now(), "the robot's site has ended");
      return;
    }
    if (rejected.reason == LinkRejection::busy) {
      attempt_.on_busy(rejected.text);
      return;
    }
    fault_ = rejected_by_robot(rejected);
  }

  void on_welcome(LinkWelcome welcome, double now) {
    if (welcome_) return;
    if (auto fault = unusable_robot(welcome, scene_.name, welcome.objects == scene_.objects,
                                    interface_.needs_follower())) {
      fault_ = std::move(*fault);
      return;
    }
    welcome_ = std::move(welcome);
    welcomed_ = now;
    pictures_.restart();
    ++report_.sessions;
  }

  /// Hello until there is a welcome, then round trips until the clock is known.
  void connect(double now) {
    if (!welcome_) {
      if (attempt_.is_hello_due(now)) link_.send(LinkHello{scene_.version, "operator-site"});
      fault_ = attempt_.find_fault(client_.state(), now);
      return;
    }
    link_.ping(now, kFirstPingInterval);
    if (link_.round_trips() < kMinRoundTrips || now - welcomed_ < options_.min_clock_time) return;
    begin(now);
  }

  /// The world as the scene describes it; the robot's site then sends what differs.
  /// It takes as long as a session lasts without messages, so it is made while round trips go on.
  void begin(double now) {
    if (!world_preparation_.has_begun()) return prepare(now);
    if (!world_preparation_.is_ready()) return;
    Expected<LiveOperatorSite> site = world_preparation_.take(now);
    if (!site) {
      fault_ = site.error();
      return;
    }
    attempt_.on_connected();
    // It took longer than expected: another one, with time for that.
    if (is_too_late(now)) return;
    site_.emplace(std::move(*site));
    next_link_ = now;
    if (welcome_->follows_commands) place_objects();
    interface_.begin(*site_);
    corrections_.begin();
    if (lost_at_) {
      report_.interruptions.back().duration = now - *lost_at_;
      reporter_.note(now, fmt::format("connected again after {:.2f} s", now - *lost_at_));
      lost_at_.reset();
    }
  }

  void prepare(double now) {
    const LinkLeads leads(link_.shared_clock(), options_, teleop_.predictor.step);
    const std::optional<double> command_lead = leads.command_lead();
    if (!command_lead) return;
    const double lead = report_.lead = *command_lead;
    // Time of the recorded motion: the scene's, or since the first session; without one, since this
    // session, because a robot's site that was started again has another clock.
    if (!schedule_.has_begun() || !interface_.cycles()) {
      schedule_.set_zero(welcome_->follows_commands ? link_.shared_clock().shared_at(now) -
                                                          welcome_->start - interface_.start()
                                                    : 0.0);
    }
    schedule_.begin(link_.shared_clock().shared_at(now + world_preparation_.expected_duration()) -
                        welcome_->start + lead,
                    interface_.start(), lead);
    if (is_after_end()) {
      is_done_ = true;
      return;
    }
    report_.correction_delay = leads.correction_delay(lead);
    TeleopOptions options = teleop_;
    options.forward_delay = lead;
    options.backward_delay = std::max(report_.correction_delay - lead, teleop_.backward_delay);
    if (!welcome_->follows_commands) options.retraction_speed = 0.0;
    const std::size_t next = schedule_.next();
    world_preparation_.begin(
        now, world_, options, schedule_.time_of(next - 1),
        interface_.p_base_start(next, welcome_->follows_commands ? robot_.state() : nullptr));
  }

  /// Places the objects where the robot's site sees them: they were moved before this session.
  void place_objects() {
    const LinkState* const state = robot_.state();
    if (state == nullptr || state->objects.size() != site_->objects()) return;
    for (std::size_t i = 0; i < state->objects.size(); ++i) {
      const LinkTrackedObject& object = state->objects[i];
      if (!object.is_tracked || !world_.objects[i].is_movable) continue;
      site_->place(
          i, Pose(object.orientation.cast<double>().normalized(), object.position.cast<double>()));
    }
  }

  [[nodiscard]] bool is_after_end() const {
    const std::optional<std::size_t> cycles = interface_.cycles();
    return cycles && schedule_.next() > *cycles;
  }
  /// When the next command is to be sent, on this site's clock.
  [[nodiscard]] double next_local_time() const {
    return link_.shared_clock().local_at(welcome_->start + schedule_.time_of(schedule_.next()) -
                                         schedule_.lead());
  }

  /// The commands since would come at once.
  [[nodiscard]] bool is_too_late(double now) const {
    return now - next_local_time() > kMaxOperatorBacklog * teleop_.predictor.step;
  }

  /// The duration is the machine's, also where the loop runs in virtual time.
  void timed_cycle(double now) {
    const auto begin = std::chrono::steady_clock::now();
    cycle(now);
    cycles_.add(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }

  void cycle(double now) {
    const double behind = now - next_local_time();
    if (behind > teleop_.predictor.step) ++report_.late_cycles;
    if (is_too_late(now))
      return lose(now, fmt::format("this site did not run for {:.2f} s", behind));
    if (const LinkState* const state = robot_.state()) {
      site_->set_tool_response(state->tool_response);
    }
    const double t_next = welcome_->start + schedule_.time_of(schedule_.next());
    apply_corrections(now, t_next);
    const OperatorCommand moved = interface_.step(schedule_.next(), *site_, link_at(now));
    LinkCommand command;
    command.t = t_next;
    command.correction_delay = static_cast<float>(report_.correction_delay);
    command.p_base_tip = (moved.p_base_tip + site_->tool_offset()).cast<float>();
    command.q_base_tool = moved.q_base_tool.cast<float>();
    command.is_engaged = moved.is_engaged;
    command.acknowledged = corrections_.acknowledgement();
    site_->get_predictions(command.predictions);
    robot_.add_command(command.t, clock_.now(), moved.device_clock);
    log_.on_commanded(link_.session(), command);
    if (predictions_ != nullptr) {
      predictions_->on_predictions(link_.shared_clock().local_at(t_next) - now,
                                   command.predictions);
    }
    link_.send(std::move(command));
    ++report_.commands;
    link_.ping(now, kPingInterval);
    schedule_.advance();
  }

  void check_link(double now) {
    if (!welcome_) return;
    const double silence = link_.silence(now);
    if (silence > options_.timeout) {
      lose(now, fmt::format("nothing from the robot's site for {:.2f} s", silence));
    }
  }

  void apply_corrections(double now, double t_next) {
    const bool was_retracting = site_->retracts_from().has_value();
    corrections_.apply(*site_, link_.session(), now, welcome_->start, t_next);
    if (was_retracting || !site_->retracts_from()) return;
    reporter_.note(now, fmt::format("the tool moves out of {}, which the robot touched first",
                                    scene_.objects[*site_->retracts_from()]));
  }

  /// The clutch opens: no command is sent until a new session begins from the robot's state.
  void lose(double now, const std::string& reason) {
    if (!lost_at_ && site_) {
      reporter_.warn(now, reason + ": the clutch is open, connecting again");
      report_.interruptions.push_back({schedule_.time_of(schedule_.next()), 0.0});
      lost_at_ = now;
    }
    if (site_) {
      report_.late_corrections += site_->late();
      interface_.end();
    }
    site_.reset();
    world_preparation_.cancel();
    welcome_.reset();
    robot_.begin();
    requests_.drop_releases();
    link_.restart();
    attempt_.begin(now);
  }

  OperatorSiteReport describe() {
    if (site_) report_.late_corrections += site_->late();
    link_.add_to(report_);
    corrections_.add_to(report_);
    report_.pictures = pictures_.count();
    report_.picture_age = pictures_.mean_age();
    report_.cycle_times = cycles_.times_of_all();
    return std::move(report_);
  }

  OperatorTransport& client_;
  OperatorInterface& interface_;
  const TeleopInput& world_;
  const TeleopOptions& teleop_;
  const SiteScene& scene_;
  const OperatorSiteOptions& options_;
  SiteReporter reporter_;
  SiteLog& log_;
  PredictionSink* predictions_;
  WorldPreparation world_preparation_;
  CommandSchedule schedule_;
  SiteClock clock_;
  double cpu_before_;  ///< [s]
  double next_event_;  ///< [s]
  OperatorConnection link_;
  ConnectionAttempt attempt_;
  CorrectionIntake corrections_;
  std::optional<LinkWelcome> welcome_;
  double welcomed_ = 0.0;
  std::optional<LiveOperatorSite> site_;
  PictureView pictures_;
  RobotView robot_;
  CycleHistogram cycles_{kCyclesPerSlice};
  SafetyRequests requests_;
  double next_link_ = 0.0;
  std::optional<double> lost_at_;
  std::optional<Error> fault_;
  bool is_done_ = false;
  OperatorSiteReport report_;
};

}  // namespace

Expected<OperatorSiteReport> run_operator_site(
    LinkClient& client, OperatorInterface& interface, const TeleopInput& world,
    const TeleopOptions& teleop, const SiteScene& scene, const OperatorSiteOptions& options,
    const SimulatedNetwork& network, const Observer& observer, const std::atomic<bool>& stop,
    BlackBox* black_box, PredictionSink* predictions) {
  SiteRuntime runtime;
  runtime.predictions = predictions;
  if (black_box != nullptr) runtime.log = &black_box->log();
  OperatorSiteLoop loop(client, interface, world, teleop, scene, options, network, observer,
                        runtime);
  request_site_priority(observer);
  while (!stop && !loop.is_finished()) {
    client.wait(loop.until_due());
    loop.step();
  }
  return loop.finish();
}

std::unique_ptr<SiteSteps<OperatorSiteReport>> make_operator_site_steps(
    OperatorTransport& client, OperatorInterface& interface, const TeleopInput& world,
    const TeleopOptions& teleop, const SiteScene& scene, const OperatorSiteOptions& options,
    const SimulatedNetwork& network, const Observer& observer, const SiteRuntime& runtime) {
  return std::make_unique<OperatorSiteLoop>(client, interface, world, teleop, scene, options,
                                            network, observer, runtime);
}

}  // namespace pcavr
