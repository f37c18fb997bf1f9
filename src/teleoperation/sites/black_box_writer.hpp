// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"

#include "site_log.hpp"

namespace pcavr {

/// Kind of a record of the queue; its body follows the head. It has 8 bytes, so that the head has
/// no padding.
enum class RecordKind : std::uint64_t {
  start,     ///< std::int64_t: CLOCK_REALTIME [ns]
  sent,      ///< a whole message
  received,  ///< the same
  event,     ///< std::uint8_t level, text
  tool,      ///< RobotSamples::Tool's tip and orientation: double x 7, x y z w last
  wrench,    ///< force, torque: double x 6
  tracked,   ///< std::uint64_t object, double x 7
  applied,   ///< std::uint32_t number, std::uint32_t 1 if valid
  delays,    ///< DelayStamps
  link,      ///< LinkStatistics
  phase      ///< std::uint64_t object, std::uint64_t MotionPhase
};

struct RecordHead {
  double t = 0.0;  ///< [s] on the site's clock
  RecordKind kind = RecordKind::start;
};

/// Decodes a site's records and writes them to their topics. One thread.
class BlackBoxWriter {
 public:
  BlackBoxWriter(McapWriter file, SiteScene scene, double display_rate);

  /// A head, then its body, as bytes. After an error nothing is written any more.
  void write(std::span<const std::uint8_t> record);
  void write_dropped(std::uint64_t records);
  /// Writes what is older than the interval of the file.
  void flush_if_due();
  [[nodiscard]] Expected<void> close();
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] std::uint64_t messages() const { return file_.message_count(); }
  [[nodiscard]] std::uint64_t bytes() const { return file_.bytes_written(); }

 private:
  using Json = nlohmann::ordered_json;
  struct Object {
    std::string name;
    Pose T_base_start;
    std::string frame;  ///< the name, in characters of topics and frames
    std::uint16_t tracked = 0;
    std::uint16_t predicted = 0;
    std::uint16_t force = 0;
    std::optional<Pose> T_base_tracked = {};
    std::optional<Pose> T_base_predicted = {};
    double t_tracked = 0.0;  ///< [s] of the frame
    std::optional<MotionPhase> robot_phase = {};
    std::optional<MotionPhase> operator_phase = {};
  };

  void add_topics();
  [[nodiscard]] std::uint16_t add_json(const char* topic, const Json& properties);

  void on_message(double now, bool is_sent, std::span<const std::uint8_t> bytes);
  void on_command(double now, const LinkCommand& command);
  void on_state(double now, bool is_sent, const LinkHeader& header, const LinkState& state);
  void on_correction(double now, const char* action, const LinkCorrection& correction);
  void on_session(double now, bool is_sent, Json content);
  void on_applied(double now, std::uint32_t number, bool is_valid);
  void on_tracked(double t, std::size_t object, const Pose& T_base_object);
  void write_sensor(double t, RecordKind kind, std::span<const std::uint8_t> body);
  void write_status(double now, const LinkState& state);
  struct TimedPhase {
    double t = 0.0;  ///< [s] of the site: when it was so
    MotionPhase phase = MotionPhase::free;
  };
  void write_phase(double now, const Object& object, bool is_robot, const TimedPhase& seen);
  void write_changed_phase(double now, Object& object, bool is_robot, const TimedPhase& seen);
  void write_scene_start(double now, const LinkCommand& command);
  void write_transforms(double now);
  void write_delays(double now, const DelayStamps& stamps);
  void write_link(double now, const LinkStatistics& link);
  void write_event(double now, std::string_view level, std::string_view text);

  void put(std::uint16_t channel, double now, const std::vector<std::uint8_t>& payload);
  void put(std::uint16_t channel, double now, const Json& json);
  void note(const Expected<void>& result);
  [[nodiscard]] Stamp stamp_of(double t) const;
  /// Converts from the shared clock to the site's.
  [[nodiscard]] double local(double shared) const { return shared - clock_offset_; }

  McapWriter file_;
  SiteScene scene_;
  double display_interval_;  ///< [s]
  std::optional<Error> error_;
  std::vector<Object> objects_;
  std::uint16_t command_ = 0, tool_ = 0, wrench_ = 0, transforms_ = 0;  ///< channels
  std::uint16_t corrections_ = 0, events_ = 0, phases_ = 0, status_ = 0;
  std::uint16_t delays_ = 0, link_ = 0, session_ = 0;
  std::int64_t start_ = 0;     ///< [ns] CLOCK_REALTIME at the site's time t_start_
  double t_start_ = 0.0;       ///< [s]
  double last_ = 0.0;          ///< [s] site's time of the newest record
  double clock_offset_ = 0.0;  ///< [s] shared clock less the site's
  double next_predictions_ = 0.0;
  double next_transforms_ = 0.0;
  double next_status_ = 0.0;
  std::string last_status_;
  std::map<std::uint32_t, LinkCorrection> received_;  ///< not applied yet, by number
  std::optional<double> scene_start_;  ///< [s] of a session whose first command is awaited
  std::optional<Pose> T_base_command_;
  std::optional<Pose> T_base_tool_;
};

}  // namespace pcavr
