// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/recordings/recording/camera_file.hpp"
#include "pcavr/recordings/recording/manifest_template.hpp"
#include "pcavr/teleoperation/record/recorder.hpp"

#include "commands.hpp"
#include "link_arguments.hpp"
#include "number_option.hpp"
#include "shared_files.hpp"

namespace pcavr::app {
namespace fs = std::filesystem;
namespace {

constexpr InputRange kDuration{"duration", 0.1, 36000.0, "s", "up to ten hours, as recordings"};
constexpr InputRange kFrameRate{"rate", 0.1, 1000.0, "Hz", "of cameras"};
constexpr InputRange kSearch{"time", 0.1, 3600.0, "s",
                             "from a discovery on this machine to an hour"};
constexpr int kMaxSide = 16384;                    // [px]
constexpr std::chrono::milliseconds kPeriod(100);  // between two looks at the recording
constexpr double kLineInterval = 10.0;             // [s] of the status, if not on a terminal
constexpr std::size_t kMaxShownTopics = 6;         // of the status: one line
constexpr std::chrono::milliseconds kDiscoveryTime(2000);  // for "all"
constexpr const char* kAllTopics = "all";
constexpr std::array<char, 5> kMcapMagic{'\x89', 'M', 'C', 'A', 'P'};

struct RecordArguments {
  std::string file;
  bool replace = false;
  std::string ros2;
  std::vector<std::string> topics;
  double search = 10.0;  ///< [s]
  std::vector<std::string> cameras;
  std::vector<std::string> calibrations;  ///< of the cameras, in their order
  std::string size;                       ///< "1280x720"
  std::optional<double> rate;             ///< [Hz]
  std::string manifest;
  std::optional<double> duration;  ///< [s]
};

/// The file is written in place, so that it is there after a crash: it must not replace anything
/// that is no recording.
Expected<void> check_file(const RecordArguments& arguments) {
  std::vector<fs::path> inputs{arguments.ros2, arguments.manifest};
  inputs.insert(inputs.end(), arguments.calibrations.begin(), arguments.calibrations.end());
  const fs::path file = arguments.file;
  if (Expected<void> apart = check_outputs({file}, inputs); !apart) return apart;
  if (file.extension() != ".mcap") {
    return Error{.message = "is no name of an MCAP file",
                 .file = arguments.file,
                 .place = "--output",
                 .hint = "let it end in .mcap"};
  }
  std::error_code code;
  if (!fs::exists(fs::symlink_status(file, code))) return {};
  if (!arguments.replace) {
    return Error{.message = "already exists",
                 .file = arguments.file,
                 .hint = "choose another name, or replace it with --force"};
  }
  std::array<char, kMcapMagic.size()> start{};
  std::ifstream(file, std::ios::binary).read(start.data(), start.size());
  const bool is_replaceable =
      fs::is_regular_file(file, code) && (fs::file_size(file, code) == 0 || start == kMcapMagic);
  if (is_replaceable) return {};
  return Error{.message = "is no MCAP file, and is not replaced",
               .file = arguments.file,
               .hint = "choose another name"};
}

Expected<CameraRequest> camera_request(const RecordArguments& arguments) {
  CameraRequest request{.rate = arguments.rate};
  if (arguments.size.empty()) return request;
  const std::size_t cross = arguments.size.find('x');
  const auto width = parse_number<int>(arguments.size.substr(0, cross));
  const auto height = cross == std::string::npos
                          ? std::nullopt
                          : parse_number<int>(arguments.size.substr(cross + 1));
  const auto is_side = [](const std::optional<int>& side) {
    return side && *side > 0 && *side <= kMaxSide;
  };
  if (!is_side(width) || !is_side(height)) {
    return Error{.message = "'" + arguments.size + "' is no size in pixels",
                 .place = "--camera-size",
                 .hint = "write it as 1280x720"};
  }
  request.width = width;
  request.height = height;
  return request;
}

Expected<std::vector<RecordedCamera>> open_cameras(const RecordArguments& arguments) {
  if (arguments.calibrations.size() > arguments.cameras.size()) {
    return Error{.message = "there are more calibrations than cameras",
                 .place = "--calibration",
                 .hint = "give one for each --camera, in the same order"};
  }
  const Expected<CameraRequest> request = camera_request(arguments);
  if (!request) return request.error();
  std::vector<RecordedCamera> cameras;
  for (std::size_t i = 0; i < arguments.cameras.size(); ++i) {
    Expected<std::unique_ptr<CameraSource>> source = open_camera(arguments.cameras[i], *request);
    if (!source) return source.error();
    RecordedCamera& camera = cameras.emplace_back();
    camera.source = std::move(*source);
    if (i >= arguments.calibrations.size()) continue;
    const Expected<CameraFile> file = read_camera_file(arguments.calibrations[i]);
    if (!file) return file.error();
    if (file->camera.width != camera.source->width() ||
        file->camera.height != camera.source->height()) {
      return Error{.message = fmt::format("is for {} x {} pixels, but the camera gives {} x {}",
                                          file->camera.width, file->camera.height,
                                          camera.source->width(), camera.source->height()),
                   .file = arguments.calibrations[i],
                   .hint = "give --camera-size, or the calibration of this size"};
    }
    camera.model = file->camera;
  }
  return cameras;
}

/// Subscriptions and their roles.
struct Subscribed {
  std::vector<Ros2Topic> topics;
  std::vector<RecordedTopic> recorded;

