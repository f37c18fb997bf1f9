// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tracked_start.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/pipeline/replay.hpp"

namespace pcavr {
namespace {

/// A track that begins nearer than this to the stated pose is there [m]: a pose that was measured
/// by hand, or an object that was nudged.
constexpr double kMaxOffset = 0.05;
/// Another interpretation has to put the tracks nearer than this [m]: it is more than chance.
constexpr double kMaxExplainedOffset = 0.02;

using Interpretation = Pose (*)(const Pose&);

Pose with_position(const Pose& pose, double x, double y, double z) {
  return Pose(pose.rotation(), {x, y, z});
}

struct NamedInterpretation {
  const char* what;
  const char* hint;
  Interpretation apply;
};

constexpr NamedInterpretation kInterpretations[] = {
    {"with x mirrored", "check the axes of the tracked poses: base is right-handed",
     [](const Pose& T) {
       const Eigen::Vector3d& p = T.translation();
       return with_position(T, -p.x(), p.y(), p.z());
     }},
    {"with y mirrored", "check the axes of the tracked poses: base is right-handed",
     [](const Pose& T) {
       const Eigen::Vector3d& p = T.translation();
       return with_position(T, p.x(), -p.y(), p.z());
     }},
    {"with z mirrored", "check the axes of the tracked poses: base is right-handed",
     [](const Pose& T) {
       const Eigen::Vector3d& p = T.translation();
       return with_position(T, p.x(), p.y(), -p.z());
     }},
    {"with x and y exchanged", "check the columns of the tracked poses: t,x,y,z,qx,qy,qz,qw",
     [](const Pose& T) {
       const Eigen::Vector3d& p = T.translation();
       return with_position(T, p.y(), p.x(), p.z());
     }},
    {"read as millimetres", "write the tracked positions in metres",
     [](const Pose& T) { return Pose(T.rotation(), 1e-3 * T.translation()); }},
    {"inverted", "write the object's pose in base, not base's in the object",
     [](const Pose& T) { return T.inverse(); }}};

double offset_of(const TrackedStart& start) {
  return translation_distance(start.T_base_object_stated, start.T_base_object_tracked);
}

ConsistencyFinding contradiction(const TrackedStart& start, std::string message, std::string hint) {
  return {.severity = FindingSeverity::contradiction,
          .file = start.file,
          .message = std::move(message),
          .hint = std::move(hint)};
}

/// Two tracks, each of which begins where the other object is.
std::optional<ConsistencyFinding> find_exchange(const std::vector<TrackedStart>& elsewhere) {
  for (std::size_t i = 0; i < elsewhere.size(); ++i) {
    for (std::size_t j = i + 1; j < elsewhere.size(); ++j) {
      const TrackedStart& a = elsewhere[i];
      const TrackedStart& b = elsewhere[j];
      const double a_at_b = translation_distance(a.T_base_object_tracked, b.T_base_object_stated);
      const double b_at_a = translation_distance(b.T_base_object_tracked, a.T_base_object_stated);
      if (std::max(a_at_b, b_at_a) > kMaxOffset) continue;
      return contradiction(
          a,
          fmt::format("the track of {} begins {:.3f} m from its pose and {:.3f} m from that of {}, "
                      "whose track begins {:.3f} m from the pose of {}: they are exchanged",
                      a.name, offset_of(a), a_at_b, b.name, b_at_a, a.name),
          "exchange the tracks: check the names of the tracked bodies");
    }
  }
  return std::nullopt;
}

std::optional<ConsistencyFinding> find_interpretation(const std::vector<TrackedStart>& starts,
                                                      const TrackedStart& worst) {
  for (const NamedInterpretation& one : kInterpretations) {
    double max_offset = 0.0;
    for (const TrackedStart& start : starts) {
      max_offset = std::max(
          max_offset,
          translation_distance(start.T_base_object_stated, one.apply(start.T_base_object_tracked)));
    }
    if (max_offset > kMaxExplainedOffset) continue;
    return contradiction(
        worst,
        fmt::format("the track of {} begins {:.3f} m from its pose; {}, all tracks begin within "
                    "{:.3f} m of the objects' poses",
                    worst.name, offset_of(worst), one.what, max_offset),
        one.hint);
  }
  return std::nullopt;
}

}  // namespace

std::vector<ConsistencyFinding> check_tracked_starts(const std::vector<TrackedStart>& starts) {
  std::vector<TrackedStart> elsewhere;
  for (const TrackedStart& start : starts) {
    if (offset_of(start) > kMaxOffset) elsewhere.push_back(start);
  }
  if (elsewhere.empty()) return {};
  if (const auto exchange = find_exchange(elsewhere)) return {*exchange};
  const auto worst =
      std::max_element(elsewhere.begin(), elsewhere.end(),
                       [](const auto& a, const auto& b) { return offset_of(a) < offset_of(b); });
  if (const auto found = find_interpretation(starts, *worst)) return {*found};
  std::vector<ConsistencyFinding> findings;
  for (const TrackedStart& start : elsewhere) {
    findings.push_back({.file = start.file,
                        .message = fmt::format("the track of {} begins {:.3f} m from its pose",
                                               start.name, offset_of(start)),
                        .hint = "check the track's frame and object, or where the object was when "
                                "the recording began"});
  }
  return findings;
}

Expected<void> accept_tracked_starts(const std::vector<TrackedStart>& starts,
                                     const Observer& observer) {
  for (const ConsistencyFinding& finding : check_tracked_starts(starts)) {
    if (finding.severity == FindingSeverity::contradiction) {
      return Error{.message = finding.message, .file = finding.file, .hint = finding.hint};
    }
    observer.on_warning(finding.to_string());
  }
  return {};
}

Expected<std::vector<ConsistencyFinding>> check_own_tracks(
    const Recording& recording, const std::vector<DeclaredBody>& bodies) {
  const auto folder = tracked_folder_of(recording, {});
  if (!folder) return std::vector<ConsistencyFinding>();
  std::vector<TrackedStart> starts;
  for (const DeclaredBody& body : bodies) {
    const std::string& name = body.entry.name;
    if (!body.entry.T_base_object) continue;
    const Expected<TrackedFile> tracked =
        read_tracked_poses(*folder, name, {.T_tracked_object = body.entry.T_tracked_object});
    if (!tracked) return tracked.error();
    if (tracked->poses.empty()) continue;
    starts.push_back({name, "tracked/objects/" + name + "/tracked.txt", *body.entry.T_base_object,
                      tracked->poses.front().T_base_object});
  }
  return check_tracked_starts(starts);
}

}  // namespace pcavr
