// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "pcavr/core/options.hpp"
#include "pcavr/link/correction_channel.hpp"
#include "pcavr/pipeline/black_box.hpp"
#include "pcavr/pipeline/link_sites.hpp"

#include "site_clock.hpp"
#include "site_priority.hpp"
#include "site_reporter.hpp"
#include "site_steps.hpp"

namespace pcavr {
namespace {

constexpr auto kRobotSiteFields = std::to_array<OptionField<RobotSiteOptions>>({
    {"cycle", &RobotSiteOptions::cycle, 0.001, 2e-4, 0.1, "s", "period of the site's loop",
     "lower: computing time; higher: the tool moves in steps"},
    {"state_rate", &RobotSiteOptions::state_rate, 100.0, 1.0, 1000.0, "Hz",
     "states sent to the operator's site",
     "lower: the operator sees the robot late; higher: bandwidth"},
    {"start_delay", &RobotSiteOptions::start_delay, 1.5, 0.0, 60.0, "s",
     "time from the first operator's arrival to the beginning of a recording",
     "lower: the operator's clock is not known when it begins; higher: waiting"},
});
static_assert(are_valid_fields(kRobotSiteFields));

constexpr std::size_t kMaxReportedCorrections = 10'000;
constexpr std::size_t kMaxMessagesPerCycle = 500;  // of all peers: the robot's cycle goes first
constexpr double kAuthorisationInterval = 0.5;     // [s] between two checks of the operator's key
constexpr double kMinNoticeInterval = 30.0;        // [s] between two lines for the same cause
constexpr double kRecordingTail = 0.2;             // [s] after its end, for the last corrections
constexpr std::size_t kMaxUnsensed = 2000;         // commands: of a robot that gives no samples
constexpr double kMaxGap = 0.02;    // [s] without a setpoint, after which the tool has come to rest
constexpr double kSameTime = 1e-9;  // [s]

/// What one connected operator's site has sent, and is to receive.
struct OperatorSession {
  std::string peer;
  std::string key;
  std::uint32_t id = 0;
  double last_received = 0.0;
  std::uint32_t newest = 0;       ///< sequence number of its messages so far
  std::uint32_t newest_stop = 0;  ///< sequence number of the newest hold, stop or release
  CorrectionSender corrections;
  CommandBuffer commands;
};

/// [s] on the shared clock.
struct ExecutedCommand {
  double t = 0.0;  ///< of execution, as the operator's site wanted it
  double received = 0.0;
  double applied = 0.0;  ///< when it became the setpoint
};

class RobotSiteLoop final : public SiteSteps<RobotSiteReport> {
 public:
  RobotSiteLoop(RobotTransport& server, RobotInterface& robot, LiveRobotSite& site,
                const SiteScene& scene, const RobotSiteOptions& options, const Observer& observer,
                const SiteRuntime& runtime)
      : server_(server),
        robot_(robot),
        site_(site),
        scene_(scene),
        options_(options),
        reporter_(observer, runtime.log),
        log_(reporter_.log()),
        clock_(runtime.clock),
        limiter_(options.limits, robot.p_base_start()),
        cpu_before_(thread_cpu()),
        next_cycle_(clock_.now() + options.cycle),
        last_step_(clock_.now()) {
    if (robot.follows_commands()) start_ = 0.0;
    log_.on_start(clock_.now());
  }

  [[nodiscard]] double until_due() const override { return next_cycle_ - clock_.now(); }

  void step() override {
    receive();
    last_step_ = clock_.now();
    const double behind = -until_due();
    if (behind < 0.0) return;
    // What was missed is not made up for: the setpoint would move faster than its limits permit.
    const bool is_late = behind > options_.cycle;
    if (is_late) ++report_.late_cycles;
    if (behind > kMaxGap) limiter_.halt();
    next_cycle_ += options_.cycle + (is_late ? behind : 0.0);
    ++report_.cycles;
    cycle(clock_.now());
  }

  [[nodiscard]] bool is_finished() const override {
    const std::optional<double> end = robot_.end();
    return end && start_ && clock_.now() > *start_ + *end + kRecordingTail &&
           (!session_ || session_->corrections.pending() == 0 ||
            clock_.now() > *start_ + *end + 10.0 * kRecordingTail);
  }

