// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "pcavr/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// The distance of two tags that depth sees is good to this [m]: twice a sensor's noise at 1.5 m,
/// and what paper on a table lies off.
constexpr double kDistanceError = 0.012;
/// Tags nearer to each other than this say nothing about a scale [m].
constexpr double kMinTagDistance = 0.05;

double log_factor(const ScaleRatio& ratio) { return std::log(ratio.by_depth / ratio.stated); }

bool is_off(const ScaleRatio& ratio, double log_expected) {
  return std::abs(log_factor(ratio) - log_expected) > ratio.tolerance;
}

double edge_length(const TagSight& sight) {
  double squares = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    squares += (sight.corners_camera[(i + 1) % 4] - sight.corners_camera[i]).squaredNorm();
  }
  return std::sqrt(0.25 * squares);
}

bool share_a_body(const MarkerEntry& a, const MarkerEntry& b) {
  return a.role == b.role && a.object == b.object;
}

/// An input that may be wrong, and what it then does to the ratios.
struct Suspect {
  std::string place;
  std::string check;  ///< what to check: "the printed size"
  /// Whether the ratio is at this input's mercy; others keep the value that they should have.
  std::function<bool(const ScaleRatio&)> is_affected;
  /// All that it affects are off by one factor; else each may be off by its own.
  bool is_common = true;
};

/// The ratios' common logarithm where the suspect is wrong.
double common_log(const Suspect& suspect, const std::vector<ScaleRatio>& ratios) {
  std::vector<double> logs;
  for (const ScaleRatio& ratio : ratios) {
    if (suspect.is_affected(ratio)) logs.push_back(log_factor(ratio));
  }
  return median(std::move(logs));
}

/// What is left of the ratios' disagreement where one suspect is wrong.
struct Explanation {
  std::vector<bool> off;   ///< by ratio: still off
  std::size_t count = 0;   ///< of these
  std::size_t broken = 0;  ///< of these, in order otherwise: the suspect is not alone at fault
};

Explanation explain(const Suspect& suspect, const std::vector<ScaleRatio>& ratios) {
  const double common = common_log(suspect, ratios);
  Explanation explanation;
  for (const ScaleRatio& ratio : ratios) {
    const bool was_off = is_off(ratio, 0.0);
    bool off = was_off;
    if (suspect.is_affected(ratio)) off = suspect.is_common && is_off(ratio, common);
    explanation.off.push_back(off);
    explanation.count += off ? 1 : 0;
    explanation.broken += off && !was_off ? 1 : 0;
  }
  return explanation;
}

struct Verdict {
  std::size_t suspect = 0;
  Explanation explanation;
  std::string alternatives = {};  ///< what explains as much: " or camera.depth_scale"
};

/// The suspect that explains most, the first of those alike; nothing where none explains anything.
std::optional<Verdict> find_verdict(const std::vector<Suspect>& suspects,
                                    const std::vector<ScaleRatio>& ratios) {
  const auto before = static_cast<std::size_t>(std::count_if(
      ratios.begin(), ratios.end(), [](const ScaleRatio& ratio) { return is_off(ratio, 0.0); }));
  std::optional<Verdict> verdict;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    Explanation explanation = explain(suspects[i], ratios);
    if (explanation.count >= before) continue;
    if (!verdict || explanation.count < verdict->explanation.count) {
      verdict = Verdict{i, std::move(explanation)};
    } else if (explanation.count == verdict->explanation.count && explanation.broken == 0) {
      verdict->alternatives += " or " + suspects[i].check;
    }
  }
  return verdict;
}

Suspect size_suspect(std::size_t marker) {
  return {.place = key_of_marker(marker) + ".size",
          .check = "the printed size",
          .is_affected = [marker](const ScaleRatio& ratio) {
            return ratio.kind == ScaleRatio::Kind::tag_size && ratio.first == marker;
          }};
}

Suspect pose_suspect(const Manifest& manifest, std::size_t marker) {
  return {.place = key_of_marker(marker) + ".pose",
          .check = "where " + manifest.markers[marker].id.to_string() + " is",
          .is_affected =
              [marker](const ScaleRatio& ratio) {
                return ratio.kind == ScaleRatio::Kind::tag_distance &&
                       (ratio.first == marker || ratio.second == marker);
              },
          .is_common = false};
}

/// In the order in which a finding names them.
std::vector<Suspect> suspects_of(const Manifest& manifest, const std::vector<ScaleRatio>& ratios) {
  std::vector<Suspect> suspects;
  std::set<std::size_t> placed;
  bool has_motion = false;
  for (const ScaleRatio& ratio : ratios) {
    if (ratio.kind == ScaleRatio::Kind::tag_size) suspects.push_back(size_suspect(ratio.first));
    if (ratio.kind == ScaleRatio::Kind::tag_distance) placed.insert({ratio.first, ratio.second});
    has_motion = has_motion || ratio.kind == ScaleRatio::Kind::camera_motion;
  }
  for (const std::size_t marker : placed) suspects.push_back(pose_suspect(manifest, marker));
  if (!placed.empty()) {
    suspects.push_back({.place = "markers",
                        .check = "the unit of the tags' poses",
                        .is_affected = [](const ScaleRatio& ratio) {
                          return ratio.kind == ScaleRatio::Kind::tag_distance;
                        }});
  }
  if (has_motion && placed.empty() && suspects.empty()) {
    // Tags would show the focal lengths by their shape.
    suspects.push_back({.place = "camera.fx, camera.fy",
                        .check = "fx and fy",
                        .is_affected = [](const ScaleRatio&) { return true; }});
  }
  if (has_motion) {
    suspects.push_back({.place = "groundtruth.txt",
                        .check = "the unit of its positions (metres)",
                        .is_affected = [](const ScaleRatio& ratio) {
                          return ratio.kind == ScaleRatio::Kind::camera_motion;
                        }});
  }
  suspects.push_back({.place = "camera.depth_scale",
                      .check = "camera.depth_scale",
                      .is_affected = [](const ScaleRatio&) { return true; }});
  return suspects;
}

