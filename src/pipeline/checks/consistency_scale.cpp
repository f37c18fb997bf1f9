// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "pcavr/base/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Tags closer together than this do not determine a scale [m].
constexpr double kMinTagDistance = 0.05;

double log_factor(const ScaleRatio& ratio) { return std::log(ratio.by_depth / ratio.stated); }

bool is_off(const ScaleRatio& ratio, double log_expected) {
  return std::abs(log_factor(ratio) - log_expected) > ratio.tolerance;
}

double edge_length(const TagMeasurement& tag) {
  double squares = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    squares += (tag.corners_camera[(i + 1) % 4] - tag.corners_camera[i]).squaredNorm();
  }
  return std::sqrt(0.25 * squares);
}

bool share_a_body(const MarkerEntry& a, const MarkerEntry& b) {
  return a.role == b.role && a.object == b.object;
}

/// The hypothesis that one input is wrong, and its effect on the ratios.
struct FaultHypothesis {
  std::string place;
  std::string check;  ///< what to check: "the printed size"
  /// Whether the ratio depends on this input; the others must be 1.
  std::function<bool(const ScaleRatio&)> is_affected;
  /// All affected ratios are off by one common factor; else each by its own.
  bool is_common = true;
};

/// The logarithm of the affected ratios' common factor.
double common_log(const FaultHypothesis& hypothesis, const std::vector<ScaleRatio>& ratios) {
  std::vector<double> logs;
  for (const ScaleRatio& ratio : ratios) {
    if (hypothesis.is_affected(ratio)) logs.push_back(log_factor(ratio));
  }
  return median(std::move(logs));
}

/// The ratios that remain unexplained under a hypothesis.
struct Explanation {
  std::vector<bool> off;  ///< by ratio: still unexplained
  std::size_t count = 0;  ///< of these
  std::size_t broken =
      0;  ///< of these, consistent without the hypothesis, which so contradicts them
};

Explanation explain(const FaultHypothesis& hypothesis, const std::vector<ScaleRatio>& ratios) {
  const double common = common_log(hypothesis, ratios);
  Explanation explanation;
  for (const ScaleRatio& ratio : ratios) {
    const bool was_off = is_off(ratio, 0.0);
    bool off = was_off;
    if (hypothesis.is_affected(ratio)) off = hypothesis.is_common && is_off(ratio, common);
    explanation.off.push_back(off);
    explanation.count += off ? 1 : 0;
    explanation.broken += off && !was_off ? 1 : 0;
  }
  return explanation;
}

struct Diagnosis {
  std::size_t hypothesis = 0;
  Explanation explanation;
  std::string alternatives = {};  ///< equally good explanations: " or camera.depth_scale"
};

/// The hypothesis that explains most ratios, the first among equals; nothing where none explains
/// any.
std::optional<Diagnosis> diagnose(const std::vector<FaultHypothesis>& hypotheses,
                                  const std::vector<ScaleRatio>& ratios) {
  const auto before = static_cast<std::size_t>(std::count_if(
      ratios.begin(), ratios.end(), [](const ScaleRatio& ratio) { return is_off(ratio, 0.0); }));
  std::optional<Diagnosis> diagnosis;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    Explanation explanation = explain(hypotheses[i], ratios);
    if (explanation.count >= before) continue;
    if (!diagnosis || explanation.count < diagnosis->explanation.count) {
      diagnosis = Diagnosis{i, std::move(explanation)};
    } else if (explanation.count == diagnosis->explanation.count && explanation.broken == 0) {
      diagnosis->alternatives += " or " + hypotheses[i].check;
    }
  }
  return diagnosis;
}

/// A wrong lens distorts a tag's size, too.
FaultHypothesis wrong_size(const Manifest& manifest, std::size_t marker) {
  const bool is_distorted = manifest.camera && manifest.camera->has_distortion();
  return {.place = key_of_marker(marker) + ".size",
          .check = std::string("the printed size") + (is_distorted ? ", camera.distortion" : ""),
          .is_affected = [marker](const ScaleRatio& ratio) {
            return ratio.kind == ScaleRatio::Kind::tag_size && ratio.first == marker;
          }};
}

FaultHypothesis wrong_pose(const Manifest& manifest, std::size_t marker) {
  return {.place = key_of_marker(marker) + ".pose",
          .check = "where " + manifest.markers[marker].id.to_string() + " is",
          .is_affected =
              [marker](const ScaleRatio& ratio) {
                return ratio.kind == ScaleRatio::Kind::tag_distance &&
                       (ratio.first == marker || ratio.second == marker);
              },
          .is_common = false};
}