  [[nodiscard]] Expected<RobotSiteReport> finish() override {
    if (session_) {
      const LinkPacket packet{session_->peer, {}, {}};
      reject(packet, session_->id, LinkRejection::ended, "the robot's site has ended");
      collect(*session_);
    }
    report_.cpu = thread_cpu() - cpu_before_;
    report_.streaming_bytes = site_.streaming_bytes();
    report_.notes = site_.notes();
    return std::move(report_);
  }

 private:
  void cycle(double now) {
    check_session(now);
    execute(now);
    const double cpu = thread_cpu();
    if (start_ && now >= *start_) measure(now);
    if (session_) correct(now);
    if (has_composed_) {
      report_.max_correction_time = std::max(report_.max_correction_time, thread_cpu() - cpu);
      has_composed_ = false;
    }
    if (session_ && now >= next_state_) {
      next_state_ = now + 1.0 / options_.state_rate;
      send_state(now);
    }
    for (const std::string& notice : server_.take_notices()) warn(notice, now);
    reporter_.check_log();
  }

  void receive() {
    for (std::size_t i = 0; i < kMaxMessagesPerCycle; ++i) {
      const std::optional<LinkPacket> packet = server_.receive();
      if (!packet) return;
      const double now = clock_.now();
      const Expected<LinkMessage> message = decode_link_message(packet->bytes);
      if (message) {
        if (SiteReporter::is_logged(*message)) log_.on_received(now, packet->bytes);
        on_message(*packet, *message, now);
        continue;
      }
      ++report_.invalid_messages;
      const std::optional<int> version = link_version_of(packet->bytes);
      if (version && *version != kLinkVersion) {
        reject(*packet, 0, LinkRejection::other_version,
               fmt::format("this robot's site uses pcavr-link {}, not {}", kLinkVersion, *version));
      }
      warn("a message was not valid: " + message.error().to_string(), now);
    }
  }

  void on_message(const LinkPacket& packet, const LinkMessage& message, double now) {
    if (std::holds_alternative<LinkPing>(message.content)) {
      if (is_of_session(packet, message)) note_received(message.header);
      return send(packet.peer, message.header.session, LinkPong{message.header.clock, now});
    }
    if (const auto* hello = std::get_if<LinkHello>(&message.content)) {
      return on_hello(packet, message.header, *hello, now);
    }
    if (!is_of_session(packet, message)) return;  // of a session that has ended
    note_received(message.header);
    if (const auto* command = std::get_if<LinkCommand>(&message.content)) {
      on_command(*command, now);
    } else if (const auto* stop = std::get_if<LinkStop>(&message.content)) {
      on_stop(message.header.sequence, *stop, now);
    } else if (std::holds_alternative<LinkReject>(message.content)) {
      reporter_.note(now, "the operator's site has ended: the tool holds");
      has_silence_hold_ = true;
      end_session();
    } else if (const auto* acknowledged = std::get_if<LinkAcknowledgement>(&message.content)) {
      session_->corrections.acknowledge(*acknowledged, now);
    }
  }

  [[nodiscard]] bool is_of_session(const LinkPacket& packet, const LinkMessage& message) const {
    return session_ && session_->peer == packet.peer && session_->id == message.header.session;
  }

  /// Only newer messages show that the operator's site is there: not repeated ones, nor those that
  /// waited while this site did not run, and so count from when it ran last.
  void note_received(const LinkHeader& header) {
    if (header.sequence <= session_->newest) return;
    session_->newest = header.sequence;
    session_->last_received = std::max(session_->last_received, last_step_);
  }

  /// A connection's hello that is not newer than what it sent in its last session.
  [[nodiscard]] bool is_old(const LinkPacket& packet, const LinkHeader& header) const {
    if (session_) return session_->peer == packet.peer && header.sequence <= session_->newest;
    return ended_peer_ == packet.peer && header.sequence <= ended_newest_;
  }

