// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/teleoperation/record/camera_source.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/teleoperation/record/options.cpp for meanings, ranges and defaults.
struct RecorderOptions {
  RecorderOptions();
  double flush_interval;  ///< [s]
  int queue_size;         ///< [MiB]
  double tag_interval;    ///< [s]
};
/// The options "record".
[[nodiscard]] OptionSection section_of(RecorderOptions& options);

/// What the live checks make of a topic.
enum class RecordRole { tool, wrench, object, transforms, image, camera_info, other };

struct RecordedTopic {
  std::string name;  ///< "/wrench"
  std::string type;  ///< "geometry_msgs/msg/WrenchStamped"
  RecordRole role = RecordRole::other;
};

/// The role of a topic that is known by its type alone: any pose is an object's.
[[nodiscard]] RecordRole role_of_type(const std::string& type);
/// The topics of a setup as they are recorded: with a depth that does not lose messages while the
/// reading thread waits for the processor.
[[nodiscard]] std::vector<Ros2Subscription> recorded_subscriptions(const Ros2Setup& setup);
/// The depth of a subscription that is recorded, by its type: images are large.
[[nodiscard]] int recorded_depth(const std::string& type);
[[nodiscard]] RecordRole role_of(Ros2Subscription::Role role);

struct RecordedCamera {
  std::unique_ptr<CameraSource> source;
  std::optional<CameraModel> model = {};  ///< of its lens; nothing: no camera_info
};

struct RecordInputs {
  /// Subscribed to `topics`, in their order; null without any.
  std::unique_ptr<Ros2Transport> transport = {};
  std::vector<RecordedTopic> topics = {};
  std::vector<RecordedCamera> cameras = {};
  std::vector<MarkerId> tags = {};  ///< that images are to show; none: images are not searched
};

/// The state of a topic. `dropped`: did not fit into the queue, because the disk was too slow;
/// `lost`: did not arrive from the network or the camera.
struct RecordedCounts {
  std::string topic;
  std::uint64_t messages = 0;  ///< written
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;
};

struct RecordStatus {
  double elapsed = 0.0;  ///< [s]
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;  ///< in the file
  std::vector<RecordedCounts> topics;
};

/// Records messages of ROS 2 topics and colour cameras in an MCAP file (profile ros2, messages in
/// CDR as they came), which `pcavr import` reads. The n-th camera is on the topics
/// /camera_n/image_raw/compressed and /camera_n/camera_info, the first without its number; names
/// that topics of ROS 2 begin with are left out. Log times are those of arrival, on a clock that
/// nobody sets.
///
/// After the end of the process, however it ends, the file is readable up to the last
/// `flush_interval` and some milliseconds; a power failure loses what the kernel has not written
/// yet. Each source has a thread that puts its messages into a queue of fixed size, from which one
/// thread writes the file: a message that does not fit is dropped, and counted by topic. The counts
/// are in the file's metadata, renewed each second. Memory: a queue of `queue_size` for each
/// source, two chunks of the file, and some 3 kB for each second of recording (the file's index).
class Recorder {
 public:
  /// Creates the file and starts. An Error if the file exists, unless `replace`, or can't be
  /// written.
  [[nodiscard]] static Expected<std::unique_ptr<Recorder>> start(
      const std::filesystem::path& file, bool replace, RecordInputs inputs,
      const RecorderOptions& options = {});
  /// Finishes; an Error of that is lost.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// These may be called from any thread.
  [[nodiscard]] RecordStatus status() const;
  /// What is doubtful or has changed since the last call, one line each.
  [[nodiscard]] std::vector<std::string> take_warnings();
  /// True once nothing more will be written: the file can't be, or all sources are gone.
  [[nodiscard]] bool has_ended() const;

  /// Writes what the queues have, the counts and the file's index. An Error if the file could not
  /// be written; what was written before is readable. Later calls return the same.
  [[nodiscard]] Expected<RecordStatus> finish();

 private:
  struct Content;
  explicit Recorder(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
