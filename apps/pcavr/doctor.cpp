// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/doctor.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "commands.hpp"
#include "unknown_input.hpp"

namespace pcavr::app {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxColumn = 34;  ///< [characters] of the first column

struct VerdictText {
  DiagnosisVerdict verdict;
  const char* heading;
  const char* key;     ///< in JSON
  const char* figure;  ///< the figure's key
};
constexpr VerdictText kVerdicts[] = {
    {DiagnosisVerdict::agrees, "agrees", "agrees", "figure"},
    {DiagnosisVerdict::disagrees, "disagrees", "disagrees", "figure"},
    {DiagnosisVerdict::not_checked, "could not be checked", "not_checked", "reason"}};

std::string table_of(const DiagnosisReport& report, const VerdictText& verdict, std::size_t width) {
  std::string text;
  for (const DiagnosisRow& row : report.rows) {
    if (row.verdict != verdict.verdict) continue;
    text += fmt::format("  {:<{}}  {}\n", row.what, width, row.figure);
    if (!row.cause.empty()) text += fmt::format("  {:<{}}  likely: {}\n", "", width, row.cause);
  }
  return fmt::format("{}:\n{}", verdict.heading, text.empty() ? "  nothing\n" : text);
}

CommandResult describe(const DiagnosisReport& report) {
  std::size_t width = 0;
  for (const DiagnosisRow& row : report.rows) {
    if (row.what.size() <= kMaxColumn) width = std::max(width, row.what.size());
  }
  CommandResult result;
  for (const VerdictText& verdict : kVerdicts) {
    result.summary += table_of(report, verdict, width);
    nlohmann::ordered_json& rows = result.json[verdict.key] = nlohmann::ordered_json::array();
    for (const DiagnosisRow& row : report.rows) {
      if (row.verdict != verdict.verdict) continue;
      rows.push_back({{"what", row.what}, {verdict.figure, row.figure}});
      if (!row.cause.empty()) rows.back()["likely"] = row.cause;
    }
  }
  result.summary += "next: " + report.next + '\n';
  result.json["next"] = report.next;
  result.is_no = report.has_disagreement();
  return result;
}

Expected<CommandResult> examine_bag(const fs::path& bag, const Observer& observer) {
  const Expected<BagSurvey> survey = survey_bag(bag, observer);
  if (!survey) return survey.error();
  const Expected<BagSelection> selection = select_bag_topics(bag, *survey, {});
  if (!selection) return selection.error();
  return describe(diagnose_bag(bag, *survey, *selection));
}

/// The error for a path that is none of what `doctor` reads.
Error unknown_path(const fs::path& path) {
  std::error_code code;
  if (!fs::exists(path / "depth.txt", code) && !fs::exists(path / "rgb.txt", code)) {
    return unknown_csv_columns(path).value_or(unknown_input(path));
  }
  return {.message = "has lists of images, but no recording.yaml",
          .file = path.string(),
          .hint = fmt::format("make a recording of it: pcavr import '{}' --camera CAMERA.yaml -o "
                              "RECORDING; then pcavr doctor RECORDING",
                              path.string())};
}

/// Of a recording with bad rows the rest is checked, too.
DiagnosisReport examine_recording(const fs::path& path, const Configuration& configuration) {
  const Expected<Recording> recording = read_recording(path, configuration.reading);
  if (recording) return diagnose_recording(*recording, configuration.perception());
  ReadOptions tolerant = configuration.reading;
  tolerant.skip_bad = true;
  const Expected<Recording> rest = read_recording(path, tolerant);
  if (!rest) return diagnose_unreadable(recording.error());
  DiagnosisReport report = diagnose_recording(*rest, configuration.perception());
  add_unreadable(recording.error(), report);
  return report;
}

/// Whether it is one of what a folder of logs may hold; a bag may be a file.
bool is_log(const fs::path& path) {
  std::error_code code;
  return fs::exists(path / "recording.yaml", code) || has_csv_series(path) || is_bag(path);
}

/// The logs in a folder, by name.
std::vector<fs::path> logs_in(const fs::path& folder) {
  std::vector<fs::path> logs;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    if (is_log(entry.path())) logs.push_back(entry.path());
  }
  std::sort(logs.begin(), logs.end());
  return logs;
}

Expected<CommandResult> examine_one(const fs::path& path, const Configuration& configuration,
                                    const Observer& observer) {
  const Expected<bool> is_recording =
      fs::is_directory(path) ? is_present(path / "recording.yaml") : Expected<bool>(false);
  if (!is_recording) return is_recording.error();
  if (*is_recording) return describe(examine_recording(path, configuration));
  return examine_bag(path, observer);
}

/// One table for each log; one that can't be read is said so in its place.
CommandResult examine_each(const std::vector<fs::path>& logs, const Configuration& configuration,
                           const Observer& observer) {
  CommandResult all;
  for (const fs::path& log : logs) {
    Expected<CommandResult> one = examine_one(log, configuration, observer);
    if (!one) one = describe(diagnose_unreadable(one.error()));
    all.is_no = all.is_no || one->is_no;
    all.summary +=
        fmt::format("{}== {}\n", all.summary.empty() ? "" : "\n", log.string()) + one->summary;
    nlohmann::ordered_json json{{"path", log.string()}};
    json.update(one->json);
    all.json["logs"].push_back(std::move(json));
  }
  return all;
}

Expected<CommandResult> examine(const fs::path& path, const Configuration& configuration,
                                const Observer& observer) {
  if (is_log(path)) return examine_one(path, configuration, observer);
  if (fs::is_regular_file(path) && (path.extension() == ".yaml" || path.extension() == ".yml")) {
    const Expected<CameraFile> camera = read_camera_file(path);
    if (!camera) return camera.error();
    return describe(diagnose_camera(path, *camera));
  }
  const std::vector<fs::path> logs = logs_in(path);
  if (!logs.empty()) return examine_each(logs, configuration, observer);
  return unknown_path(path);
}

}  // namespace

void add_doctor(CLI::App& app, const Configuration& configuration, Action& action) {
  CLI::App* command =
      app.add_subcommand("doctor",
                         "Check all that can be checked of a recording, a bag, a folder of tables "
                         "or a camera's file: what agrees, what "
                         "disagrees and why, what could not be checked, and what to do next");
  command->footer(
      "Exit code: 0 if nothing disagrees, 3 if something does or a recording can't be read, 1 if "
      "there is nothing to check.\n"
      "Example:\n  pcavr doctor my_recording\n  pcavr doctor push.bag");
  auto path = std::make_shared<std::string>();
  command
      ->add_option("path", *path,
                   "Folder of a recording, of tables, or of several such folders; a bag; a "
                   "camera's file")
      ->required();
  command->callback([path, &configuration, &action] {
    action = [path, &configuration](const Observer& observer) {
      return examine(*path, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
