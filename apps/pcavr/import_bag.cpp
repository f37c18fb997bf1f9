// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "import_bag.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/pipeline/doctor.hpp"
#include "pcavr/recordings/recording/manifest_template.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "import_clouds.hpp"
#include "number_option.hpp"
#include "output_option.hpp"

namespace pcavr::app {
namespace {

/// An option that is given as NAME=VALUE, perhaps more than once.
struct PairOption {
  const char* option;
  const char* form;
  const char* hint;
};
constexpr PairOption kObjectOption{
    "--object", "NAME=TOPIC",
    "give the object's name and the topic of its poses: box=/vicon/box/box"};
constexpr PairOption kPlaceOption{
    "--T-tracked-object", "NAME=tx,ty,tz,qx,qy,qz,qw",
    "give the object's name and the pose of its CAD frame in the tracked body"};
constexpr PairOption kMapOption{"--map", "NAME=COLUMN",
                                "give the standard name and the file's column: fx=Fz"};
constexpr PairOption kUnitOption{"--column-unit", "NAME=UNIT",
                                 "give the column and its unit: t=ms or fx=kn"};

Expected<std::vector<std::pair<std::string, std::string>>> parse_pairs(
    const PairOption& option, const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == text.npos || equals == 0 || equals + 1 == text.size()) {
      return Error{.message = "'" + text + "' is not " + option.form,
                   .place = option.option,
                   .hint = option.hint};
    }
    pairs.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return pairs;
}

/// Poses of the objects in the bodies that are tracked.
Expected<std::map<std::string, Pose>> parse_object_places(const std::vector<std::string>& texts) {
  const auto pairs = parse_pairs(kPlaceOption, texts);
  if (!pairs) return pairs.error();
  std::map<std::string, Pose> places;
  for (const auto& [name, text] : *pairs) {
    std::vector<double> numbers;
    for (const std::string_view field : split_at(',', text)) {
      if (const auto number = pcavr::parse_number(field)) numbers.push_back(*number);
    }
    const Expected<Pose> pose = parse_pose(numbers, kPlaceOption.option);
    if (!pose) return pose.error();
    places.insert_or_assign(name, *pose);
  }
  return places;
}

constexpr InputRange kToolDelay{"delay of the tool's poses", -1.0, 1.0, "s",
                                "loggers and networks; clocks further apart are another fault"};
constexpr InputRange kWrenchTurn{"turn of the force sensor", -180.0, 180.0, "deg",
                                 "about the tool's z axis"};
constexpr InputRange kTare{"time before the first contact", 1e-3, 3600.0, "s",
                           "from one sample to an hour"};

/// Pushed sides of the first object that is to be imported, as the manifest has it.
Expected<PushedSides> pushed_sides(const BagImportOptions& options) {
  Error error{.message = {}, .place = "--find-world"};
  const auto fail = [&](std::string message, std::string hint) {
    error.message = std::move(message);
    error.hint = std::move(hint);
    return error;
  };
  if (options.T_base_world) {
    return fail("can't be combined with --T-base-world", "give one of them");
  }
  if (options.topics.objects.empty()) {
    return fail("needs the pushed object", "give --object NAME=TOPIC");
  }
  const Expected<Manifest> manifest = read_manifest_template(options.manifest);
  if (!manifest) return manifest.error();
  const std::string& name = options.topics.objects.front().first;
  for (const ObjectEntry& object : manifest->objects) {
    if (object.name != name || object.mesh.empty() || !manifest->tool_radius) continue;
    auto mesh = read_mesh(options.manifest.parent_path() / object.mesh);
    if (!mesh) return mesh.error();
    for (Eigen::Vector3f& vertex : mesh->vertices) vertex *= static_cast<float>(object.mesh_unit);
    const PushedSides sides = PushedSides::of(*mesh, *manifest->tool_radius);
    if (sides.outline_object.size() >= 3) return sides;
  }
  return fail("needs the mesh of object '" + name + "' and the tool's radius",
              "give --manifest FILE, a recording.yaml with both");
}

std::string world_text(const WorldPlacement& world) {
  const Eigen::Vector3d p = world.T_base_world.translation();
  const Eigen::Quaterniond& q = world.T_base_world.rotation();
  const std::string delay =
      world.tool_delay == 0.0
          ? fmt::format("no delay of the tool, to {:.0f} ms", 1e3 * world.delay_std)
          : fmt::format("tool {:.0f} +- {:.0f} ms late, taken off", 1e3 * world.tool_delay,
                        1e3 * world.delay_std);
  return fmt::format(
      "world   found from {} samples in contact, {:.2f} mm apart (std): +- {:.1f} mm, +- {:.2f} "
      "deg; {}\n"
      "    --T-base-world {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} --tool-delay {:.4f}\n",
      world.samples, 1e3 * world.residual, 1e3 * world.position_std,
      world.turn_std * 180.0 / std::numbers::pi, delay, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(),
      q.w(), world.tool_delay);
}

std::string counts_text(const ImportedStream& stream) {
  std::string text;
  if (stream.reordered > 0) text += fmt::format(", {} sorted by stamp", stream.reordered);
  if (stream.duplicates > 0) text += fmt::format(", {} duplicates left out", stream.duplicates);
  if (stream.left_out > 0) {
    text += fmt::format(", {} left out (first: {})", stream.left_out, stream.left_out_reason);
  }
  return text;
}

std::string stamps_text(const ImportedStream& stream) {
  if (stream.has_receive_stamps) return "log time";
  if (!stream.delay) return "";
  const bool is_future = *stream.delay < 0.0;
  return fmt::format("header, {:.1f} ms {} log time (median)", 1e3 * std::abs(*stream.delay),
                     is_future ? "after" : "before");
}

std::string summary_of(const BagImportReport& report, const std::string& folder) {
  std::string text =
      fmt::format("bag     {} messages, {:.3f} s; base frame {}\n", report.messages,
                  report.duration, report.base_frame.empty() ? "not known" : report.base_frame);
  bool has_frames = false;
  bool has_force = false;
  for (const ImportedStream& stream : report.streams) {
    text += fmt::format("{}: {} rows from {}{}\n", stream.file, stream.rows, stream.topic,
                        counts_text(stream));
    if (const std::string stamps = stamps_text(stream); !stamps.empty()) {
      text += "    stamps: " + stamps + "\n";
    }
    if (!stream.frame.empty()) text += "    frame: " + stream.frame + "\n";
    has_frames = has_frames || stream.file.starts_with("rgb");
    has_force = has_force || stream.file == "wrench.csv";
  }
  if (report.world) text += world_text(*report.world);
  for (const std::string& note : report.notes) text += "not taken: " + note + "\n";
  text += "next: pcavr inspect " + folder;
  if (has_frames) text += "; pcavr build " + folder + " -o SCENE";
  if (has_force) text += "; pcavr identify friction " + folder + " -o PARAMETERS";
  return text + '\n';
}

nlohmann::ordered_json json_of(const BagImportReport& report, const std::string& folder) {
  nlohmann::ordered_json json{{"recording", folder},
                              {"messages", report.messages},
                              {"duration_s", report.duration},
                              {"base_frame", report.base_frame}};
  json["streams"] = nlohmann::ordered_json::array();
  for (const ImportedStream& stream : report.streams) {
    nlohmann::ordered_json entry{{"file", stream.file},
                                 {"topic", stream.topic},
                                 {"rows", stream.rows},
                                 {"sorted", stream.reordered},
                                 {"duplicates", stream.duplicates},
                                 {"left_out", stream.left_out},
                                 {"left_out_reason", stream.left_out_reason},
                                 {"stamps", stream.has_receive_stamps ? "log" : "header"},
                                 {"frame", stream.frame}};
    if (stream.delay) entry["delay_s"] = *stream.delay;
    json["streams"].push_back(entry);
  }
  json["not_taken"] = report.notes;
  if (const auto& world = report.world) {
    const Eigen::Vector3d p = world->T_base_world.translation();
    const Eigen::Quaterniond& q = world->T_base_world.rotation();
    json["world"] = {{"T_base_world", {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}},
                     {"position_std_m", world->position_std},
                     {"turn_std_rad", world->turn_std},
                     {"tool_delay_s", world->tool_delay},
                     {"tool_delay_std_s", world->delay_std},
                     {"residual_m", world->residual},
                     {"samples", world->samples}};
  }
  return json;
}

std::string detail_of(const SurveyedTopic& topic) {
  std::string text;
  if (topic.width > 0) text += fmt::format(" {} x {}", topic.width, topic.height);
  if (!topic.image_format.empty()) text += " " + topic.image_format;
  for (const std::string& frame : topic.frames) {
    if (!frame.empty()) text += (text.find("frame") == text.npos ? " frame " : ", ") + frame;
  }
  if (topic.delay) text += fmt::format(" delay {:.1f} ms", 1e3 * *topic.delay);
  if (topic.undecodable > 0) {
    text += fmt::format(" {} can't be decoded: {}", topic.undecodable, topic.problem);
  }
  return text;
}

nlohmann::ordered_json json_of(const SurveyedTopic& topic, Stamp begin, const std::string& use) {
  nlohmann::ordered_json json{{"topic", topic.topic.name},
                              {"type", topic.topic.type},
                              {"serialization", topic.topic.encoding},
                              {"messages", topic.messages},
                              {"taken_for", use},
                              {"frames", topic.frames},
                              {"undecodable", topic.undecodable}};
  if (topic.rate) json["rate_hz"] = *topic.rate;
  if (topic.messages > 0) {
    json["begin_s"] = to_seconds(topic.first - begin);
    json["end_s"] = to_seconds(topic.last - begin);
  }
  if (topic.delay) json["delay_s"] = *topic.delay;
  if (!topic.image_format.empty()) json["image_format"] = topic.image_format;
  if (topic.width > 0) json["image_size"] = {topic.width, topic.height};
  return json;
}

}  // namespace