/// What a ratio says, in words.
std::string statement(const Manifest& manifest, const ScaleRatio& ratio) {
  const auto tag = [&](std::size_t marker) { return manifest.markers[marker].id.to_string(); };
  const std::string by_depth = measured(ratio.by_depth);
  switch (ratio.kind) {
    case ScaleRatio::Kind::tag_size:
      return tag(ratio.first) + " is given as " + metres(ratio.stated) +
             " across, but depth says it is " + by_depth;
    case ScaleRatio::Kind::tag_distance:
      return tag(ratio.first) + " and " + tag(ratio.second) + " are given " + metres(ratio.stated) +
             " apart, but depth says " + by_depth;
    case ScaleRatio::Kind::camera_motion:
      break;
  }
  return "between " + std::to_string(ratio.frames) + " pairs of frames the camera moved by " +
         metres(ratio.stated) + " (median), but tracking the depth says by " + by_depth;
}

/// `explained` are the ratios that were off and are no longer; not empty.
ConsistencyFinding finding_of(const Manifest& manifest, const Suspect& suspect,
                              const std::vector<ScaleRatio>& explained) {
  const ScaleRatio& worst = *std::max_element(
      explained.begin(), explained.end(), [](const ScaleRatio& a, const ScaleRatio& b) {
        return std::abs(log_factor(a)) < std::abs(log_factor(b));
      });
  ConsistencyFinding finding;
  const bool is_file = suspect.place == "groundtruth.txt";
  finding.file = is_file ? suspect.place : "recording.yaml";
  finding.place = is_file ? "" : suspect.place;
  finding.factor = std::exp(std::abs(log_factor(worst)));
  finding.frames = worst.frames;
  finding.severity = finding.factor >= kContradictionFactor ? FindingSeverity::contradiction
                                                            : FindingSeverity::warning;
  finding.message =
      statement(manifest, worst) + " (" + factor_over_frames(finding.factor, finding.frames) + ")";
  finding.hint = "check " + suspect.check;
  return finding;
}

/// With depth at fault, the message states the scale that would fit.
void describe_depth_scale(const Manifest& manifest, const std::vector<ScaleRatio>& explained,
                          double log_common, ConsistencyFinding& finding) {
  finding.factor = std::exp(std::abs(log_common));
  finding.message = number(manifest.depth_scale) + " units a metre, but " +
                    std::to_string(explained.size()) + " other inputs say about " +
                    std::to_string(std::llround(manifest.depth_scale * std::exp(log_common))) +
                    ": " + finding.message;
}

}  // namespace

std::vector<ScaleRatio> tag_ratios(const Manifest& manifest, const std::vector<TagSight>& sights,
                                   std::size_t min_frames) {
  std::map<std::size_t, std::vector<double>> sizes;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> distances;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    sizes[sights[i].marker].push_back(edge_length(sights[i]));
    for (std::size_t j = i + 1; j < sights.size() && sights[j].frame == sights[i].frame; ++j) {
      const auto [first, second] = std::minmax(sights[i].marker, sights[j].marker);
      if (!share_a_body(manifest.markers[first], manifest.markers[second])) continue;
      distances[{first, second}].push_back(
          (sights[i].centre_camera() - sights[j].centre_camera()).norm());
    }
  }
  std::vector<ScaleRatio> ratios;
  for (const auto& [marker, lengths] : sizes) {
    if (lengths.size() < min_frames) continue;
    ratios.push_back({.kind = ScaleRatio::Kind::tag_size,
                      .first = marker,
                      .stated = manifest.markers[marker].size,
                      .by_depth = median(lengths),
                      .tolerance = std::log(kWarningFactor),
                      .frames = lengths.size()});
  }
  for (const auto& [pair, lengths] : distances) {
    const double stated = (manifest.markers[pair.first].T_parent_marker.translation() -
                           manifest.markers[pair.second].T_parent_marker.translation())
                              .norm();
    if (lengths.size() < min_frames || stated < kMinTagDistance) continue;
    ratios.push_back({.kind = ScaleRatio::Kind::tag_distance,
                      .first = pair.first,
                      .second = pair.second,
                      .stated = stated,
                      .by_depth = median(lengths),
                      .tolerance = std::log(kWarningFactor) + kDistanceError / stated,
                      .frames = lengths.size()});
  }
  return ratios;
}

std::vector<ConsistencyFinding> check_scales(const Manifest& manifest,
                                             const std::vector<ScaleRatio>& ratios) {
  std::vector<ConsistencyFinding> findings;
  std::vector<ScaleRatio> open = ratios;
  while (true) {
    const std::vector<Suspect> suspects = suspects_of(manifest, open);
    const std::optional<Verdict> verdict = find_verdict(suspects, open);
    if (!verdict) return findings;
    const Suspect& suspect = suspects[verdict->suspect];
    std::vector<ScaleRatio> explained;
    std::vector<ScaleRatio> rest;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const bool is_explained = is_off(open[i], 0.0) && !verdict->explanation.off[i];
      (is_explained ? explained : rest).push_back(open[i]);
    }
    ConsistencyFinding finding = finding_of(manifest, suspect, explained);
    if (suspect.place == "camera.depth_scale") {
      describe_depth_scale(manifest, explained, common_log(suspect, open), finding);
    }
    finding.hint += verdict->alternatives;
    findings.push_back(std::move(finding));
    open = std::move(rest);
  }
}

}  // namespace pcavr
