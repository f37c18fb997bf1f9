// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/doctor.hpp"

#include "diagnosis_rows.hpp"

namespace pcavr {
namespace {

void append(std::vector<DiagnosisRow>& rows, std::vector<DiagnosisRow> more) {
  std::move(more.begin(), more.end(), std::back_inserter(rows));
}

/// "base", or the object that carries the tag.
std::string carrier_of(const Manifest& manifest, const MarkerId& id) {
  for (const MarkerEntry& marker : manifest.markers) {
    if (marker.id == id) return marker.role == MarkerRole::base ? "base" : marker.object;
  }
  return "";
}

DiagnosisRow tag_row(const Manifest& manifest, const SearchedTag& tag) {
  const std::string what = "tag " + tag.id.to_string();
  const std::string seen = fmt::format("in {} of {} sampled frames", tag.seen, tag.frames);
  if (!tag.is_declared) {
    return unchecked(what, seen +
                               ", but not declared: not used; if it is on base or on an object, "
                               "add it to markers");
  }
  const std::string carrier = carrier_of(manifest, tag.id);
  if (tag.seen > 0) return agreement(what, carrier + ": " + seen);
  return unchecked(
      what, fmt::format("{}: declared, but in none of {} sampled frames", carrier, tag.frames));
}

void add_images(const Recording& recording, const InputReport& report,
                std::vector<DiagnosisRow>& rows) {
  for (const SearchedTag& tag : report.tags) rows.push_back(tag_row(recording.manifest, tag));
  const std::size_t sampled = report.tags.empty() ? 0 : report.tags.front().frames;
  if (sampled > 0 && sampled < recording.frames.size()) {
    rows.push_back(unchecked("images", fmt::format("{} of {} frames were decoded; pcavr inspect "
                                                   "decodes all",
                                                   sampled, recording.frames.size())));
  }
  if (recording.unpaired_color + recording.unpaired_depth > 0) {
    rows.push_back(
        unchecked("images", fmt::format("{} colour and {} depth images have no partner "
                                        "close enough in time: not used",
                                        recording.unpaired_color, recording.unpaired_depth)));
  }
}

void add_report(const Recording& recording, const InputReport& report,
                std::vector<DiagnosisRow>& rows) {
  for (const ConsistencyFinding& finding : report.findings) {
    rows.push_back(disagreement(finding.input(), finding.message, finding.hint));
  }
  add_images(recording, report, rows);
  for (const InputComparison& one : report.comparisons) {
    // These have rows of their own.
    const bool has_row = (one.what == "tags in view" && !report.tags.empty()) ||
                         (one.what == "groundtruth.txt" && recording.groundtruth.empty());
    if (has_row) continue;
    rows.push_back(one.is_compared() ? agreement(one.what, one.figure)
                                     : unchecked(one.what, one.reason));
  }
}

/// The same error may be found by several checks.
void remove_repeated(std::vector<DiagnosisRow>& rows) {
  std::vector<DiagnosisRow> kept;
  for (DiagnosisRow& row : rows) {
    const bool is_known = std::any_of(kept.begin(), kept.end(), [&](const DiagnosisRow& other) {
      return other.verdict == row.verdict && other.what == row.what && other.figure == row.figure;
    });
    if (!is_known) kept.push_back(std::move(row));
  }
  rows = std::move(kept);
}

bool has_base(const Recording& recording) {
  return !recording.groundtruth.empty() ||
         std::any_of(recording.manifest.markers.begin(), recording.manifest.markers.end(),
                     [](const MarkerEntry& marker) { return marker.role == MarkerRole::base; });
}

/// The commands that the recording has inputs for; `is_refused`: they would refuse it.
std::string next_command(const Recording& recording, bool is_refused) {
  const std::string folder = "'" + recording.folder.string() + "'";
  if (is_refused) return "correct what disagrees, then pcavr doctor " + folder;
  const bool is_identifiable =
      !recording.tool.empty() && !recording.wrench.empty() && !recording.manifest.objects.empty();
  if (recording.manifest.camera && !recording.frames.empty() && has_base(recording)) {
    std::string next = "pcavr build " + folder + " -o SCENE";
    if (is_identifiable) {
      next += "; pcavr identify friction " + folder + " --scene SCENE -o PARAMETERS";
    }
    return next;
  }
  if (is_identifiable) return "pcavr identify friction " + folder + " -o PARAMETERS";
  if (!recording.joints.empty() && recording.manifest.robot) {
    return fmt::format("pcavr identify robot '{}' --robot '{}' -o REPORT",
                       (recording.folder / "joints.csv").string(),
                       (recording.folder / recording.manifest.robot->urdf).string());
  }
  return "add what is not checked to the folder, then pcavr doctor " + folder;
}

}  // namespace

bool DiagnosisReport::has_disagreement() const {
  return std::any_of(rows.begin(), rows.end(), [](const DiagnosisRow& row) {
    return row.verdict == DiagnosisVerdict::disagrees;
  });
}

DiagnosisReport diagnose_unreadable(const Error& error) {
  DiagnosisReport report;
  report.rows = {row_of(error), unchecked("streams, images, tags, force and bodies",
                                          "the recording can't be read: its first error is above")};
  report.next = "correct what disagrees, then pcavr doctor once more";
  return report;
}

void add_unreadable(const Error& error, DiagnosisReport& report) {
  report.rows.insert(report.rows.begin(), row_of(error));
  report.rows.push_back(unchecked("rows and images that can't be read",
                                  "left out of all checks here; build and identify refuse them "
                                  "without --skip-bad"));
  report.next = "correct what disagrees, or give --skip-bad to the next command; " + report.next;
}

DiagnosisReport diagnose_recording(const Recording& recording, const PerceptionOptions& options) {
  DiagnosisReport report;
  const Expected<InputReport> inputs = inspect_inputs(recording, options, FamilySearch::always);
  std::vector<ConsistencyFinding> findings;
  append(report.rows, stream_rows(recording));
  if (inputs) {
    add_report(recording, *inputs, report.rows);
    findings = inputs->findings;
  } else {
    report.rows.push_back(row_of(inputs.error()));
    report.rows.push_back(
        unchecked("images, contacts and force", "an input of these checks can't be read"));
  }
  append(report.rows, arm_rows(recording));
  append(report.rows, body_rows(recording, options, findings));
  remove_repeated(report.rows);
  report.next = next_command(recording, !inputs || has_contradiction(findings));
  return report;
}

}  // namespace pcavr