void add_bag_options(CLI::App& command, BagArguments& arguments) {
  CLI::App* group = command.add_option_group("bags",
                                             "ROS 1 (.bag), ROS 2 (.mcap, .db3, folders) and CSV "
                                             "files, each a topic; 'pcavr inspect' lists "
                                             "topics");
  BagTopicOptions& topics = arguments.topics;
  const auto add = [&](const char* name, std::string& value, const char* what) {
    group->add_option(name, value, what);
  };
  add("--depth-topic", topics.depth_topic, "Depth images, registered to colour");
  add("--colour-topic", topics.color_topic,
      "Colour images; none: depth alone, which need not be registered");
  add("--camera-info-topic", topics.camera_info_topic, "Camera info of the colour images");
  add("--camera-pose-topic", topics.camera_pose_topic,
      "Poses of the camera's optical frame; if absent by TF, if that has them");
  add("--tool-topic", topics.tool_topic, "Poses or points of the tool's tip");
  add("--tool-frame", topics.tool_frame, "The tip's frame in TF, instead of a topic");
  group
      ->add_option("--tool-offset", arguments.tool_offset,
                   "The tip in the frame of the tool topic or frame: x y z [m]")
      ->expected(3)
      ->check(CLI::Range(-10.0, 10.0));
  add("--base-frame", topics.base_frame,
      "The robot's base, into which poses and forces are transformed by TF");
  add("--wrench-topic", topics.wrench_topic, "Forces of the tool on its surroundings");
  add("--wrench-frame", topics.wrench_frame,
      "The forces' frame, instead of that in their headers; the base frame: they are not rotated; "
      "tool: the axes of the tool's poses");
  add_number(*group, "--wrench-turn", arguments.wrench_turn, kWrenchTurn,
             "With --wrench-frame tool: turn the forces by this about the tool's z axis, as the "
             "sensor is mounted; 'pcavr inspect' finds it [deg]");
  group->add_flag("--invert-wrench", arguments.invert_wrench,
                  "For sensors that report the force on the tool");
  add_number(*group, "--tare", arguments.tare, kTare,
             "Take the force's mean over this time from its start off: bias and tool's weight [s]");
  add_number(*group, "--tool-delay", arguments.tool_delay, kToolDelay,
             "Take this time off the stamps of the tool's poses [s]");
  group->add_flag(
      "--find-world", arguments.find_world,
      "Find --T-base-world, the pose of the objects' world frame in base, and the tool's "
      "delay from a push: the tip touches the first object's sides (--manifest)");
  group->add_option("--world-runs", arguments.world_bags,
                    "Further runs of this object by which --find-world finds it");
  add("--joint-topic", topics.joint_topic, "Joint states");
  group->add_option("--object", arguments.objects,
                    "NAME=TOPIC: poses of a tracked object; may be repeated");
  group->add_option("--T-tracked-object", arguments.object_places,
                    "NAME=tx,ty,tz,qx,qy,qz,qw: pose of an object's CAD frame in the body that is "
                    "tracked, where they differ");
  group
      ->add_option("--map", arguments.columns,
                   "NAME=COLUMN,...: which column of CSV files is t, x, qx, fx, tx, ...")
      ->delimiter(',');
  group
      ->add_option("--column-unit", arguments.units,
                   "NAME=UNIT,...: units of columns whose header states none or another")
      ->delimiter(',');
  group
      ->add_option("--up", arguments.up,
                   "y or z: the upward axis of a take of motion capture; y if absent")
      ->check(CLI::IsMember({"y", "z"}));
  group
      ->add_option("--stamps", arguments.stamps,
                   "header or receive: which stamps of the messages are used")
      ->check(CLI::IsMember({"header", "receive"}))
      ->capture_default_str();
}