  void on_hello(const LinkPacket& packet, const LinkHeader& header, const LinkHello& hello,
                double now) {
    if (!server_.is_authorized(packet.key)) {  // its connection is older than the revocation
      return reject(packet, header.session, LinkRejection::revoked,
                    "the key of this operator was revoked");
    }
    if (is_old(packet, header)) return;
    if (session_ && session_->peer == packet.peer && session_->id == header.session) {
      note_received(header);
      return welcome();  // the first welcome was lost
    }
    const bool is_other = session_ && session_->peer != packet.peer &&
                          (session_->key != packet.key || packet.key.empty());
    if (is_other) {
      return reject(packet, header.session, LinkRejection::busy,
                    "another operator is connected to this robot's site");
    }
    if (session_) end_session();  // what it commanded is stale
    session_ = OperatorSession{.peer = packet.peer,
                               .key = packet.key,
                               .id = header.session,
                               .last_received = now,
                               .newest = header.sequence,
                               .newest_stop = 0,
                               .corrections = {},
                               .commands = CommandBuffer(options_.commands)};
    ++report_.sessions;
    log_.on_session(session_->id, session_->key);
    if (!start_) start_ = now + options_.start_delay;
    // A robot that follows commands may have moved its objects before the first session.
    if (report_.sessions > 1 || robot_.follows_commands()) {
      site_.restart(std::max(now - *start_, 0.0));
    }
    has_silence_hold_ = false;
    reporter_.note(now, "operator's site connected: " +
                            (hello.name.empty() ? std::string("without name") : hello.name));
    welcome();
  }

  void welcome() {
    LinkWelcome welcome{*start_,        scene_.tool_radius, robot_.follows_commands(),
                        scene_.version, scene_.name,        scene_.objects};
    send(session_->peer, session_->id, std::move(welcome));
  }

  void on_command(const LinkCommand& command, double now) {
    session_->corrections.acknowledge(command.acknowledged, now);
    session_->commands.add(command, now);
  }

  /// One that a newer one has overtaken, or that arrives twice, must not undo the newer one.
  void on_stop(std::uint32_t sequence, LinkStop stop, double now) {
    if (sequence <= session_->newest_stop) return;
    session_->newest_stop = sequence;
    switch (stop) {
      case LinkStop::hold:
        is_on_hold_ = true;
        break;
      case LinkStop::resume:
        if (!is_stopped_) is_on_hold_ = false;
        break;
      case LinkStop::emergency_stop:
        if (!is_stopped_) reporter_.warn(now, "emergency stop: the tool holds until its release");
        report_.emergency_stops += is_stopped_ ? 0U : 1U;
        is_stopped_ = is_on_hold_ = true;
        break;
      case LinkStop::reset:
        if (is_stopped_) reporter_.note(now, "the emergency stop was released: on hold");
        is_stopped_ = false;
        break;
    }
  }

  /// Ends the session of an operator who is silent, or whose key was revoked.
  void check_session(double now) {
    if (!session_) return;
    if (now - session_->last_received > options_.commands.timeout) {
      ++report_.holds;
      has_silence_hold_ = true;
      reporter_.warn(
          now,
          fmt::format("nothing from the operator's site for {:.2f} s: the tool is brought to rest "
                      "within {:.2f} s, and holds",
                      now - session_->last_received, options_.limits.max_hold_time()));
      return end_session();
    }
    if (now < next_authorisation_) return;
    next_authorisation_ = now + kAuthorisationInterval;
    if (server_.is_authorized(session_->key)) return;
    const LinkPacket packet{session_->peer, {}, {}};
    reject(packet, session_->id, LinkRejection::revoked, "the key of this operator was revoked");
    reporter_.warn(now, "the operator's key was revoked: the tool holds");
    has_silence_hold_ = true;
    end_session();
  }

  void end_session() {
    collect(*session_);
    unsensed_.clear();
    ended_peer_ = session_->peer;
    ended_newest_ = session_->newest;
    session_.reset();
    is_engaged_ = false;
    target_.reset();
  }

  void collect(const OperatorSession& session) {
    report_.discarded_commands += session.commands.discarded();
    report_.repeated_corrections += session.corrections.repetitions();
  }

