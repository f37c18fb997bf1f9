// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <random>
#include <utility>

#include <fmt/core.h>

#include "pcavr/core/options.hpp"
#include "pcavr/link/correction_channel.hpp"
#include "pcavr/link/link_clock.hpp"
#include "pcavr/pipeline/black_box.hpp"
#include "pcavr/pipeline/link_sites.hpp"

#include "delayed_transport.hpp"
#include "site_clock.hpp"
#include "site_priority.hpp"
#include "site_reporter.hpp"
#include "site_steps.hpp"

namespace pcavr {
namespace {

constexpr auto kOperatorSiteFields = std::to_array<OptionField<OperatorSiteOptions>>({
    {"connection_timeout", &OperatorSiteOptions::connection_timeout, 10.0, 0.1, 3600.0, "s",
     "time until the first connection to the robot's site is given up",
     "lower: a slow link is given up; higher: a wrong address is noticed late"},
    {"timeout", &OperatorSiteOptions::timeout, 0.25, 0.01, 10.0, "s",
     "time without any message of the robot's site, after which the link counts as lost",
     "lower: jitter opens the clutch; higher: the operator moves a tool that nothing follows"},
    {"lead_margin", &OperatorSiteOptions::lead_margin, 0.005, 0.0, 1.0, "s",
     "time by which commands shall arrive before their execution, beyond four variations of the "
     "delay",
     "lower: commands are executed late; higher: predicts further than necessary"},
    {"min_clock_time", &OperatorSiteOptions::min_clock_time, 0.5, 0.05, 60.0, "s",
     "time of round trips before the first command",
     "lower: the clock is uncertain at first; higher: waiting"},
});
static_assert(are_valid_fields(kOperatorSiteFields));

constexpr double kHelloInterval = 0.1;       // [s] below the robot site's timeout
constexpr double kFirstPingInterval = 0.01;  // [s] until the first command
constexpr double kPingInterval = 0.1;        // [s]
constexpr double kLinkInterval = 1.0;        // [s] between two statistics in the log
constexpr std::size_t kMinRoundTrips = 10;
constexpr double kIdleWait = 0.002;  // [s] while there is no cycle to wait for
constexpr double kRequestInterval =
    0.02;  // [s] until a stop or a hold is seen in the robot's state
constexpr double kPreparationMargin = 1.5;  // of the time that the last preparation took
constexpr double kDelayVariations = 4.0;
constexpr double kMaxEarly = 0.4;  // [s] that commands may arrive early: below max_lead
// Cycles behind, of more this site did not run: it begins anew from the robot's state.
constexpr double kMaxOperatorBacklog = 200.0;
constexpr double kMaxFlush = 2.0;      // [s] of a simulated network, at the end
constexpr double kCloseTimeout = 0.2;  // [s] until the last message has left
constexpr std::size_t kMaxReportedTimes = 10'000;

std::uint32_t random_session() {
  // Sessions of different processes must differ; nothing is computed from it.
  std::uint32_t session = 0;
  while (session == 0) session = std::random_device{}();
  return session;
}

class OperatorSiteLoop final : public SiteSteps<OperatorSiteReport> {
 public:
  OperatorSiteLoop(OperatorTransport& client, OperatorInterface& person, const TeleopInput& world,
                   const TeleopOptions& teleop, const SiteScene& scene,
                   const OperatorSiteOptions& options, const SimulatedNetwork& network,
                   const Observer& observer, const SiteRuntime& runtime)
      : client_(client),
        person_(person),
        world_(world),
        teleop_(teleop),
        scene_(scene),
        options_(options),
        reporter_(observer, runtime.log),
        log_(reporter_.log()),
        new_session_(runtime.new_session ? runtime.new_session : random_session),
        prepares_at_once_(runtime.prepares_at_once),
        clock_(runtime.clock),
        cpu_before_(thread_cpu()),
        next_event_(clock_.now() + kIdleWait),
        network_(client, network),
        session_(new_session_()),
        last_received_(clock_.now()) {
    log_.on_start(clock_.now());
  }

