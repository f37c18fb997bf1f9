// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <dds/dds.h>
#include <fmt/format.h>

#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

#include "teleoperation/ros2/raw_sertype.hpp"

namespace pcavr {
namespace {

constexpr std::uint32_t kMaxSamples = 64;   // taken of a topic at once
constexpr std::size_t kMaxNotices = 100;    // of a process that waits for none
constexpr std::size_t kMaxTopics = 10'000;  // discovered
constexpr dds_duration_t kMaxBlocking = DDS_MSECS(10);

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosHolder = std::unique_ptr<dds_qos_t, QosDeleter>;

QosHolder qos_of(const Ros2Qos& wanted) {
  QosHolder qos(dds_create_qos());
  dds_qset_reliability(qos.get(),
                       wanted.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kMaxBlocking);
  dds_qset_durability(qos.get(), wanted.is_transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL
                                                           : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, wanted.depth);
  return qos;
}

const char* policy_name(std::uint32_t policy) {
  switch (policy) {
    case DDS_RELIABILITY_QOS_POLICY_ID:
      return "reliability: best effort does not serve reliable";
    case DDS_DURABILITY_QOS_POLICY_ID:
      return "durability: volatile does not serve transient local";
    case DDS_DATA_REPRESENTATION_QOS_POLICY_ID:
      return "data representation: XCDR1 is needed";
    default:
      return "deadline, liveliness, ownership or partition";
  }
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// Cyclone DDS's configuration [its manual, "Configuration"]: the environment's, then ours.
std::string configuration_of(const DdsOptions& options) {
  std::string general;
  if (!options.interface.empty()) {
    const bool is_address =
        options.interface.find_first_not_of("0123456789.:") == std::string::npos;
    general += fmt::format(R"(<Interfaces><NetworkInterface {}="{}"/></Interfaces>)",
                           is_address ? "address" : "name", escaped(options.interface));
  }
  if (options.multicast) {
    general += fmt::format("<AllowMulticast>{}</AllowMulticast>", *options.multicast);
  }
  std::string discovery;
  for (const std::string& peer : options.peers) {
    discovery += fmt::format(R"(<Peer Address="{}"/>)", escaped(peer));
  }
  if (!discovery.empty()) {
    // Participants are found at their well-known ports, by index, without multicast.
    discovery =
        "<ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>30"
        "</MaxAutoParticipantIndex><Peers>" +
        discovery + "</Peers>";
  }
  const char* const environment = std::getenv("CYCLONEDDS_URI");
  std::string text = environment == nullptr ? std::string() : std::string(environment) + ',';
  text += fmt::format(R"(<CycloneDDS><Domain Id="any"><General>{}</General>)", general);
  text += fmt::format("<Discovery>{}</Discovery>", discovery);
  text +=
      fmt::format("<Internal><MaxSampleSize>{} B</MaxSampleSize></Internal>", options.max_message);
  return text + "</Domain></CycloneDDS>";
}

/// Collects what Cyclone DDS would print: libraries do not print. For all participants of the
/// process.
class DdsLog {
 public:
  static DdsLog& instance() {
    static DdsLog log;
    return log;
  }
  [[nodiscard]] std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(lines_, {});
  }

 private:
  DdsLog() { dds_set_log_sink(&DdsLog::add, this); }

  static void add(void* self, const dds_log_data_t* data) {
    auto& log = *static_cast<DdsLog*>(self);
    constexpr std::size_t kMaxLine = 300;
    const std::lock_guard lock(log.mutex_);
    if (log.lines_.size() >= kMaxNotices) return;
    std::string line(data->message, std::min(data->size, kMaxLine));
    while (!line.empty() && line.back() <= ' ') line.pop_back();
    if (!line.empty()) log.lines_.push_back("Cyclone DDS: " + line);
  }

  std::mutex mutex_;
  std::vector<std::string> lines_;
};

class DdsTransport final : public Ros2Transport {
 public:
  ~DdsTransport() override {
    if (participant_ > 0) dds_delete(participant_);
    if (domain_ > 0) dds_delete(domain_);
  }

  [[nodiscard]] std::optional<Error> open(const std::vector<Ros2Topic>& subscribed,
                                          const std::vector<Ros2Topic>& published,
                                          const DdsOptions& options) {
    (void)DdsLog::instance().take();
    const std::string configuration = configuration_of(options);
    // Exists already where this process has another participant in the domain.
    domain_ = dds_create_domain(options.domain, configuration.c_str());
    if (domain_ < 0 && domain_ != DDS_RETCODE_PRECONDITION_NOT_MET) return failure(domain_);
    participant_ = dds_create_participant(options.domain, nullptr, nullptr);
    if (participant_ < 0) return failure(participant_);
    waitset_ = dds_create_waitset(participant_);
    for (const Ros2Topic& topic : subscribed) {
      if (std::optional<Error> error = subscribe(topic, options.max_message)) return error;
    }
    for (const Ros2Topic& topic : published) {
      if (std::optional<Error> error = advertise(topic, options.max_message)) return error;
    }
    publications_ =
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
    subscriptions_ =
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr);
    return std::nullopt;
  }

