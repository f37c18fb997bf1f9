// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pcavr/pipeline/doctor.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/recording/stamp_units.hpp"

#include "diagnosis_rows.hpp"

namespace pcavr {
namespace {

// Log times are those of messages that arrive: networks and loggers delay them.
constexpr double kMinTopicGap = 0.5;         // [s]
constexpr double kMinTopicIntervals = 10.0;  // [mean intervals]
constexpr double kMaxSensorInterval = 1.0;   // [s] of a tool or a force: no robot logs as slowly
constexpr double kSlowTopic = 0.12;          // [s] robots are sampled at 10 Hz or more
constexpr std::size_t kMinRateMessages = 5;  // fewer show no rate

std::string figure_of(const SurveyedTopic& topic, const std::string& use) {
  std::string figure = fmt::format("taken for {}: {} messages", use, topic.messages);
  if (topic.rate) {
    figure += fmt::format(" over {:.3f} s, {:.4g} Hz, longest interval {:.1f} ms",
                          to_seconds(topic.last - topic.first), *topic.rate,
                          1e3 * topic.longest_interval);
  }
  if (topic.delay) figure += fmt::format("; {:.1f} ms from stamp to log time", 1e3 * *topic.delay);
  if (topic.unstamped > 0) figure += fmt::format("; {} without a stamp", topic.unstamped);
  return figure;
}

/// What a topic's rate and messages show to be wrong; empty cause where nothing is.
std::string cause_of(const SurveyedTopic& topic, bool is_sensor) {
  if (topic.undecodable > 0) {
    return fmt::format("{} messages can't be decoded: {}", topic.undecodable, topic.problem);
  }
  if (!topic.rate || topic.messages < kMinRateMessages) return "";
  const double interval = 1.0 / *topic.rate;
  if (is_sensor && interval > kMaxSensorInterval) {
    const std::string unit = unit_of_interval(interval).value_or("another unit than seconds");
    return fmt::format(
        "too slow for a robot: the stamps are probably in {}; import with "
        "--column-unit t=UNIT",
        unit);
  }
  if (topic.longest_interval > std::max(kMinTopicGap, kMinTopicIntervals * interval)) {
    return "messages were lost, or the source paused: nothing is known of that time";
  }
  return "";
}

void add_topic(const SurveyedTopic& topic, const BagSelection& selection,
               std::vector<DiagnosisRow>& rows) {
  const std::string& name = topic.topic.name;
  const bool is_sensor = &topic == selection.tool || &topic == selection.wrench;
  std::string figure = figure_of(topic, selection.use_of(topic));
  std::string cause = cause_of(topic, is_sensor);
  const bool agrees = cause.empty();
  rows.push_back(agrees ? agreement(name, std::move(figure))
                        : disagreement(name, std::move(figure), std::move(cause)));
  if (!agrees || !is_sensor || !topic.rate || *topic.rate * kSlowTopic > 1.0) return;
  rows.push_back(
      unchecked("unit of the stamps of " + name,
                fmt::format("{:.3g} Hz is slow for a robot: with other units it would be "
                            "faster; the speeds show it in a recording",
                            *topic.rate)));
}

/// What a recording would lack, and for what it is needed.
void add_missing(const BagSelection& selection, std::vector<DiagnosisRow>& rows) {
  const auto add = [&](bool is_missing, const char* what, const char* purpose) {
    if (is_missing) rows.push_back(unchecked(what, std::string("no topic is taken: ") + purpose));
  };
  add(selection.depth == nullptr, "depth images", "build fuses them");
  add(selection.color == nullptr, "colour images", "tags are found in them");
  add(selection.camera_info == nullptr &&
          (selection.depth != nullptr || selection.color != nullptr),
      "camera", "give it by --camera");
  add(selection.tool == nullptr, "tool.csv", "identify and replay need the tip's poses");
  add(selection.wrench == nullptr, "wrench.csv", "identify needs the force");
  add(selection.joints == nullptr, "joints.csv", "an arm's friction and links are not known");
  add(selection.objects.empty(), "tracked objects",
      "their motion is to follow from tags or pushes");
  const bool has_poses = selection.tool != nullptr || selection.wrench != nullptr;
  if (has_poses && selection.base_frame.empty()) {
    rows.push_back(
        unchecked("base frame", "not known: poses and forces would be taken as they are"));
  }
}

/// Depth in another frame than colour is that of another camera.
void add_registration(const BagSelection& selection, std::vector<DiagnosisRow>& rows) {
  if (selection.depth == nullptr || selection.color == nullptr) return;
  const char* what = "registration of depth to colour";
  if (selection.depth->frames != selection.color->frames) {
    rows.push_back(disagreement(
        what,
        fmt::format("depth is in frame {}, colour in {}", fmt::join(selection.depth->frames, ", "),
                    fmt::join(selection.color->frames, ", ")),
        "depth of another camera: record the aligned depth"));
    return;
  }
  rows.push_back(unchecked(what, "frame names agree; import compares the camera infos"));
}

void add_left_out(const std::filesystem::path& bag, const BagSurvey& survey,
                  const BagSelection& selection, std::vector<DiagnosisRow>& rows) {
  std::vector<std::string> names;
  for (const SurveyedTopic& topic : survey.topics) {
    if (!selection.use_of(topic).empty() || is_tf_topic(topic)) continue;
    names.push_back(topic.topic.name +
                    (topic.rate ? fmt::format(" ({:.4g} Hz)", *topic.rate) : std::string()));
  }
  if (!names.empty()) {
    rows.push_back(unchecked("topics not taken", fmt::format("{}", fmt::join(names, ", "))));
  }
  for (const std::string& note : selection.notes) rows.push_back(unchecked("import", note));
  if (!has_csv_series(bag)) return;
  const std::vector<std::string> others = other_files(bag);
  if (!others.empty()) {
    rows.push_back(unchecked(
        "other files", fmt::format("not read, as no CSV files: {}", fmt::join(others, ", "))));
  }
}

}  // namespace

std::string import_command(const std::filesystem::path& bag, const BagSelection& selection) {
  std::string command = "pcavr import '" + bag.string() + "'";
  const bool has_images = selection.depth != nullptr || selection.color != nullptr;
  if (has_images && selection.camera_info == nullptr) command += " --camera CAMERA.yaml";
  if (!selection.objects.empty()) command += " --manifest BODIES.yaml";
  return command + " -o RECORDING";
}

DiagnosisReport diagnose_bag(const std::filesystem::path& bag, const BagSurvey& survey,
                             const BagSelection& selection) {
  DiagnosisReport report;
  std::vector<DiagnosisRow>& rows = report.rows;
  if (survey.messages == 0) {
    rows.push_back(disagreement("messages", "there are none", "the recorder had no subscription"));
  }
  for (const SurveyedTopic& topic : survey.topics) {
    if (!selection.use_of(topic).empty()) add_topic(topic, selection, rows);
  }
  for (const std::string& warning : survey.warnings) {
    rows.push_back(unchecked("assumed in reading", warning));
  }
  if (!survey.transforms.empty()) {
    rows.push_back(
        agreement("transforms",
                  fmt::format("{} links of TF; base frame {}", survey.transforms.size(),
                              selection.base_frame.empty() ? "not known" : selection.base_frame)));
  }
  add_registration(selection, rows);
  add_missing(selection, rows);
  add_left_out(bag, survey, selection, rows);
  rows.push_back(unchecked("tags, bodies, contacts, clocks", "they are checked in a recording"));
  report.next = import_command(bag, selection) + "; pcavr doctor RECORDING";
  return report;
}

}  // namespace pcavr