  [[nodiscard]] double until_due() const override {
    // A simulated arrival is also an event.
    double until = next_event_;
    if (const auto event = network_.next_event()) until = std::min(until, *event);
    return until - clock_.now();
  }

  void step() override {
    exchange();
    if (is_finished() || clock_.now() < next_event_) return;
    act(clock_.now());
    network_.transmit(clock_.now());
    // A recording may begin later: until then round trips keep the session alive.
    const double idle = clock_.now() + (site_ ? kFirstPingInterval : kIdleWait);
    next_event_ = site_ ? std::min(local_time_of(next_cycle_), idle) : idle;
  }

  [[nodiscard]] bool is_finished() const override { return is_done_ || fault_; }

  [[nodiscard]] Expected<OperatorSiteReport> finish() override {
    if (welcome_) {
      send(LinkReject{LinkRejection::ended, "the operator's site has ended"});
      flush();
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
    if (!site_) person_.wait(link_at(now));
    request(now);
    if (site_ && now < local_time_of(next_cycle_)) {
      ping(now, kFirstPingInterval);
    } else if (site_) {
      cycle(now);
    } else {
      connect(now);
    }
  }

  void exchange() {
    network_.transmit(clock_.now());
    while (const auto bytes = network_.receive(clock_.now())) on_bytes(*bytes, clock_.now());
  }

  /// What is still in the simulated network, and the socket's own thread.
  void flush() {
    const double end = clock_.now() + kMaxFlush;
    while (network_.leaving() > 0 && clock_.now() < end) {
      client_.wait(kIdleWait);
      network_.transmit(clock_.now());
    }
    client_.close(kCloseTimeout);
  }

  template <typename Content>
  void send(Content&& content) {
    const double now = clock_.now();
    message_.header = {++sequence_, session_, now};
    message_.content = std::forward<Content>(content);
    encode_link_message(message_, bytes_);
    if (SiteReporter::is_logged(message_)) log_.on_sent(now, bytes_);
    network_.send(now, bytes_);
  }

  void on_bytes(const std::vector<std::uint8_t>& bytes, double now) {
    Expected<LinkMessage> message = decode_link_message(bytes);
    if (!message) {
      const std::optional<int> version = link_version_of(bytes);
      if (version && *version != kLinkVersion) {
        fault_ = Error{.message = fmt::format("the robot's site uses pcavr-link {}, this one {}",
                                              *version, kLinkVersion),
                       .hint = "install the same version of pcavr at both sites"};
      }
      ++report_.invalid_messages;
      return;
    }
    if (SiteReporter::is_logged(*message)) log_.on_received(now, bytes);
    if (const auto* rejected = std::get_if<LinkReject>(&message->content)) {
      if (message->header.session == session_ || message->header.session == 0) {
        on_reject(*rejected);
      }
      return;
    }
    if (message->header.session != session_) return;    // of an earlier session
    if (message->header.sequence > newest_received_) {  // a repetition shows nothing
      newest_received_ = message->header.sequence;
      last_received_ = now;
    }
    if (const auto* pong = std::get_if<LinkPong>(&message->content)) {
      shared_clock_.add({pong->sent, pong->received, message->header.clock, now});
      ++round_trips_;
    } else if (auto* welcome = std::get_if<LinkWelcome>(&message->content)) {
      on_welcome(std::move(*welcome), now);
    } else if (auto* correction = std::get_if<LinkCorrection>(&message->content)) {
      if (!corrections_.accept(std::move(*correction))) ++report_.repeated_corrections;
    } else if (auto* state = std::get_if<LinkState>(&message->content)) {
      on_state(message->header, std::move(*state), now);
    }
  }

  void on_state(const LinkHeader& header, LinkState state, double now) {
    if (header.sequence <= state_sequence_) return;  // overtaken
    state_sequence_ = header.sequence;
    state_ = std::move(state);
    if (!shared_clock_.is_known()) return;
    const std::optional<SentCommands::Sent> sent = sent_.find(state_->executed);
    if (!sent) return;
    const auto local = [this](double shared) {
      return clock_.monotonic(shared_clock_.local_at(shared));
    };
    delays_ = DelayStamps{sent->device_clock,      clock_.monotonic(sent->sent),
                          local(state_->received), local(state_->applied),
                          local(state_->t),        local(header.clock),
                          clock_.monotonic(now)};
    report_.delays.add(*delays_);
    log_.on_delays(now, *delays_);
  }

  void log_link(double now) {
    if (now < next_link_) return;
    next_link_ = now + kLinkInterval;
    log_.on_link(now, {.clock_offset = shared_clock_.shared_at(now) - now,
                       .clock_std = shared_clock_.std(),
                       .round_trip = shared_clock_.min_delay(),
                       .delay_variation = shared_clock_.delay_variation(),
                       .lead = lead_});
  }

  [[nodiscard]] OperatorLink link_at(double now) const {
    return {.now = clock_.monotonic(now),
            .is_connected = site_.has_value(),
            .silence = now - last_received_,
            .lead = lead_,
            .round_trip = shared_clock_.is_known() ? shared_clock_.min_delay() : 0.0,
            .clock_std = shared_clock_.is_known() ? shared_clock_.std() : 0.0,
            .robot = state_ ? &*state_ : nullptr,
            .delays = delays_};
  }

  /// Stops and holds are repeated until the robot's state agrees. A release or a resume that was
  /// not confirmed is not carried into another session: there it has to be wanted anew.
  void request(double now) {
    const OperatorRequests wanted = person_.take_requests();
    if (wanted.is_stopped) wanted_.is_stopped = wanted.is_stopped;
    if (wanted.is_on_hold) wanted_.is_on_hold = wanted.is_on_hold;
    if (wanted.is_stopped || wanted.is_on_hold) next_request_ = now;
    if (!welcome_) drop_releases();
    if (!welcome_ || now < next_request_) return;
    next_request_ = now + kRequestInterval;
    if (state_ && wanted_.is_stopped == state_->is_stopped) wanted_.is_stopped.reset();
    if (state_ && wanted_.is_on_hold == state_->is_on_hold) wanted_.is_on_hold.reset();
    if (wanted_.is_stopped) {
      send(*wanted_.is_stopped ? LinkStop::emergency_stop : LinkStop::reset);
    }
    if (wanted_.is_on_hold) send(*wanted_.is_on_hold ? LinkStop::hold : LinkStop::resume);
  }

  void drop_releases() {
    if (wanted_.is_stopped == false) wanted_.is_stopped.reset();
    if (wanted_.is_on_hold == false) wanted_.is_on_hold.reset();
  }

  void on_reject(const LinkReject& rejected) {
    if (rejected.reason == LinkRejection::ended) {
      // Without an end of its own, this site waits for the robot's to be started again.
      is_done_ = person_.cycles().has_value();
      if (!is_done_ && welcome_) lose(clock_.now(), "the robot's site has ended");
      return;
    }
    if (rejected.reason == LinkRejection::busy) {
      is_busy_ = true;  // perhaps with this operator's last session, which ends soon
      return;
    }
    const bool is_version = rejected.reason == LinkRejection::other_version;
    fault_ = Error{.message = "the robot's site rejects this one: " + rejected.text,
                   .hint = is_version ? "install the same version of pcavr at both sites" : ""};
  }

  void on_welcome(LinkWelcome welcome, double now) {
    if (welcome_) return;
    if (welcome.objects != scene_.objects) {
      fault_ = Error{.message = "the robot's site has another scene: " + welcome.scene +
                                ", with other objects than " + scene_.name,
                     .hint = "give both sites the same scene"};
      return;
    }
    if (person_.needs_follower() && !welcome.follows_commands) {
      fault_ = Error{.message = "the robot's site plays a recording, which follows no commands",
                     .hint = "start it with --plant, or give this site --trace"};
      return;
    }
    welcome_ = std::move(welcome);
    welcomed_ = now;
    ++report_.sessions;
  }

  /// Hello until there is a welcome, then round trips until the clock is known.
  void connect(double now) {
    if (!welcome_ && now >= next_hello_) {
      next_hello_ = now + kHelloInterval;
      send(LinkHello{scene_.version, "operator-site"});
    }
    if (!welcome_) return check_connection(now);
    ping(now, kFirstPingInterval);
    if (round_trips_ < kMinRoundTrips || now - welcomed_ < options_.min_clock_time) return;
    begin(now);
  }

  void check_connection(double now) {
    if (has_connected_) return;  // an interruption: waits for the robot's site
    const LinkClient::State state = client_.state();
    if (state == LinkClient::State::rejected) {
      fault_ = Error{.message = "the robot's site does not accept this key",
                     .hint = "put its .pub file into the folder --authorized of the robot's site"};
    }
    if (now < options_.connection_timeout) return;
    if (is_busy_) {
      fault_ = Error{.message = "another operator is connected to the robot's site"};
      return;
    }
    fault_ = state == LinkClient::State::no_handshake
                 ? Error{.message =
                             "the robot's site ended the handshake: its key is not "
                             "--robot-key, or one of the two sites has no keys",
                         .hint = "give the robot's .pub file with --robot-key, and --key"}
                 : Error{.message = "no answer from the robot's site",
                         .hint = "check address and port, and whether it runs"};
  }

  /// The world as the scene describes it; the robot's site then sends what differs.
  /// It takes as long as a session lasts without messages, so it is made while round trips go on.
  void begin(double now) {
    if (!preparing_.valid()) return prepare(now);
    const bool is_ready = prepares_at_once_ ||
                          preparing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_ready) return;
    preparation_time_ = std::max(preparation_time_, kPreparationMargin * (now - prepared_since_));
    Expected<LiveOperatorSite> site = preparing_.get();
    if (!site) {
      fault_ = site.error();
      return;
    }
    has_connected_ = true;
    site_.emplace(std::move(*site));
    next_link_ = now;
    if (welcome_->follows_commands) place_objects();
    person_.begin(*site_);
    corrections_ = {};
    if (lost_at_) {
      report_.interruptions.back().duration = now - *lost_at_;
      reporter_.note(now, fmt::format("connected again after {:.2f} s", now - *lost_at_));
      lost_at_.reset();
    }
  }

