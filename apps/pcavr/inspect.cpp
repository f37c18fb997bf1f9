// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/perception/scene/scene_bundle.hpp"
#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/recordings/bag_import/csv_series.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/stamp_units.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "commands.hpp"
#include "import_bag.hpp"
#include "recover_log.hpp"
#include "unknown_input.hpp"

namespace pcavr::app {
namespace fs = std::filesystem;
namespace {

CommandResult describe_checks(const std::vector<SceneCheck>& checks,
                              const std::vector<InputComparison>& comparisons = {}) {
  CommandResult result;
  result.json["checks"] = nlohmann::ordered_json::array();
  for (const SceneCheck& check : checks) {
    result.summary +=
        (check.is_sound ? "  ok   " : "  BAD  ") + check.what + ": " + check.figure + '\n';
    result.json["checks"].push_back(
        {{"what", check.what}, {"figure", check.figure}, {"is_sound", check.is_sound}});
    result.is_failure = result.is_failure || !check.is_sound;
  }
  if (!comparisons.empty()) {
    result.json["compared"] = nlohmann::ordered_json::array();
    result.json["not_compared"] = nlohmann::ordered_json::array();
  }
  for (const InputComparison& one : comparisons) {
    if (one.is_compared()) {
      result.summary += "  compared: " + one.what + ": " + one.figure + '\n';
      result.json["compared"].push_back({{"what", one.what}, {"figure", one.figure}});
    } else {
      result.summary += "  not compared: " + one.what + ": " + one.reason + '\n';
      result.json["not_compared"].push_back({{"what", one.what}, {"reason", one.reason}});
    }
  }
  result.json["is_sound"] = !result.is_failure;
  return result;
}

/// Number of poses, and the time from the first to the last [s].
nlohmann::ordered_json values_of(const Trajectory& trajectory) {
  const auto& poses = trajectory.poses();
  const double seconds = poses.empty() ? 0.0 : to_seconds(poses.back().stamp - poses.front().stamp);
  return {{"poses", poses.size()}, {"duration_s", seconds}};
}

std::string span_of(const Trajectory& trajectory) {
  if (trajectory.empty()) return "none";
  const double seconds =
      to_seconds(trajectory.poses().back().stamp - trajectory.poses().front().stamp);
  return fmt::format("{} poses over {:.3f} s", trajectory.size(), seconds);
}

/// Nearest, median and farthest reading of all depth images: a wrong depth_scale is seen in them.
class DepthReadings {
 public:
  void add(const DepthImage& depth) {
    for (const float z : depth.pixels()) {
      if (!(z > 0.0F)) continue;
      nearest_ = count_ == 0 ? z : std::min(nearest_, z);
      farthest_ = std::max(farthest_, z);
      if (count_++ % kStride == 0) sample_.push_back(static_cast<double>(z));
    }
    ++frames_;
  }
  [[nodiscard]] SceneCheck check() const {
    std::string figure =
        std::to_string(frames_ == 0 ? 0 : count_ / frames_) + " readings per frame";
    if (count_ > 0) {
      figure += fmt::format(", nearest {:.3f} m, median {:.3f} m, farthest {:.3f} m", nearest_,
                            median(sample_), farthest_);
    }
    return {"depth", std::move(figure), frames_ == 0 || count_ > 0};
  }
  [[nodiscard]] nlohmann::ordered_json values() const {
    nlohmann::ordered_json json{{"readings_per_frame", frames_ == 0 ? 0 : count_ / frames_}};
    if (count_ == 0) return json;
    json["nearest_m"] = nearest_;
    json["median_m"] = median(sample_);
    json["farthest_m"] = farthest_;
    return json;
  }