std::string first_bag_option(const BagArguments& arguments) {
  const BagTopicOptions& t = arguments.topics;
  if (!t.depth_topic.empty()) return "--depth-topic";
  if (!t.color_topic.empty()) return "--colour-topic";
  if (!t.camera_info_topic.empty()) return "--camera-info-topic";
  if (!t.camera_pose_topic.empty()) return "--camera-pose-topic";
  if (!t.tool_topic.empty()) return "--tool-topic";
  if (!t.tool_frame.empty()) return "--tool-frame";
  if (!arguments.tool_offset.empty()) return "--tool-offset";
  if (!t.base_frame.empty()) return "--base-frame";
  if (!t.wrench_topic.empty()) return "--wrench-topic";
  if (!t.wrench_frame.empty()) return "--wrench-frame";
  if (arguments.invert_wrench) return "--invert-wrench";
  if (arguments.wrench_turn != 0.0) return "--wrench-turn";
  if (!t.joint_topic.empty()) return "--joint-topic";
  if (!arguments.objects.empty()) return "--object";
  if (arguments.tare > 0.0) return "--tare";
  if (arguments.tool_delay != 0.0) return "--tool-delay";
  if (arguments.find_world) return "--find-world";
  if (!arguments.world_bags.empty()) return "--world-runs";
  if (!arguments.object_places.empty()) return "--T-tracked-object";
  if (!arguments.columns.empty()) return "--map";
  if (!arguments.units.empty()) return "--column-unit";
  if (!arguments.up.empty()) return "--up";
  return arguments.stamps != "header" ? "--stamps" : "";
}