  void prepare(double now) {
    const double early = kDelayVariations * shared_clock_.delay_variation() + options_.lead_margin;
    if (early > kMaxEarly) return;  // the link is not steady yet: the robot would wait for long
    const double lead = 0.5 * shared_clock_.mean_delay() + early;
    report_.lead = lead;
    prepared_since_ = now;
    // Time of the recorded motion: the scene's, or since the first session; without one, since this
    // session, because a robot's site that was started again has another clock.
    if (!trace_zero_ || !person_.cycles()) {
      trace_zero_ = welcome_->follows_commands
                        ? shared_clock_.shared_at(now) - welcome_->start - person_.start()
                        : 0.0;
    }
    const double scene_now =
        shared_clock_.shared_at(now + preparation_time_) - welcome_->start + lead;
    const double step = teleop_.predictor.step;
    const double passed = (scene_now - *trace_zero_ - person_.start()) / step;
    next_cycle_ = static_cast<std::size_t>(std::max(0.0, std::ceil(passed))) + 1;
    lead_ = lead;
    if (is_after_end()) {
      is_done_ = true;
      return;
    }
    TeleopOptions options = teleop_;
    options.forward_delay = lead;
    options.backward_delay = std::max(0.5 * shared_clock_.mean_delay(), teleop_.backward_delay);
    const double start = scene_time_of(next_cycle_ - 1);
    const Eigen::Vector3d p_base_tip =
        person_.p_base_start(next_cycle_, state_ ? &*state_ : nullptr);
    const std::launch policy = prepares_at_once_ ? std::launch::deferred : std::launch::async;
    preparing_ = std::async(policy, [this, options, start, p_base_tip] {
      return LiveOperatorSite::create(world_, options, start, p_base_tip);
    });
  }