  void execute(double now) {
    if (session_) {
      for (const LinkCommand& command : session_->commands.take_due(now)) {
        ++report_.commands;
        unsensed_.push_back({command.t, session_->commands.last_arrival(), now});
        is_engaged_ = command.is_engaged;
        target_ = command.p_base_tip.cast<double>();
        q_base_tool_ = command.q_base_tool.cast<double>().normalized();
        log_.on_executed(session_->id, session_->key, command);
        site_.add_predictions(command.t - *start_, command.predictions);
      }
    }
    const bool may_move = session_ && is_engaged_ && !is_on_hold_ && !is_stopped_;
    limiter_.step(may_move ? target_ : std::nullopt, force_base_, options_.cycle);
    limits_ |= limiter_.active();
    robot_.set_command(limiter_.p_base(), q_base_tool_);
  }

  void measure(double now) {
    samples_.clear();
    robot_.advance(now - *start_, samples_);
    for (const RobotSamples::Tool& tool : samples_.tool) {
      site_.add_tool(tool.t, tool.p_base_tip, tool.q_base_tool);
      tool_ = tool;
      log_.on_tool(*start_ + tool.t, tool);
    }
    for (const RobotSamples::Wrench& wrench : samples_.wrench) {
      site_.add_wrench(wrench.t, wrench.force_base);
      force_base_ = wrench.force_base;
      torque_base_ = wrench.torque_base;
      log_.on_wrench(*start_ + wrench.t, wrench);
    }
    for (const RobotSamples::Tracked& tracked : samples_.tracked) {
      site_.add_tracked(tracked.object, tracked.pose);
      if (tracked_.size() <= tracked.object) tracked_.resize(tracked.object + 1);
      tracked_[tracked.object] = tracked.pose;
      log_.on_tracked(*start_ + tracked.pose.t, tracked);
    }
    if (!session_) site_.idle(now - *start_);
  }

  void correct(double now) {
    for (LiveCorrection& correction : site_.advance()) {
      has_composed_ = true;
      if (session_->corrections.is_full()) continue;  // then the silence ends this session
      report_.correction_bytes += correction.bytes.size();
      const double t = *start_ + correction.sent.t;
      const std::uint32_t number = session_->corrections.push(t, correction.bytes);
      log_.on_composed(session_->id, {number, t, std::move(correction.bytes)});
      if (report_.corrections.size() < kMaxReportedCorrections) {
        report_.corrections.push_back(correction.sent);
      }
    }
    for (LinkCorrection& due : session_->corrections.take_due(now)) {
      send(session_->peer, session_->id, std::move(due));
    }
  }

  /// A sample at `t` contains nothing of a command that became the setpoint later.
  void sense(double t) {
    for (; !unsensed_.empty(); unsensed_.pop_front()) {
      const bool is_sensed = unsensed_.front().applied <= t + kSameTime;
      if (!is_sensed && unsensed_.size() <= kMaxUnsensed) return;
      if (is_sensed) sensed_ = unsensed_.front();
    }
  }

  void send_state(double now) {
    LinkState state;
    state.t = start_ ? *start_ + tool_.t : now;
    sense(state.t);
    state.executed = sensed_.t;
    state.received = sensed_.received;
    state.applied = sensed_.applied;
    if (const auto lead = session_->commands.take_min_lead()) lead_ = *lead;
    state.lead = static_cast<float>(lead_);
    state.limits = std::exchange(limits_, 0U);
    state.is_engaged = is_engaged_;
    state.is_on_hold = is_on_hold_ || has_silence_hold_;
    state.is_stopped = is_stopped_;
    state.discarded_commands = session_->commands.discarded();
    state.corrections = session_->corrections.last_number();
    state.p_base_tip = tool_.p_base_tip.cast<float>();
    state.q_base_tool = tool_.q_base_tool.cast<float>();
    state.force_base = force_base_.cast<float>();
    state.torque_base = torque_base_.cast<float>();
    for (std::size_t i = 0; i < site_.objects(); ++i) {
      LinkTrackedObject& object = state.objects.emplace_back();
      object.phase = site_.phase(i);
      if (i >= tracked_.size() || !tracked_[i]) continue;
      object.is_tracked = true;
      object.position = tracked_[i]->T_base_object.translation().cast<float>();
      object.orientation = tracked_[i]->T_base_object.rotation().cast<float>();
      object.position_std = static_cast<float>(tracked_[i]->position_std);
      object.age = static_cast<float>(now - *start_ - tracked_[i]->t);
    }
    send(session_->peer, session_->id, std::move(state));
  }