  void wait(std::chrono::milliseconds timeout, const Receiver& receive) override {
    dds_waitset_wait(waitset_, nullptr, 0, DDS_MSECS(static_cast<dds_duration_t>(timeout.count())));
    for (std::size_t i = 0; i < readers_.size(); ++i) take(i, receive);
  }

  bool publish(std::size_t topic, std::span<const std::uint8_t> message) override {
    const Endpoint& writer = writers_.at(topic);
    ddsi_serdata* const data = make_raw_serdata(*writer.type, message);
    return data != nullptr && dds_writecdr(writer.entity, data) == DDS_RETCODE_OK;
  }

  [[nodiscard]] std::uint64_t lost(std::size_t topic) override {
    dds_sample_lost_status_t status{};
    const dds_return_t done = dds_get_sample_lost_status(readers_.at(topic).entity, &status);
    if (done == DDS_RETCODE_OK) readers_[topic].lost = status.total_count;
    return readers_[topic].lost;
  }

  /// Adds the topics of publishers that were found since the last call to `topics`.
  void discover(std::map<std::string, Ros2Topic>& topics) {
    std::array<void*, kMaxSamples> samples{};
    std::array<dds_sample_info_t, kMaxSamples> infos{};
    const dds_return_t count =
        dds_take(publications_, samples.data(), infos.data(), kMaxSamples, kMaxSamples);
    for (dds_return_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto* const found = static_cast<const dds_builtintopic_endpoint_t*>(samples[at]);
      if (infos[at].valid_data && found->topic_name != nullptr && found->type_name != nullptr) {
        add_published(*found, topics);
      }
    }
    if (count > 0) dds_return_loan(publications_, samples.data(), count);
  }

  [[nodiscard]] std::vector<std::string> take_notices() override {
    std::vector<std::string> notices = DdsLog::instance().take();
    for (Endpoint& reader : readers_) note_incompatible(reader, true, notices);
    for (Endpoint& writer : writers_) note_incompatible(writer, false, notices);
    note_other_types(publications_, readers_, "published", notices);
    note_other_types(subscriptions_, writers_, "subscribed", notices);
    return notices;
  }

 private:
  struct Endpoint {
    Ros2Topic topic;
    dds_entity_t entity = 0;
    ddsi_sertype* type = nullptr;  ///< the topic's, as long as that exists
    std::uint32_t incompatible = 0;
    std::uint64_t lost = 0;
  };

  static void add_published(const dds_builtintopic_endpoint_t& found,
                            std::map<std::string, Ros2Topic>& topics) {
    const std::string name = found.topic_name;
    const std::string prefix = dds_topic_name("/");
    // Others are of services, or of no ROS program; peers are not trusted to be few.
    if (!name.starts_with(prefix) || topics.size() >= kMaxTopics) return;
    dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
    dds_duration_t blocking = 0;
    dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
    (void)dds_qget_reliability(found.qos, &reliability, &blocking);
    (void)dds_qget_durability(found.qos, &durability);
    const Ros2Qos qos{.is_reliable = reliability == DDS_RELIABILITY_RELIABLE,
                      .is_transient_local = durability != DDS_DURABILITY_VOLATILE};
    const std::string ros_name = name.substr(prefix.size() - 1);
    const auto [at, is_new] =
        topics.try_emplace(ros_name, Ros2Topic{ros_name, ros_type_name(found.type_name), qos});
    Ros2Qos& known = at->second.qos;
    known.is_reliable = known.is_reliable && qos.is_reliable;
    known.is_transient_local = known.is_transient_local && qos.is_transient_local;
  }

  static Error failure(dds_return_t code) {
    std::string message = std::string("DDS: ") + dds_strretcode(-code);
    for (const std::string& line : DdsLog::instance().take()) message += "; " + line;
    return {.message = std::move(message),
            .hint = "check network.interface and network.peers, and CYCLONEDDS_URI"};
  }