 private:
  static constexpr std::size_t kStride = 499;  ///< prime: not a column of the image
  std::size_t frames_ = 0, count_ = 0;
  float nearest_ = 0.0F, farthest_ = 0.0F;  ///< [m]
  std::vector<double> sample_;              ///< [m] every kStride-th reading, for the median
};

constexpr char kStampsCheck[] = "stamps";

/// Checks the stamps and samples of the streams.
void check_streams(const Recording& recording, std::vector<SceneCheck>& checks) {
  const std::vector<ClockConflict> conflicts = find_clock_conflicts(recording);
  if (conflicts.empty()) checks.push_back({"clocks", "the streams overlap"});
  for (const ClockConflict& conflict : conflicts) {
    checks.push_back({"clocks", conflict.message, !conflict.is_disjoint});
  }
  for (const std::string& warning : doubtful_stamp_units(paces_of(recording))) {
    checks.push_back({kStampsCheck, "warning: " + warning});
  }
  for (const std::string& note : recording.notes) checks.push_back({"repeated rows", note});
}

/// Cross-checks the recording's inputs.
Expected<void> check_consistency(const Recording& recording, const PerceptionOptions& options,
                                 const Observer& observer, std::vector<SceneCheck>& checks,
                                 std::vector<InputComparison>& comparisons) {
  auto report = inspect_inputs(recording, options);
  if (!report) return report.error();
  for (const ConsistencyFinding& finding : report->findings) {
    const bool is_contradiction = finding.severity == FindingSeverity::contradiction;
    if (!is_contradiction) observer.on_warning(finding.to_string());
    checks.push_back({finding.input(),
                      (is_contradiction ? "" : "warning: ") + finding.message + "; " + finding.hint,
                      !is_contradiction});
  }
  const bool has_doubt = std::any_of(checks.begin(), checks.end(), [](const SceneCheck& check) {
    return !check.is_sound || check.what == kStampsCheck;
  });
  comparisons = std::move(report->comparisons);
  const auto compared = std::count_if(comparisons.begin(), comparisons.end(),
                                      [](const auto& one) { return one.is_compared(); });
  if (report->findings.empty() && !has_doubt) {
    checks.push_back(
        {"consistency",
         fmt::format("what was compared agrees: {} comparisons; {} could not be made, see below",
                     compared, std::ssize(comparisons) - compared)});
  }
  return {};
}

/// The numbers of a recording's checks, for programs: what the checks state in words.
nlohmann::ordered_json values_of(const Recording& recording, std::size_t frames,
                                 const DepthReadings& readings) {
  nlohmann::ordered_json values{{"markers", recording.manifest.markers.size()},
                                {"objects", recording.manifest.objects.size()},
                                {"frames", frames},
                                {"unpaired_color", recording.unpaired_color},
                                {"unpaired_depth", recording.unpaired_depth},
                                {"groundtruth.txt", values_of(recording.groundtruth)},
                                {"tool.csv", values_of(recording.tool)},
                                {"wrench.csv", {{"samples", recording.wrench.size()}}},
                                {"joints.csv", {{"samples", recording.joints.size()}}}};
  if (recording.has_depth) values["depth"] = readings.values();
  return values;
}

/// Reads all files without skipping bad rows, and decodes every frame.
Expected<CommandResult> inspect_recording(const fs::path& folder,
                                          const Configuration& configuration,
                                          const Observer& observer) {
  const Expected<Recording> recording = read_with_warnings(folder, false, configuration, observer);
  if (!recording) return recording.error();
  FrameReader reader(*recording);
  std::size_t frames = 0;
  DepthReadings readings;
  while (true) {
    const Expected<std::optional<RgbdFrame>> frame = reader.next();
    if (!frame) return frame.error();
    if (!*frame) break;
    readings.add((*frame)->depth);
    observer.on_progress("decoding", ++frames, recording->frames.size());
  }
  std::vector<SceneCheck> checks;
  const auto count = [](std::size_t n, const char* what) { return std::to_string(n) + what; };
  const Manifest& manifest = recording->manifest;
  checks.push_back({"recording.yaml", count(manifest.markers.size(), " markers, ") +
                                          count(manifest.objects.size(), " objects")});
  for (const ObjectEntry& object : manifest.objects) {
    if (!object.mesh.empty()) continue;
    checks.push_back({"objects: " + object.name, "warning: no CAD mesh; build needs one (mesh:)"});
  }
  if (recording->has_depth) {
    checks.push_back({"frames", count(frames, " pairs, ") +
                                    count(recording->unpaired_color, " colour and ") +
                                    count(recording->unpaired_depth, " depth images unpaired")});
    checks.push_back(readings.check());
  } else {
    checks.push_back({"frames", count(frames, " colour images, no depth.txt")});
  }
  checks.push_back({"groundtruth.txt", span_of(recording->groundtruth)});
  checks.push_back({"tool.csv", span_of(recording->tool)});
  checks.push_back({"wrench.csv", count(recording->wrench.size(), " samples")});
  checks.push_back({"joints.csv", count(recording->joints.size(), " samples")});
  check_streams(*recording, checks);
  std::vector<InputComparison> comparisons;
  const Expected<void> checked =
      check_consistency(*recording, configuration.perception(), observer, checks, comparisons);
  if (!checked) return checked.error();
  CommandResult result = describe_checks(checks, comparisons);
  result.json["values"] = values_of(*recording, frames, readings);
  return result;
}

/// Reads every tracked trajectory of a run.
Expected<std::vector<SceneCheck>> inspect_run(const fs::path& folder) {
  if (const Expected<void> whole = check_line_counts(folder / "run.yaml"); !whole) {
    return whole.error();
  }
  std::vector<SceneCheck> checks;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder / "objects", code)) {
    const fs::path tracked = entry.path() / "tracked.txt";
    const Expected<Trajectory> trajectory = read_trajectory(tracked);
    if (!trajectory) return trajectory.error();
    checks.push_back(
        {fs::relative(tracked, folder).string(), span_of(*trajectory), !trajectory->empty()});
  }
  std::sort(checks.begin(), checks.end(),
            [](const SceneCheck& a, const SceneCheck& b) { return a.what < b.what; });
  return checks;
}