/// All hypotheses, in the order in which a finding names them.
std::vector<FaultHypothesis> hypotheses_of(const Manifest& manifest,
                                           const std::vector<ScaleRatio>& ratios) {
  std::vector<FaultHypothesis> hypotheses;
  std::set<std::size_t> placed;
  bool has_motion = false;
  for (const ScaleRatio& ratio : ratios) {
    if (ratio.kind == ScaleRatio::Kind::tag_size) {
      hypotheses.push_back(wrong_size(manifest, ratio.first));
    }
    if (ratio.kind == ScaleRatio::Kind::tag_distance) placed.insert({ratio.first, ratio.second});
    has_motion = has_motion || ratio.kind == ScaleRatio::Kind::camera_motion;
  }
  for (const std::size_t marker : placed) hypotheses.push_back(wrong_pose(manifest, marker));
  if (!placed.empty()) {
    hypotheses.push_back({.place = "markers",
                          .check = "the unit of the tags' poses",
                          .is_affected = [](const ScaleRatio& ratio) {
                            return ratio.kind == ScaleRatio::Kind::tag_distance;
                          }});
  }
  if (has_motion && placed.empty() && hypotheses.empty()) {
    // The shape of tags, where there are any, checks the focal lengths.
    hypotheses.push_back({.place = "camera.fx, camera.fy",
                          .check = "fx and fy",
                          .is_affected = [](const ScaleRatio&) { return true; }});
  }
  if (has_motion) {
    hypotheses.push_back({.place = "groundtruth.txt",
                          .check = "the unit of its positions (metres)",
                          .is_affected = [](const ScaleRatio& ratio) {
                            return ratio.kind == ScaleRatio::Kind::camera_motion;
                          }});
  }
  hypotheses.push_back({.place = "camera.depth_scale",
                        .check = "camera.depth_scale",
                        .is_affected = [](const ScaleRatio&) { return true; }});
  return hypotheses;
}

/// The message of a ratio.
std::string statement(const Manifest& manifest, const ScaleRatio& ratio) {
  const auto tag = [&](std::size_t marker) { return manifest.markers[marker].id.to_string(); };
  const std::string by_depth = measured(ratio.by_depth);
  switch (ratio.kind) {
    case ScaleRatio::Kind::tag_size:
      return tag(ratio.first) + " is given as " + metres(ratio.stated) +
             " across, but depth measures " + by_depth;
    case ScaleRatio::Kind::tag_distance:
      return tag(ratio.first) + " and " + tag(ratio.second) + " are given " + metres(ratio.stated) +
             " apart, but depth measures " + by_depth;
    case ScaleRatio::Kind::camera_motion:
      break;
  }
  return "between " + std::to_string(ratio.frames) + " pairs of frames the camera moved by " +
         metres(ratio.stated) + " (median), but by tracking the depth it moved by " + by_depth;
}

/// `explained` are the ratios that the hypothesis explains; not empty.
ConsistencyFinding finding_of(const Manifest& manifest, const FaultHypothesis& hypothesis,
                              const std::vector<ScaleRatio>& explained,
                              const ConsistencyOptions& options) {
  const ScaleRatio& worst = *std::max_element(
      explained.begin(), explained.end(), [](const ScaleRatio& a, const ScaleRatio& b) {
        return std::abs(log_factor(a)) < std::abs(log_factor(b));
      });
  ConsistencyFinding finding;
  const bool is_file = hypothesis.place == "groundtruth.txt";
  finding.file = is_file ? hypothesis.place : "recording.yaml";
  finding.place = is_file ? "" : hypothesis.place;
  finding.factor = std::exp(std::abs(log_factor(worst)));
  finding.frames = worst.frames;
  finding.severity = finding.factor >= options.contradiction_factor ? FindingSeverity::contradiction
                                                                    : FindingSeverity::warning;
  finding.message =
      statement(manifest, worst) + " (" + factor_over_frames(finding.factor, finding.frames) + ")";
  finding.hint = "check " + hypothesis.check;
  return finding;
}

/// The message for a wrong depth scale states the scale that would fit.
void describe_depth_scale(const Manifest& manifest, const std::vector<ScaleRatio>& explained,
                          double log_common, ConsistencyFinding& finding) {
  finding.factor = std::exp(std::abs(log_common));
  finding.message = number(manifest.depth_scale) + " units per metre, but " +
                    std::to_string(explained.size()) + " other inputs indicate about " +
                    std::to_string(std::llround(manifest.depth_scale * std::exp(log_common))) +
                    ": " + finding.message;
}