namespace {

/// Reports what is wrong with the recording's stamps and samples, while the source is at hand.
void warn_of_streams(const std::string& folder, const Observer& observer) {
  const Expected<Recording> recording = read_recording(folder);
  if (!recording) {
    observer.on_warning(recording.error().to_string());
    return;
  }
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  for (const std::string& note : recording->notes) observer.on_note(note);
}

}  // namespace

Expected<CsvOptions> csv_options(const BagArguments& arguments, bool skip_bad) {
  CsvOptions options{.skip_bad = skip_bad};
  const auto columns = parse_pairs(kMapOption, arguments.columns);
  if (!columns) return columns.error();
  options.columns = {columns->begin(), columns->end()};
  const auto units = parse_pairs(kUnitOption, arguments.units);
  if (!units) return units.error();
  options.units = {units->begin(), units->end()};
  if (!arguments.up.empty()) options.up = arguments.up.front();
  return options;
}

Expected<CommandResult> run_import_bag(const std::string& source, const OutputOption& output,
                                       const BagArguments& arguments, BagImportOptions options,
                                       const Observer& observer) {
  options.topics = arguments.topics;
  const auto objects = parse_pairs(kObjectOption, arguments.objects);
  if (!objects) return objects.error();
  options.topics.objects = *objects;
  auto places = parse_object_places(arguments.object_places);
  if (!places) return places.error();
  options.T_tracked_object = *std::move(places);
  options.use_receive_stamps = arguments.stamps == "receive";
  if (arguments.tool_offset.size() == 3) {
    options.p_tool_tip = Eigen::Vector3d::Map(arguments.tool_offset.data());
  }
  options.invert_wrench = arguments.invert_wrench;
  options.wrench_turn = arguments.wrench_turn * std::numbers::pi / 180.0;
  options.tare = arguments.tare;
  options.tool_delay = arguments.tool_delay;
  if (arguments.find_world) {
    const auto sides = pushed_sides(options);
    if (!sides) return sides.error();
    options.pushed_sides = *sides;
    options.world_bags.assign(arguments.world_bags.begin(), arguments.world_bags.end());
  }
  Expected<OutputFolder> folder =
      create_output(output, OutputKind::recording, {source, options.manifest});
  if (!folder) return folder.error();
  const Expected<BagImportReport> report = import_bag(source, folder->path(), options, observer);
  if (!report) return report.error();
  const Expected<void> committed = folder->commit();
  if (!committed) return committed.error();
  warn_of_streams(output.folder, observer);
  return CommandResult{.summary = summary_of(*report, output.folder),
                       .json = json_of(*report, output.folder)};
}