  void add(Ros2Topic topic, RecordRole role) {
    for (const RecordedTopic& known : recorded) {
      if (known.name == topic.name) return;
    }
    recorded.push_back({topic.name, topic.type, role});
    topics.push_back(std::move(topic));
  }
};

std::string names_of(const std::vector<Ros2Topic>& topics) {
  std::string names;
  for (const Ros2Topic& topic : topics) names += (names.empty() ? "" : ", ") + topic.name;
  return names.empty() ? "none" : names;
}

/// Finds the types of the topics that --topics names among those that are published.
Expected<void> add_published(const RecordArguments& arguments, const DdsOptions& dds,
                             Subscribed& subscribed) {
  const bool takes_all = arguments.topics == std::vector<std::string>{kAllTopics};
  const auto find = [](const std::vector<Ros2Topic>& published, const std::string& name) {
    const std::string full = name.starts_with('/') ? name : '/' + name;
    return std::find_if(published.begin(), published.end(),
                        [&](const Ros2Topic& topic) { return topic.name == full; });
  };
  const auto has_all = [&](const std::vector<Ros2Topic>& published) {
    return !takes_all && std::all_of(arguments.topics.begin(), arguments.topics.end(),
                                     [&](const std::string& name) {
                                       return find(published, name) != published.end();
                                     });
  };
  const std::chrono::duration<double> search(arguments.search);
  const auto timeout =
      takes_all ? kDiscoveryTime : std::chrono::duration_cast<std::chrono::milliseconds>(search);
  const auto published = discover_ros2_topics(dds, timeout, has_all);
  if (!published) return published.error();
  const auto add = [&](Ros2Topic topic) {
    topic.qos.depth = recorded_depth(topic.type);
    const RecordRole role = role_of_type(topic.type);
    subscribed.add(std::move(topic), role);
  };
  if (takes_all) {
    for (const Ros2Topic& topic : *published) add(topic);
    if (!published->empty()) return {};
    return Error{.message = "no topic is published",
                 .place = "--topics",
                 .hint = "start the robot first, and check ROS_DOMAIN_ID and CYCLONEDDS_URI"};
  }
  for (const std::string& name : arguments.topics) {
    const auto found = find(*published, name);
    if (found == published->end()) {
      return Error{
          .message = fmt::format("{} is not published; there are {}", name, names_of(*published)),
          .place = "--topics",
          .hint = "start what publishes it first, or wait longer with --search"};
    }
    add(*found);
  }
  return {};
}

Expected<void> open_topics(const RecordArguments& arguments, const std::optional<Ros2Setup>& setup,
                           RecordInputs& inputs) {
  if (!setup && arguments.topics.empty()) return {};
  Subscribed subscribed;
  DdsOptions dds;
  if (setup) {
    dds = setup->dds;
    for (Ros2Subscription& one : recorded_subscriptions(*setup)) {
      subscribed.add(std::move(one.topic), role_of(one.role));
    }
  } else {
    const Expected<std::uint32_t> domain = environment_domain();
    if (!domain) return domain.error();
    dds.domain = *domain;
  }
  if (!arguments.topics.empty()) {
    if (Expected<void> added = add_published(arguments, dds, subscribed); !added) return added;
  }
  Expected<std::unique_ptr<Ros2Transport>> transport = open_dds(subscribed.topics, {}, dds);
  if (!transport) return transport.error();
  inputs.transport = std::move(*transport);
  inputs.topics = std::move(subscribed.recorded);
  return {};
}

Expected<RecordInputs> open_inputs(const RecordArguments& arguments) {
  if (arguments.ros2.empty() && arguments.topics.empty() && arguments.cameras.empty()) {
    return Error{.message = "there is nothing to record",
                 .hint = "give --ros2, --topics or --camera"};
  }
  RecordInputs inputs;
  std::optional<Ros2Setup> setup;
  if (!arguments.ros2.empty()) {
    Expected<Ros2Setup> read = read_ros2_setup(arguments.ros2);
    if (!read) return read.error();
    setup = std::move(*read);
  }
  fs::path manifest = arguments.manifest;
  if (manifest.empty() && setup && setup->camera) manifest = setup->camera->tags;
  const Expected<Manifest> declared = read_manifest_template(manifest);
  if (!declared) return declared.error();
  for (const MarkerEntry& marker : declared->markers) inputs.tags.push_back(marker.id);
  Expected<std::vector<RecordedCamera>> cameras = open_cameras(arguments);
  if (!cameras) return cameras.error();
  inputs.cameras = std::move(*cameras);
  if (Expected<void> opened = open_topics(arguments, setup, inputs); !opened) {
    return opened.error();
  }
  return inputs;
}

std::string missing_text(const RecordedCounts& topic) {
  std::string text;
  if (topic.dropped > 0) text += fmt::format(", {} dropped: the disk was too slow", topic.dropped);
  if (topic.lost > 0) text += fmt::format(", {} lost before they arrived", topic.lost);
  return text;
}

std::uint64_t missing_of(const RecordStatus& status) {
  std::uint64_t missing = 0;
  for (const RecordedCounts& topic : status.topics) missing += topic.dropped + topic.lost;
  return missing;
}

/// One line: time, size, and the rates since `last`.
std::string status_text(const RecordStatus& status, const RecordStatus& last) {
  const double time = std::max(status.elapsed - last.elapsed, 1e-3);
  std::string text = fmt::format("{:.0f} s, {:.1f} MB, {:.1f} MB/s", status.elapsed,
                                 1e-6 * static_cast<double>(status.bytes),
                                 1e-6 * static_cast<double>(status.bytes - last.bytes) / time);
  for (std::size_t i = 0; i < std::min(status.topics.size(), kMaxShownTopics); ++i) {
    const std::uint64_t before = i < last.topics.size() ? last.topics[i].messages : 0;
    const double count = static_cast<double>(status.topics[i].messages - before);
    text += fmt::format(", {} {:.0f} Hz", status.topics[i].topic, count / time);
  }
  if (status.topics.size() > kMaxShownTopics) text += ", ...";
  return text + fmt::format(", {} dropped or lost", missing_of(status));
}

/// The state of the recording on standard error: on a terminal a line that is renewed each second,
/// else one every ten seconds.
class StatusLine {
 public:
  explicit StatusLine(const Observer& observer) : observer_(observer) {}