/// The whole scene depends on the base tags: where few frames measure any, these have to do.
std::size_t frames_with_base(const Manifest& manifest, const std::vector<TagMeasurement>& tags) {
  std::set<std::size_t> frames;
  for (const TagMeasurement& tag : tags) {
    if (manifest.markers[tag.marker].role == MarkerRole::base) frames.insert(tag.frame);
  }
  return frames.size();
}

/// Of few lengths the one that contradicts the stated one least: another may be a misread tag's.
double nearest(const std::vector<double>& lengths, double stated) {
  return *std::min_element(lengths.begin(), lengths.end(), [stated](double a, double b) {
    return std::abs(std::log(a / stated)) < std::abs(std::log(b / stated));
  });
}

}  // namespace

std::vector<ScaleRatio> tag_ratios(const Manifest& manifest,
                                   const std::vector<TagMeasurement>& tags, std::size_t min_frames,
                                   const ConsistencyOptions& options) {
  std::map<std::size_t, std::vector<double>> sizes;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> distances;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    sizes[tags[i].marker].push_back(edge_length(tags[i]));
    for (std::size_t j = i + 1; j < tags.size() && tags[j].frame == tags[i].frame; ++j) {
      const auto [first, second] = std::minmax(tags[i].marker, tags[j].marker);
      if (!share_a_body(manifest.markers[first], manifest.markers[second])) continue;
      distances[{first, second}].push_back(
          (tags[i].centre_camera() - tags[j].centre_camera()).norm());
    }
  }
  std::vector<ScaleRatio> ratios;
  const std::size_t min_base_frames = std::min(min_frames, frames_with_base(manifest, tags));
  for (const auto& [marker, lengths] : sizes) {
    const MarkerEntry& entry = manifest.markers[marker];
    const std::size_t needed = entry.role == MarkerRole::base ? min_base_frames : min_frames;
    if (lengths.size() < needed) continue;
    ratios.push_back(
        {.kind = ScaleRatio::Kind::tag_size,
         .first = marker,
         .stated = entry.size,
         .by_depth = lengths.size() < min_frames ? nearest(lengths, entry.size) : median(lengths),
         .tolerance = std::log(options.warning_factor),
         .frames = lengths.size()});
  }
  for (const auto& [pair, lengths] : distances) {
    const double stated = (manifest.markers[pair.first].T_parent_marker.translation() -
                           manifest.markers[pair.second].T_parent_marker.translation())
                              .norm();
    if (lengths.size() < min_frames || stated < kMinTagDistance) continue;
    ratios.push_back(
        {.kind = ScaleRatio::Kind::tag_distance,
         .first = pair.first,
         .second = pair.second,
         .stated = stated,
         .by_depth = median(lengths),
         .tolerance = std::log(options.warning_factor) + options.tag_distance_error / stated,
         .frames = lengths.size()});
  }
  return ratios;
}

std::vector<ConsistencyFinding> check_scales(const Manifest& manifest,
                                             const std::vector<ScaleRatio>& ratios,
                                             const ConsistencyOptions& options) {
  std::vector<ConsistencyFinding> findings;
  std::vector<ScaleRatio> unexplained = ratios;
  // Greedy: each pass removes the ratios that the best hypothesis explains.
  while (true) {
    const std::vector<FaultHypothesis> hypotheses = hypotheses_of(manifest, unexplained);
    const std::optional<Diagnosis> diagnosis = diagnose(hypotheses, unexplained);
    if (!diagnosis) return findings;
    const FaultHypothesis& hypothesis = hypotheses[diagnosis->hypothesis];
    std::vector<ScaleRatio> explained;
    std::vector<ScaleRatio> rest;
    for (std::size_t i = 0; i < unexplained.size(); ++i) {
      const bool is_explained = is_off(unexplained[i], 0.0) && !diagnosis->explanation.off[i];
      (is_explained ? explained : rest).push_back(unexplained[i]);
    }
    ConsistencyFinding finding = finding_of(manifest, hypothesis, explained, options);
    if (hypothesis.place == "camera.depth_scale") {
      describe_depth_scale(manifest, explained, common_log(hypothesis, unexplained), finding);
    }
    finding.hint += diagnosis->alternatives;
    findings.push_back(std::move(finding));
    unexplained = std::move(rest);
  }
}

}  // namespace pcavr
