// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/compare_runs.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Keys of run.yaml that are settings, not results. Of `parameters` only whether there are any:
/// each recording has its own file.
constexpr std::array<const char*, 6> kSettings{"forward_delay", "backward_delay", "jitter",
                                               "loss",          "corrections",    "identifies"};

struct RunIdentity {
  std::string recording;
  std::map<std::string, std::string> settings = {};
};

/// Whether an option of a configuration is stated under its own name, too.
bool is_stated(const std::string& option) {
  const std::string key = option.substr(option.rfind('.') + 1);
  return std::ranges::find(kSettings, key) != kSettings.end();
}

RunIdentity identity_of(const YamlValue& root) {
  RunIdentity identity{root.find("recording") ? root.find("recording")->text() : std::string()};
  for (const char* key : kSettings) {
    if (const auto value = root.find(key)) identity.settings[key] = value->text();
  }
  if (const auto file = root.find("parameters"))
    identity.settings["parameters"] = file->text() == "none" ? "none" : "given";
  if (const auto configuration = root.find("configuration")) {
    for (const auto& [key, value] : configuration->entries()) {
      if (!is_stated(key)) identity.settings[key] = value.text();
    }
  }
  return identity;
}

/// The settings that are not the same in all runs.
std::set<std::string> varied_keys(const std::vector<EvaluatedRun>& runs) {
  std::set<std::string> keys;
  for (const EvaluatedRun& run : runs) {
    for (const auto& entry : run.settings) {
      const bool is_common = std::ranges::all_of(runs, [&](const EvaluatedRun& other) {
        const auto found = other.settings.find(entry.first);
        return found != other.settings.end() && found->second == entry.second;
      });
      if (!is_common) keys.insert(entry.first);
    }
  }
  return keys;
}

/// A file's number has as many digits as a double; a name has as few as say the same.
std::string short_text(const std::string& text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end ? shortest_decimal(number) : text;
}

std::string setting_name(const EvaluatedRun& run, const std::set<std::string>& keys) {
  std::string name;
  for (const std::string& key : keys) {
    const auto found = run.settings.find(key);
    name += fmt::format("{}{}={}", name.empty() ? "" : " ", key,
                        found == run.settings.end() ? "default" : short_text(found->second));
  }
  return name.empty() ? "all" : name;
}

Error run_error(const EvaluatedRun& run, const std::string& message, const std::string& hint) {
  return {.message = message, .file = run.run, .place = {}, .hint = hint};
}

std::optional<Error> check_runs(const RunComparison& comparison) {
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const EvaluatedRun& run = comparison.runs[i];
    for (std::size_t j = 0; j < i; ++j) {
      const EvaluatedRun& other = comparison.runs[j];
      if (other.run == run.run) return run_error(run, "is given twice", "give each run once");
      if (other.recording == run.recording &&
          comparison.setting_of_run[i] == comparison.setting_of_run[j])
        return run_error(run, "is of the same recording and the same settings as " + other.run,
                         "give one of the two");
    }
  }
  return std::nullopt;
}

const RunMetric* find_metric(const EvaluatedRun& run, const std::string& name) {
  const auto found = std::ranges::find(run.metrics, name, &RunMetric::name);
  return found == run.metrics.end() ? nullptr : &*found;
}

/// Those of `to` minus those of `from`, by recording.
std::vector<double> differences_of(const RunComparison& comparison, const std::string& metric,
                                   std::size_t from, std::size_t to) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    if (comparison.setting_of_run[i] != from) continue;
    for (std::size_t j = 0; j < comparison.runs.size(); ++j) {
      if (comparison.setting_of_run[j] != to ||
          comparison.runs[j].recording != comparison.runs[i].recording)
        continue;
      const RunMetric* before = find_metric(comparison.runs[i], metric);
      const RunMetric* after = find_metric(comparison.runs[j], metric);
      if (before != nullptr && after != nullptr)
        differences.push_back(after->value - before->value);
    }
  }
  return differences;
}

/// The metrics of all runs, by their first appearance.
std::vector<RunMetric> all_metrics(const std::vector<EvaluatedRun>& runs) {
  std::vector<RunMetric> metrics;
  for (const EvaluatedRun& run : runs) {
    for (const RunMetric& metric : run.metrics) {
      if (std::ranges::find(metrics, metric.name, &RunMetric::name) == metrics.end())
        metrics.push_back(metric);
    }
  }
  return metrics;
}

std::vector<PairedDifference> paired_differences(const RunComparison& comparison, std::size_t to) {
  std::vector<PairedDifference> all;
  std::vector<double> p;
  for (const RunMetric& metric : all_metrics(comparison.runs)) {
    const std::vector<double> differences = differences_of(comparison, metric.name, 0, to);
    if (differences.empty()) continue;
    const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
    all.push_back({.metric = metric.name,
                   .unit = metric.unit,
                   .from = comparison.settings[0],
                   .to = comparison.settings[to],
                   .pairs = differences.size(),
                   .mean = sum / static_cast<double>(differences.size()),
                   .median = median(differences),
                   .p = sign_flip_p(differences)});
    p.push_back(all.back().p);
  }
  const std::vector<double> adjusted = holm_adjusted(p);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].p_holm = adjusted[i];
  return all;
}

}  // namespace

Expected<EvaluatedRun> read_run_identity(const fs::path& run) {
  const fs::path manifest = run / "run.yaml";
  const Expected<std::string> text = read_file(manifest);
  if (!text) return text.error();
  Expected<RunIdentity> identity = parse_yaml<RunIdentity>(*text, manifest.string(), identity_of);
  if (!identity) return identity.error();
  return EvaluatedRun{.run = run.string(),
                      .recording = std::move(identity->recording),
                      .settings = std::move(identity->settings)};
}

Expected<void> add_evaluation(const std::string& report, EvaluatedRun& run) {
  try {
    const auto json = nlohmann::ordered_json::parse(report);
    run.settings["compared_with"] = json.at("reference_kind").get<std::string>();
    for (const auto& metric : json.at("headline")) {
      run.metrics.push_back({metric.at("name").get<std::string>(),
                             metric.at("unit").get<std::string>(),
                             metric.at("value").get<double>()});
    }
  } catch (const nlohmann::json::exception& failure) {
    return run_error(run, std::string("its report can't be read: ") + failure.what(),
                     "evaluate the run again");
  }
  return {};
}

Expected<RunComparison> compare_runs(std::vector<EvaluatedRun> runs) {
  RunComparison comparison{.runs = std::move(runs)};
  const std::set<std::string> keys = varied_keys(comparison.runs);
  for (const EvaluatedRun& run : comparison.runs) {
    const std::string name = setting_name(run, keys);
    const auto found = std::ranges::find(comparison.settings, name);
    comparison.setting_of_run.push_back(
        static_cast<std::size_t>(found - comparison.settings.begin()));
    if (found == comparison.settings.end()) comparison.settings.push_back(name);
  }
  if (auto error = check_runs(comparison)) return *error;
  for (std::size_t to = 1; to < comparison.settings.size(); ++to) {
    for (PairedDifference& difference : paired_differences(comparison, to))
      comparison.differences.push_back(std::move(difference));
  }
  return comparison;
}

}  // namespace pcavr