  void show(const RecordStatus& status) {
    if (status.elapsed < last_.elapsed + (is_terminal_ ? 1.0 : kLineInterval)) return;
    const std::string text = status_text(status, last_);
    last_ = status;
    if (!is_terminal_) return observer_.on_note(text);
    std::fprintf(stderr, "\r\033[K%s", printable(text).c_str());
    is_shown_ = true;
  }
  void clear() {
    if (std::exchange(is_shown_, false)) std::fputs("\r\033[K", stderr);
  }

 private:
  const Observer& observer_;
  const bool is_terminal_ = ::isatty(STDERR_FILENO) != 0;
  bool is_shown_ = false;
  RecordStatus last_;
};

void follow(Recorder& recorder, const RecordArguments& arguments, const Observer& observer) {
  const std::atomic<bool>& stop = stop_on_signals();
  StatusLine line(observer);
  const auto show_warnings = [&] {
    for (const std::string& warning : recorder.take_warnings()) {
      line.clear();
      observer.on_warning(warning);
    }
  };
  while (!stop && !recorder.has_ended()) {
    const RecordStatus status = recorder.status();
    if (arguments.duration && status.elapsed >= *arguments.duration) break;
    show_warnings();
    line.show(status);
    std::this_thread::sleep_for(kPeriod);
  }
  show_warnings();
  line.clear();
}

CommandResult describe(const RecordArguments& arguments, const RecordStatus& status) {
  CommandResult result;
  result.summary =
      fmt::format("{}: {:.3f} s, {} messages, {:.1f} MB\n", arguments.file, status.elapsed,
                  status.messages, 1e-6 * static_cast<double>(status.bytes));
  result.json = {{"file", arguments.file},
                 {"duration_s", status.elapsed},
                 {"messages", status.messages},
                 {"bytes", status.bytes}};
  result.json["topics"] = nlohmann::ordered_json::array();
  for (const RecordedCounts& topic : status.topics) {
    const double rate = static_cast<double>(topic.messages) / std::max(status.elapsed, 1e-3);
    result.summary += fmt::format("  {}: {} messages, {:.1f} Hz{}\n", topic.topic, topic.messages,
                                  rate, missing_text(topic));
    result.json["topics"].push_back({{"topic", topic.topic},
                                     {"messages", topic.messages},
                                     {"rate_hz", rate},
                                     {"dropped", topic.dropped},
                                     {"lost", topic.lost}});
  }
  result.summary +=
      fmt::format("next: pcavr doctor {0}; pcavr import {0} -o RECORDING\n", arguments.file);
  return result;
}

Expected<CommandResult> record(const RecordArguments& arguments, const Configuration& configuration,
                               const Observer& observer) {
  if (const Expected<void> checked = check_file(arguments); !checked) return checked.error();
  Expected<RecordInputs> inputs = open_inputs(arguments);
  if (!inputs) return inputs.error();
  for (const RecordedCamera& camera : inputs->cameras) {
    observer.on_note("records " + camera.source->description());
  }
  for (const RecordedTopic& topic : inputs->topics) {
    observer.on_note("records " + topic.name + " (" + topic.type + ")");
  }
  Expected<std::unique_ptr<Recorder>> recorder = Recorder::start(
      arguments.file, arguments.replace, std::move(*inputs), configuration.recorder);
  if (!recorder) return recorder.error();
  observer.on_note("recording to " + arguments.file + "; Ctrl-C ends it");
  follow(**recorder, arguments, observer);
  const Expected<RecordStatus> status = (*recorder)->finish();
  if (!status) return status.error();
  if (status->messages == 0 && missing_of(*status) == 0) {
    std::error_code code;
    fs::remove(arguments.file, code);
    return Error{.message = "no message arrived: nothing is recorded",
                 .file = arguments.file,
                 .hint = "check that the topics are published, with this quality of service"};
  }
  return describe(arguments, *status);
}

}  // namespace

void add_record(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "record", "Record ROS 2 topics and colour cameras in a file that survives a crash");
  command->footer(
      "Exit code: 1 if the file could not be written to its end; what was written is readable.\n"
      "Example:\n  pcavr record --ros2 ros2.yaml -o push.mcap\n"
      "  pcavr record --topics /tool_pose,/wrench --camera /dev/video0 --duration 60 -o push.mcap");
  auto arguments = std::make_shared<RecordArguments>();
  command
      ->add_option("-o,--output", arguments->file,
                   "MCAP file, written in place: pcavr import makes a recording of it")
      ->required();
  command->add_flag("--force", arguments->replace, "Replace an existing MCAP file");
  command->add_option("--ros2", arguments->ros2,
                      "The topics of this YAML file, as of robot-site, by DDS");
  command
      ->add_option("--topics", arguments->topics,
                   "Further ROS 2 topics, of the types with which they are published: names with "
                   "commas between them, or all")
      ->delimiter(',');
  add_number(*command, "--search", arguments->search, kSearch,
             "Wait so long for the topics of --topics to be published [s]")
      ->capture_default_str();
  command->add_option("--camera", arguments->cameras,
                      "V4L2 camera (/dev/video0), or file:FOLDER: a simulated camera that repeats "
                      "the images of a folder; may be repeated");
  command
      ->add_option("--calibration", arguments->calibrations,
                   "Camera file of each --camera, in their order: its lens, as camera_info")
      ->transform(installed_calibration());
  command->add_option("--camera-size", arguments->size,
                      "Size of the cameras' images, such as 1280x720; default: as they are set");
  add_number(*command, "--camera-rate", arguments->rate, kFrameRate,
             "Images of the cameras per second; default: as they are set, simulated 30 [Hz]");
  command->add_option("--manifest", arguments->manifest,
                      "recording.yaml with markers: a warning when none of them is in view");
  add_number(*command, "--duration", arguments->duration, kDuration,
             "End after this time; default: at Ctrl-C [s]");
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return record(*arguments, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