  template <typename Content>
  void send(const std::string& peer, std::uint32_t session, Content&& content) {
    message_.header = {++sequence_, session, clock_.now()};
    message_.content = std::forward<Content>(content);
    encode_link_message(message_, bytes_);
    if (SiteReporter::is_logged(message_)) log_.on_sent(message_.header.clock, bytes_);
    server_.send(peer, bytes_);
  }

  void reject(const LinkPacket& packet, std::uint32_t session, LinkRejection reason,
              std::string text) {
    send(packet.peer, session, LinkReject{reason, std::move(text)});
  }

  void warn(const std::string& line, double now) {
    if (line == last_notice_ && now < last_notice_at_ + kMinNoticeInterval) return;
    last_notice_ = line;
    last_notice_at_ = now;
    reporter_.warn(now, line);
  }

  RobotTransport& server_;
  RobotInterface& robot_;
  LiveRobotSite& site_;
  const SiteScene& scene_;
  const RobotSiteOptions& options_;
  SiteReporter reporter_;
  SiteLog& log_;
  SiteClock clock_;  ///< the shared one
  MotionLimiter limiter_;
  double cpu_before_;            ///< [s]
  double next_cycle_;            ///< [s]
  double last_step_;             ///< [s] when messages were received last
  std::optional<double> start_;  ///< [s] time zero of the scene
  std::optional<OperatorSession> session_;
  std::string ended_peer_;          ///< of the last session that has ended
  std::uint32_t ended_newest_ = 0;  ///< sequence number of its messages
  RobotSiteReport report_;
  bool is_engaged_ = false;
  bool is_on_hold_ = false;        ///< by the operator
  bool is_stopped_ = false;        ///< emergency stop
  bool has_silence_hold_ = false;  ///< until the next session
  std::optional<Eigen::Vector3d> target_;
  Eigen::Quaterniond q_base_tool_ = Eigen::Quaterniond::Identity();
  std::deque<ExecutedCommand> unsensed_;  ///< later than the newest sample
  ExecutedCommand sensed_;                ///< the newest of the others
  double lead_ = 0.0;
  std::uint32_t limits_ = 0;
  RobotSamples samples_;
  RobotSamples::Tool tool_;
  Eigen::Vector3d force_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_base_ = Eigen::Vector3d::Zero();
  std::vector<std::optional<TrackedPose>> tracked_;
  bool has_composed_ = false;
  double next_state_ = 0.0;
  double next_authorisation_ = 0.0;
  std::uint32_t sequence_ = 0;
  LinkMessage message_;
  std::vector<std::uint8_t> bytes_;
  std::string last_notice_;
  double last_notice_at_ = 0.0;
};

}  // namespace

RobotSiteOptions::RobotSiteOptions() { set_defaults(*this, kRobotSiteFields); }
OptionSection section_of(RobotSiteOptions& options) {
  return make_section("robot_site", options, kRobotSiteFields);
}

Expected<RobotSiteReport> run_robot_site(LinkServer& server, RobotInterface& robot,
                                         LiveRobotSite& site, const SiteScene& scene,
                                         const RobotSiteOptions& options, const Observer& observer,
                                         const std::atomic<bool>& stop, BlackBox* black_box) {
  SiteRuntime runtime;
  if (black_box != nullptr) runtime.log = &black_box->log();
  RobotSiteLoop loop(server, robot, site, scene, options, observer, runtime);
  request_site_priority(observer);
  while (!stop && !loop.is_finished()) {
    server.wait(loop.until_due());
    loop.step();
  }
  return loop.finish();
}

std::unique_ptr<SiteSteps<RobotSiteReport>> make_robot_site_steps(
    RobotTransport& server, RobotInterface& robot, LiveRobotSite& site, const SiteScene& scene,
    const RobotSiteOptions& options, const Observer& observer, const SiteRuntime& runtime) {
  return std::make_unique<RobotSiteLoop>(server, robot, site, scene, options, observer, runtime);
}

}  // namespace pcavr