  [[nodiscard]] std::optional<Error> create(const Ros2Topic& topic, std::size_t max_message,
                                            bool is_reader, Endpoint& endpoint) {
    endpoint.topic = topic;
    endpoint.type = make_raw_sertype(dds_type_name(topic.type), max_message);
    const QosHolder qos = qos_of(topic.qos);
    const dds_entity_t entity =
        dds_create_topic_sertype(participant_, dds_topic_name(topic.name).c_str(), &endpoint.type,
                                 qos.get(), nullptr, nullptr);
    if (entity < 0) {
      ddsi_sertype_unref(endpoint.type);
      return failure(entity);
    }
    endpoint.entity = is_reader ? dds_create_reader(participant_, entity, qos.get(), nullptr)
                                : dds_create_writer(participant_, entity, qos.get(), nullptr);
    if (endpoint.entity < 0) return failure(endpoint.entity);
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> subscribe(const Ros2Topic& topic, std::size_t max_message) {
    Endpoint reader;
    if (std::optional<Error> error = create(topic, max_message, true, reader)) return error;
    const dds_entity_t condition = dds_create_readcondition(reader.entity, DDS_ANY_STATE);
    dds_waitset_attach(waitset_, condition, 0);
    readers_.push_back(std::move(reader));
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Error> advertise(const Ros2Topic& topic, std::size_t max_message) {
    Endpoint writer;
    if (std::optional<Error> error = create(topic, max_message, false, writer)) return error;
    writers_.push_back(std::move(writer));
    return std::nullopt;
  }

  void take(std::size_t topic, const Receiver& receive) {
    std::array<ddsi_serdata*, kMaxSamples> samples{};
    std::array<dds_sample_info_t, kMaxSamples> infos{};
    const dds_return_t count = dds_takecdr(readers_[topic].entity, samples.data(), kMaxSamples,
                                           infos.data(), DDS_ANY_STATE);
    for (dds_return_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (infos[at].valid_data) receive(topic, bytes_of(*samples[at]));
      ddsi_serdata_unref(samples[at]);
    }
  }

  static void note_incompatible(Endpoint& endpoint, bool is_reader,
                                std::vector<std::string>& notices) {
    std::uint32_t total = 0;
    std::uint32_t policy = 0;
    if (is_reader) {
      dds_requested_incompatible_qos_status_t status{};
      if (dds_get_requested_incompatible_qos_status(endpoint.entity, &status) != DDS_RETCODE_OK)
        return;
      total = status.total_count;
      policy = status.last_policy_id;
    } else {
      dds_offered_incompatible_qos_status_t status{};
      if (dds_get_offered_incompatible_qos_status(endpoint.entity, &status) != DDS_RETCODE_OK)
        return;
      total = status.total_count;
      policy = status.last_policy_id;
    }
    if (total == std::exchange(endpoint.incompatible, total)) return;
    notices.push_back(fmt::format("{}: a {} has an incompatible quality of service ({})",
                                  endpoint.topic.name, is_reader ? "publisher" : "subscriber",
                                  policy_name(policy)));
  }

  /// Peers with our topics' names and other types: these never match ours.
  void note_other_types(dds_entity_t builtin, const std::vector<Endpoint>& endpoints,
                        const char* what, std::vector<std::string>& notices) {
    std::array<void*, kMaxSamples> samples{};
    std::array<dds_sample_info_t, kMaxSamples> infos{};
    const dds_return_t count =
        dds_take(builtin, samples.data(), infos.data(), kMaxSamples, kMaxSamples);
    for (dds_return_t i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto* const found = static_cast<const dds_builtintopic_endpoint_t*>(samples[at]);
      if (!infos[at].valid_data || found->topic_name == nullptr || found->type_name == nullptr) {
        continue;
      }
      for (const Endpoint& endpoint : endpoints) {
        if (dds_topic_name(endpoint.topic.name) != found->topic_name ||
            dds_type_name(endpoint.topic.type) == found->type_name) {
          continue;
        }
        std::string line =
            fmt::format("{} is {} with type {}, not {}: ignored", endpoint.topic.name, what,
                        ros_type_name(found->type_name), endpoint.topic.type);
        if (noted_.size() < kMaxNotices && noted_.insert(line).second) {
          notices.push_back(std::move(line));
        }
      }
    }
    if (count > 0) dds_return_loan(builtin, samples.data(), count);
  }

  dds_entity_t domain_ = 0;
  dds_entity_t participant_ = 0;
  dds_entity_t waitset_ = 0;
  dds_entity_t publications_ = 0;
  dds_entity_t subscriptions_ = 0;
  std::vector<Endpoint> readers_;
  std::vector<Endpoint> writers_;
  std::set<std::string> noted_;
};

}  // namespace

Expected<std::unique_ptr<Ros2Transport>> open_dds(const std::vector<Ros2Topic>& subscribed,
                                                  const std::vector<Ros2Topic>& published,
                                                  const DdsOptions& options) {
  auto transport = std::make_unique<DdsTransport>();
  if (std::optional<Error> error = transport->open(subscribed, published, options)) return *error;
  return std::unique_ptr<Ros2Transport>(std::move(transport));
}

Expected<std::vector<Ros2Topic>> discover_ros2_topics(
    const DdsOptions& options, std::chrono::milliseconds timeout,
    const std::function<bool(const std::vector<Ros2Topic>&)>& is_enough) {
  DdsTransport transport;
  if (std::optional<Error> error = transport.open({}, {}, options)) return *error;
  constexpr std::chrono::milliseconds kPeriod(20);
  const auto end = std::chrono::steady_clock::now() + timeout;
  std::map<std::string, Ros2Topic> topics;
  for (;;) {
    transport.discover(topics);
    std::vector<Ros2Topic> found;
    for (const auto& [name, topic] : topics) found.push_back(topic);
    if (is_enough(found) || std::chrono::steady_clock::now() >= end) return found;
    std::this_thread::sleep_for(kPeriod);
  }
}

}  // namespace pcavr