Expected<CommandResult> inspect(const fs::path& folder, const Configuration& configuration,
                                const Observer& observer) {
  for (const char* manifest : {"scene.yaml", "recording.yaml", "run.yaml"}) {
    // A bag may be a file: no folder has these files then.
    const Expected<bool> is_there =
        fs::is_directory(folder) ? is_present(folder / manifest) : Expected<bool>(false);
    if (!is_there) return is_there.error();
    if (!*is_there) continue;
    const std::string name = manifest;
    if (name == "recording.yaml") return inspect_recording(folder, configuration, observer);
    const Expected<std::vector<SceneCheck>> checks =
        name == "scene.yaml" ? inspect_scene(folder) : inspect_run(folder);
    if (!checks) return checks.error();
    return describe_checks(*checks);
  }
  if (has_csv_series(folder) || is_bag(folder)) return inspect_bag(folder, observer);
  return unknown_input(folder);
}

}  // namespace

void add_inspect(CLI::App& app, const Configuration& configuration, Action& action) {
  struct Arguments {
    std::string folder;
    bool is_recovery = false;
    OutputOption output;
  };
  CLI::App* command = app.add_subcommand(
      "inspect", "Summarise a recording, a scene or a run, and check that it is sound; list a bag");
  command->footer(
      "Example:\n  pcavr inspect my_scene\n  pcavr inspect push.bag\n"
      "  pcavr inspect push.mcap --recover -o whole.mcap");
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("folder", arguments->folder, "Folder of a recording, a scene or a run; or a bag")
      ->required();
  CLI::Option* recover = command->add_flag(
      "--recover", arguments->is_recovery,
      "Rewrite an MCAP file whose writer was killed, with an index, up to its last whole record");
  command
      ->add_option("-o,--output", arguments->output.folder,
                   "With --recover: MCAP file to write, which may be the one that is read; "
                   "default: beside it, NAME-recovered.mcap")
      ->needs(recover);
  command
      ->add_flag("--force", arguments->output.replace,
                 "With --recover: replace another MCAP file that exists")
      ->needs(recover);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      if (arguments->is_recovery) {
        return recover_log(arguments->folder, arguments->output, observer);
      }
      return inspect(arguments->folder, configuration, observer);
    };
  });
}

}  // namespace pcavr::app