  /// Where the robot's site sees them: they were moved before this session.
  void place_objects() {
    if (!state_ || state_->objects.size() != site_->objects()) return;
    for (std::size_t i = 0; i < state_->objects.size(); ++i) {
      const LinkTrackedObject& object = state_->objects[i];
      if (!object.is_tracked || !world_.objects[i].is_movable) continue;
      site_->place(
          i, Pose(object.orientation.cast<double>().normalized(), object.position.cast<double>()));
    }
  }

  [[nodiscard]] bool is_after_end() const {
    const std::optional<std::size_t> cycles = person_.cycles();
    return cycles && next_cycle_ > *cycles;
  }
  [[nodiscard]] double scene_time_of(std::size_t cycle) const {
    return *trace_zero_ + person_.start() + teleop_.predictor.step * static_cast<double>(cycle);
  }
  /// When the cycle's command is to be sent, on this site's clock.
  [[nodiscard]] double local_time_of(std::size_t cycle) const {
    return shared_clock_.local_at(welcome_->start + scene_time_of(cycle) - lead_);
  }

  void cycle(double now) {
    const double behind = now - local_time_of(next_cycle_);
    if (behind > teleop_.predictor.step) ++report_.late_cycles;
    if (behind > kMaxOperatorBacklog * teleop_.predictor.step) {
      return lose(now, fmt::format("this site did not run for {:.2f} s", behind));
    }
    for (const LinkCorrection& correction : corrections_.take()) {
      const double t = correction.t - welcome_->start;
      const bool is_valid = site_->apply(t, correction.bytes);
      log_.on_applied(now, session_, correction, is_valid);
      if (!is_valid) {
        ++report_.invalid_messages;
        continue;
      }
      ++report_.corrections;
      if (report_.t_corrected.size() < kMaxReportedTimes) report_.t_corrected.push_back(t);
    }
    const OperatorCommand moved = person_.step(next_cycle_, *site_, link_at(now));
    LinkCommand command;
    command.t = welcome_->start + scene_time_of(next_cycle_);
    command.p_base_tip = moved.p_base_tip.cast<float>();
    command.q_base_tool = moved.q_base_tool.cast<float>();
    command.is_engaged = moved.is_engaged;
    command.acknowledged = corrections_.acknowledgement();
    site_->get_predictions(command.predictions);
    sent_.add(command.t, clock_.now(), moved.device_clock);
    log_.on_commanded(session_, command);
    send(std::move(command));
    ++report_.commands;
    ping(now, kPingInterval);
    ++next_cycle_;
    if (is_after_end()) is_done_ = true;
  }

