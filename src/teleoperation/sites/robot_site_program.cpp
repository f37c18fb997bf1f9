// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "pcavr/teleoperation/link/correction_channel.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "operator_session.hpp"
#include "picture_feed.hpp"
#include "robot_measurement.hpp"
#include "robot_safety.hpp"
#include "site_priority.hpp"
#include "site_reporter.hpp"
#include "site_steps.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxReportedCorrections = 10'000;
constexpr std::size_t kMaxMessagesPerCycle = 500;  // of all peers: the robot's cycle goes first
constexpr double kAuthorisationInterval = 0.5;     // [s] between two checks of the operator's key
constexpr double kMinNoticeInterval = 30.0;        // [s] between two lines for the same cause
constexpr double kPhaseAge = 1.0;  // [s] of a phase that is logged: its begin may be revised before
constexpr double kRecordingTail = 0.2;  // [s] after its end, for the last corrections
// Of the time between the last two round trips, and at most [s]: the next one is not expected
// sooner.
constexpr double kPingShare = 0.9;
constexpr double kMaxPingInterval = 0.1;
constexpr double kMaxGap = 0.02;  // [s] without a setpoint, after which the tool has come to rest

/// [s]; a signal ends it.
void sleep_for(double duration) {
  if (duration <= 0.0) return;
  timespec time{};
  time.tv_sec = static_cast<time_t>(duration);
  time.tv_nsec = static_cast<long>(1e9 * (duration - std::floor(duration)));
  ::clock_nanosleep(CLOCK_MONOTONIC, 0, &time, nullptr);
}

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
        predictions_(runtime.predictions),
        clock_(runtime.clock),
        safety_(options.limits, robot.p_base_start()),
        pictures_(robot.pictures(), options.pictures),
        cpu_before_(thread_cpu()),
        next_cycle_(clock_.now() + options.cycle),
        last_step_(clock_.now()) {
    if (robot.follows_commands()) start_ = 0.0;
    log_.on_start(clock_.now());
  }

  [[nodiscard]] double until_due() const override { return next_cycle_ - clock_.now(); }

  /// Whether the next cycle is early enough for the messages that arrive before it. Only a round
  /// trip is not to wait: it measures the clock.
  [[nodiscard]] bool can_receive_by_cycle() const {
    return sessions_.current() != nullptr && clock_.now() < next_ping_;
  }

  void step() override {
    receive();
    last_step_ = clock_.now();
    const double behind = -until_due();
    if (behind < 0.0) return;
    // Missed cycles are not made up for: the setpoint would move faster than its limits permit.
    const bool is_late = behind > options_.cycle;
    if (is_late) ++report_.late_cycles;
    if (behind > kMaxGap) safety_.halt();
    next_cycle_ += options_.cycle + (is_late ? behind : 0.0);
    ++report_.cycles;
    cycle(clock_.now());
  }

  [[nodiscard]] bool is_finished() const override {
    const std::optional<double> end = robot_.end();
    return end && start_ && clock_.now() > *start_ + *end + kRecordingTail &&
           (!session() || session()->corrections.pending() == 0 ||
            clock_.now() > *start_ + *end + 10.0 * kRecordingTail);
  }

  [[nodiscard]] Expected<RobotSiteReport> finish() override {
    if (session()) {
      const LinkPacket packet{session()->peer, {}, {}};
      reject(packet, session()->id, LinkRejection::ended, "the robot's site has ended");
      collect(*session());
    }
    if (start_) log_phases(0.0);
    report_.cpu = thread_cpu() - cpu_before_;
    report_.streaming_bytes = site_.streaming_bytes();
    report_.notes = site_.notes();
    report_.tool_response = measurement_.tool_response();
    return std::move(report_);
  }

 private:
  [[nodiscard]] OperatorSession* session() { return sessions_.current(); }
  [[nodiscard]] const OperatorSession* session() const { return sessions_.current(); }
  void note_received(const LinkHeader& header) { sessions_.note_received(header, last_step_); }

  void cycle(double now) {
    check_session(now);
    execute(now);
    const double cpu = thread_cpu();
    if (start_ && now >= *start_) measure(now);
    if (session()) correct(now);
    for (const std::string& failure : site_.take_failures()) warn(failure, now);
    report_.max_correction_time = std::max(report_.max_correction_time, thread_cpu() - cpu);
    if (session() && now >= next_state_) {
      next_state_ = now + 1.0 / options_.state_rate;
      send_state(now);
    }
    if (session()) send_picture(now);
    for (const std::string& notice : server_.take_notices()) warn(notice, now);
    for (const std::string& notice : robot_.take_notices()) warn(notice, now);
    if (const auto fault = pictures_.take_fault()) warn("no picture: " + *fault, now);
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
    if (const auto* hello = std::get_if<LinkHello>(&message.content)) {
      return on_hello(packet, message.header, *hello, now);
    }
    // Messages of a session that has ended, perhaps over another connection, get no answer: one,
    // also to a ping, would keep the operator's site from seeing that nothing it commands is
    // executed.
    if (!sessions_.has_sent(packet, message.header)) return;
    note_received(message.header);
    if (std::holds_alternative<LinkPing>(message.content)) {
      next_ping_ = now + std::min(kPingShare * (now - last_ping_), kMaxPingInterval);
      last_ping_ = now;
      send(packet.peer, message.header.session, LinkPong{message.header.clock, now});
    } else if (const auto* command = std::get_if<LinkCommand>(&message.content)) {
      on_command(*command, now);
    } else if (const auto* stop = std::get_if<LinkStop>(&message.content)) {
      on_stop(message.header.sequence, *stop, now);
    } else if (std::holds_alternative<LinkReject>(message.content)) {
      reporter_.note(now, "the operator's site has ended: the tool holds");
      safety_.hold_for_silence();
      end_session();
    } else if (const auto* acknowledged = std::get_if<LinkAcknowledgement>(&message.content)) {
      session()->corrections.acknowledge(*acknowledged, now);
    } else if (const auto* receipt = std::get_if<LinkPictureReceipt>(&message.content)) {
      pictures_.note_receipt(*receipt, now);
    }
  }

  void on_hello(const LinkPacket& packet, const LinkHeader& header, const LinkHello& hello,
                double now) {
    if (!server_.is_authorized(packet.key)) {  // its connection is older than the revocation
      return reject(packet, header.session, LinkRejection::revoked,
                    "the key of this operator was revoked");
    }
    if (sessions_.is_old(packet, header)) return;
    if (sessions_.has_sent(packet, header)) {
      note_received(header);
      return welcome();  // the first welcome was lost
    }
    if (sessions_.is_of_another(packet)) {
      return reject(packet, header.session, LinkRejection::busy,
                    sessions_.has_same_key(packet)
                        ? "this key is in use: another operator's site has its session"
                        : "another operator is connected to this robot's site");
    }
    if (session()) end_session();  // what it commanded is stale
    sessions_.begin({.peer = packet.peer,
                     .key = packet.key,
                     .id = header.session,
                     .last_received = now,
                     .newest = header.sequence,
                     .newest_stop = 0,
                     .corrections = {},
                     .commands = CommandBuffer(options_.commands)});
    ++report_.sessions;
    log_.on_session(session()->id, session()->key);
    if (!start_) start_ = now + options_.start_delay;
    // A robot that follows commands may have moved its objects before the first session.
    if (report_.sessions > 1 || robot_.follows_commands()) {
      site_.restart(std::max(now - *start_, 0.0));
    }
    safety_.begin_session();
    pictures_.restart();
    reporter_.note(now, "operator's site connected: " +
                            (hello.name.empty() ? std::string("without name") : hello.name));
    welcome();
  }

  void welcome() {
    LinkWelcome welcome{*start_,        scene_.tool_radius, robot_.follows_commands(),
                        scene_.version, scene_.name,        scene_.objects};
    send(session()->peer, session()->id, std::move(welcome));
  }

  void on_command(const LinkCommand& command, double now) {
    session()->corrections.acknowledge(command.acknowledged, now);
    session()->commands.add(command, now);
  }

  /// One that a newer one has overtaken, or that arrives twice, must not undo the newer one.
  void on_stop(std::uint32_t sequence, LinkStop stop, double now) {
    if (sequence <= session()->newest_stop) return;
    session()->newest_stop = sequence;
    if (safety_.apply(stop, now, reporter_)) ++report_.emergency_stops;
  }

  /// Ends the session of an operator who is silent, or whose key was revoked.
  void check_session(double now) {
    if (!session()) return;
    if (now - session()->last_received > options_.commands.timeout) {
      ++report_.holds;
      safety_.hold_for_silence();
      reporter_.warn(
          now,
          fmt::format("nothing from the operator's site for {:.2f} s: the tool is brought to rest "
                      "within {:.2f} s, and holds",
                      now - session()->last_received, options_.limits.max_hold_time()));
      return end_session();
    }
    if (now < next_authorisation_) return;
    next_authorisation_ = now + kAuthorisationInterval;
    if (server_.is_authorized(session()->key)) return;
    const LinkPacket packet{session()->peer, {}, {}};
    reject(packet, session()->id, LinkRejection::revoked, "the key of this operator was revoked");
    reporter_.warn(now, "the operator's key was revoked: the tool holds");
    safety_.hold_for_silence();
    end_session();
  }

  void end_session() {
    collect(*session());
    measurement_.forget_commands();
    sessions_.end();
    safety_.end_session();
  }

  void collect(const OperatorSession& session) {
    report_.discarded_commands += session.commands.discarded();
    report_.repeated_corrections += session.corrections.repetitions();
  }

  void execute(double now) {
    if (session()) {
      for (const LinkCommand& command : session()->commands.take_due(now)) {
        ++report_.commands;
        measurement_.add({command.t, session()->commands.last_arrival(), now});
        safety_.command(command);
        log_.on_executed(session()->id, session()->key, command);
        if (predictions_ != nullptr) {
          predictions_->on_predictions(command.t - now, command.predictions);
        }
        site_.add_predictions(command.t - *start_, command.predictions, command.correction_delay);
      }
      // Commands that were lost must not stop the tool for as long.
      if (const auto p_base = session()->commands.p_base_at(now)) safety_.lead_to(*p_base);
    }
    safety_.step(session() != nullptr, measurement_.force_base(), options_.cycle);
    robot_.set_command(safety_.p_base(), safety_.q_base_tool());
    if (start_ && robot_.follows_commands()) {
      measurement_.add_setpoint(now - *start_, safety_.p_base());
    }
  }

  void measure(double now) {
    measurement_.advance(now, *start_, robot_, site_, log_);
    if (measurement_.has_fault()) {
      safety_.hold();
      if (const auto& failure = measurement_.failure()) {
        warn("the robot can't be read: the tool holds until it is resumed", now, failure->message);
      } else {
        warn("the robot reports values that are not valid: the tool holds until it is resumed",
             now);
      }
    }
    if (!session()) site_.idle(now - *start_);
  }

  void correct(double now) {
    if (!start_) return;
    for (LiveCorrection& correction : site_.advance(now - *start_)) {
      if (session()->corrections.is_full()) continue;  // then the silence ends this session
      report_.correction_bytes += correction.bytes.size();
      LinkCorrection sent{0, *start_ + correction.sent.t, *start_ + correction.due,
                          std::move(correction.bytes)};
      sent.number = session()->corrections.push(sent);
      log_.on_composed(session()->id, sent);
      if (report_.corrections.size() < kMaxReportedCorrections) {
        report_.corrections.push_back(correction.sent);
      }
    }
    log_phases(kPhaseAge);
    for (LinkCorrection& due : session()->corrections.take_due(now)) {
      send(session()->peer, session()->id, std::move(due));
    }
  }

  void log_phases(double age) {
    for (const LiveRobotSite::PhaseChange& change : site_.take_phase_changes(age)) {
      log_.on_phase(*start_ + change.t, change.object, change.phase);
    }
  }

  void send_state(double now) {
    LinkState state;
    measurement_.describe(now, start_, site_, state);
    safety_.describe(state);
    if (const auto lead = session()->commands.take_min_lead()) lead_ = *lead;
    state.lead = static_cast<float>(lead_);
    state.discarded_commands = session()->commands.discarded();
    state.corrections = session()->corrections.last_number();
    send(session()->peer, session()->id, std::move(state));
  }

  void send_picture(double now) {
    std::optional<LinkPicture> picture = pictures_.step(now, *start_);
    if (!picture) return;
    send(session()->peer, session()->id, std::move(*picture));
    pictures_.note_sent(sequence_, bytes_.size(), now);
    ++report_.pictures;
    report_.picture_bytes += bytes_.size();
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

  /// `detail` may differ from cycle to cycle: it does not make another line of it. A repeated line
  /// allocates nothing.
  void warn(std::string_view line, double now, std::string_view detail = {}) {
    if (line == last_notice_ && now < last_notice_at_ + kMinNoticeInterval) return;
    last_notice_ = line;
    last_notice_at_ = now;
    std::string text(line);
    if (!detail.empty()) text.append(" (").append(detail).append(")");
    reporter_.warn(now, text);
  }

  RobotTransport& server_;
  RobotInterface& robot_;
  LiveRobotSite& site_;
  const SiteScene& scene_;
  const RobotSiteOptions& options_;
  SiteReporter reporter_;
  SiteLog& log_;
  PredictionSink* predictions_;
  SiteClock clock_;  ///< the shared one
  RobotSafety safety_;
  PictureFeed pictures_;
  RobotMeasurement measurement_;
  double cpu_before_;            ///< [s]
  double next_cycle_;            ///< [s]
  double last_step_;             ///< [s] when messages were received last
  std::optional<double> start_;  ///< [s] time zero of the scene
  OperatorSessions sessions_;
  RobotSiteReport report_;
  double lead_ = 0.0;
  double next_state_ = 0.0;
  double next_authorisation_ = 0.0;
  double last_ping_ = 0.0;  ///< [s]
  double next_ping_ = 0.0;  ///< [s] not expected before
  std::uint32_t sequence_ = 0;
  LinkMessage message_;
  std::vector<std::uint8_t> bytes_;
  std::string last_notice_;
  double last_notice_at_ = 0.0;
};

}  // namespace

Expected<RobotSiteReport> run_robot_site(LinkServer& server, RobotInterface& robot,
                                         LiveRobotSite& site, const SiteScene& scene,
                                         const RobotSiteOptions& options, const Observer& observer,
                                         const std::atomic<bool>& stop, BlackBox* black_box,
                                         PredictionSink* predictions) {
  SiteRuntime runtime;
  runtime.predictions = predictions;
  if (black_box != nullptr) runtime.log = &black_box->log();
  site.set_waiting(false);
  RobotSiteLoop loop(server, robot, site, scene, options, observer, runtime);
  request_site_priority(observer);
  while (!stop && !loop.is_finished()) {
    if (loop.can_receive_by_cycle()) {
      sleep_for(loop.until_due());
    } else {
      server.wait(loop.until_due());
    }
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