Expected<CommandResult> inspect_bag(const std::filesystem::path& bag, const Observer& observer) {
  const Expected<BagSurvey> survey = survey_bag(bag, observer);
  if (!survey) return survey.error();
  const Expected<BagSelection> selection = select_bag_topics(bag, *survey, {});
  if (!selection) return selection.error();
  for (const std::string& warning : survey->warnings) observer.on_warning(warning);
  CommandResult result;
  const double duration = to_seconds(survey->last - survey->first);
  result.summary = fmt::format("{} messages on {} topics", survey->messages, survey->topics.size());
  if (survey->messages > 0) {
    result.summary += fmt::format(", {:.3f} s from {}", duration, format_stamp(survey->first, 9));
  }
  result.summary += '\n';
  result.json = {{"bag", bag.string()}, {"messages", survey->messages}};
  if (survey->messages > 0) {
    result.json["begin_s"] = survey->first.seconds();
    result.json["duration_s"] = duration;
  }
  result.json["topics"] = nlohmann::ordered_json::array();
  for (const SurveyedTopic& topic : survey->topics) {
    const std::string use = selection->use_of(topic);
    result.json["topics"].push_back(json_of(topic, survey->first, use));
    result.summary += fmt::format("  {:>7} {:>9}  {}  {} ({}){}{}\n", topic.messages,
                                  topic.rate ? fmt::format("{:.1f} Hz", *topic.rate) : "",
                                  topic.topic.name, topic.topic.type, topic.topic.encoding,
                                  detail_of(topic), use.empty() ? "" : "  [" + use + "]");
  }
  result.json["base_frame"] = selection->base_frame;
  result.json["transforms"] = nlohmann::ordered_json::array();
  std::string links;
  for (const auto& [link, count] : survey->transforms) {
    links += fmt::format("{}{} -> {}", links.empty() ? "" : ", ", link.first, link.second);
    result.json["transforms"].push_back({link.first, link.second});
  }
  if (!links.empty()) result.summary += "TF: " + links + '\n';
  for (const std::string& note : selection->notes) result.summary += "import: " + note + '\n';
  result.json["not_taken"] = selection->notes;
  if (has_csv_series(bag)) {
    const std::vector<std::string> others = other_files(bag);
    result.json["not_read"] = others;
    if (!others.empty()) {
      result.summary += fmt::format("not read, as no CSV files: {}\n", fmt::join(others, ", "));
    }
  }
  result.summary += "next: " + import_command(bag, *selection) + '\n';
  return result;
}

}  // namespace pcavr::app