  void ping(double now, double interval) {
    if (now < next_ping_) return;
    next_ping_ = now + interval;
    send(LinkPing{});
  }

  void check_link(double now) {
    if (!welcome_) return;
    const double silence = now - last_received_;
    if (silence > options_.timeout) {
      lose(now, fmt::format("nothing from the robot's site for {:.2f} s", silence));
    }
  }

  /// The clutch opens: no command is sent until a new session begins from the robot's state.
  void lose(double now, const std::string& reason) {
    if (!lost_at_ && site_) {
      reporter_.warn(now, reason + ": the clutch is open, connecting again");
      report_.interruptions.push_back({scene_time_of(next_cycle_), 0.0});
      lost_at_ = now;
    }
    if (site_) {
      report_.late_corrections += site_->late();
      person_.end();
    }
    site_.reset();
    preparing_ = {};
    welcome_.reset();
    state_.reset();
    state_sequence_ = newest_received_ = 0;
    delays_.reset();
    sent_.clear();
    drop_releases();
    shared_clock_ = {};
    round_trips_ = 0;
    session_ = new_session_();
    next_hello_ = now;
  }

  OperatorSiteReport describe() {
    if (site_) report_.late_corrections += site_->late();
    report_.round_trip = shared_clock_.is_known() ? shared_clock_.min_delay() : 0.0;
    if (shared_clock_.is_known()) {
      report_.clock_offset = shared_clock_.shared_at(clock_.now()) - clock_.now();
      report_.clock_drift = shared_clock_.drift();
      report_.clock_std = shared_clock_.std();
    }
    return std::move(report_);
  }

  OperatorTransport& client_;
  OperatorInterface& person_;
  const TeleopInput& world_;
  const TeleopOptions& teleop_;
  const SiteScene& scene_;
  const OperatorSiteOptions& options_;
  SiteReporter reporter_;
  SiteLog& log_;
  std::function<std::uint32_t()> new_session_;
  bool prepares_at_once_;
  SiteClock clock_;
  double cpu_before_;       ///< [s]
  double next_event_;       ///< [s]
  LinkClock shared_clock_;  ///< the shared clock
  DelayedTransport network_;
  std::uint32_t session_;
  std::optional<LinkWelcome> welcome_;
  double welcomed_ = 0.0;
  std::size_t round_trips_ = 0;
  bool has_connected_ = false;
  bool is_busy_ = false;  ///< another operator's site was connected
  std::optional<LiveOperatorSite> site_;
  std::future<Expected<LiveOperatorSite>> preparing_;  ///< of the next session
  double prepared_since_ = 0.0;                        ///< [s]
  double preparation_time_ = 0.1;                      ///< [s] that it is expected to take
  CorrectionReceiver corrections_;
  std::optional<LinkState> state_;
  std::uint32_t state_sequence_ = 0;   ///< its header's
  std::uint32_t newest_received_ = 0;  ///< sequence number in this session
  SentCommands sent_;
  std::optional<DelayStamps> delays_;
  OperatorRequests wanted_;  ///< and not yet confirmed
  double next_request_ = 0.0;
  std::optional<double> trace_zero_;
  std::size_t next_cycle_ = 1;
  double lead_ = 0.0;
  double last_received_;
  double next_hello_ = 0.0;
  double next_ping_ = 0.0;
  double next_link_ = 0.0;
  std::optional<double> lost_at_;
  std::optional<Error> fault_;
  bool is_done_ = false;
  std::uint32_t sequence_ = 0;
  LinkMessage message_;
  std::vector<std::uint8_t> bytes_;
  OperatorSiteReport report_;
};

}  // namespace

OperatorSiteOptions::OperatorSiteOptions() { set_defaults(*this, kOperatorSiteFields); }
OptionSection section_of(OperatorSiteOptions& options) {
  return make_section("operator_site", options, kOperatorSiteFields);
}

Expected<OperatorSiteReport> run_operator_site(LinkClient& client, OperatorInterface& person,
                                               const TeleopInput& world,
                                               const TeleopOptions& teleop, const SiteScene& scene,
                                               const OperatorSiteOptions& options,
                                               const SimulatedNetwork& network,
                                               const Observer& observer,
                                               const std::atomic<bool>& stop, BlackBox* black_box) {
  SiteRuntime runtime;
  if (black_box != nullptr) runtime.log = &black_box->log();
  OperatorSiteLoop loop(client, person, world, teleop, scene, options, network, observer, runtime);
  request_site_priority(observer);
  while (!stop && !loop.is_finished()) {
    client.wait(loop.until_due());
    loop.step();
  }
  return loop.finish();
}

std::unique_ptr<SiteSteps<OperatorSiteReport>> make_operator_site_steps(
    OperatorTransport& client, OperatorInterface& person, const TeleopInput& world,
    const TeleopOptions& teleop, const SiteScene& scene, const OperatorSiteOptions& options,
    const SimulatedNetwork& network, const Observer& observer, const SiteRuntime& runtime) {
  return std::make_unique<OperatorSiteLoop>(client, person, world, teleop, scene, options, network,
                                            observer, runtime);
}

}  // namespace pcavr
