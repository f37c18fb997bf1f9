// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/pipeline/calibrate_objects.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "pipeline/checks/segmented_force.hpp"

namespace pcavr {
namespace {

/// [m] As the recording format's example has it, where a recording does not state it.
constexpr double kUsualTipRadius = 0.01;
/// A touch is not taken from less than this [N], nor from less than this share of the largest
/// usual force: sensors drift, and a tip that leaves is pulled along.
constexpr double kMinForce = 0.5, kMinForceShare = 0.15;
constexpr double kUsualLargest = 0.95;  ///< the quantile of the force that counts as the largest
/// [s] From one point to the next, and between two contacts: a shorter release is a bounce.
constexpr double kPointInterval = 0.05, kReleaseTime = 0.2;
/// Fewer points of a contact are a knock, which may be of anything.
constexpr std::size_t kMinPointsOfContact = 2;

/// [N] The force's size, without spikes and the sensor's bias.
std::vector<double> force_sizes(const Recording& recording) {
  const SegmentedForce segmented = segment_force(recording);
  // Fewer than 20 samples have no segmentation.
  const auto& force =
      segmented.found.force_base.empty() ? segmented.force : segmented.found.force_base;
  std::vector<double> sizes;
  for (const Eigen::Vector3d& one : force) sizes.push_back(one.norm());
  return sizes;
}

/// [N] The force from which on the tip touches.
double touching_force(std::vector<double> sizes, const ObjectsInput& input) {
  if (input.min_force > 0.0) return input.min_force;
  const auto at = static_cast<std::size_t>(kUsualLargest * static_cast<double>(sizes.size() - 1));
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(at), sizes.end());
  return std::max(kMinForce, kMinForceShare * sizes[at]);
}

/// Stamps of each contact, as seconds from the recording's start.
std::vector<std::vector<double>> contact_times(const Recording& recording,
                                               const ObjectsInput& input) {
  const std::vector<double> sizes = force_sizes(recording);
  const double limit = touching_force(sizes, input);
  const Stamp start = start_of(recording);
  std::vector<std::vector<double>> contacts;
  double last_touch = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (sizes[i] < limit) continue;
    const double t = to_seconds(recording.wrench[i].stamp - start);
    if (t - last_touch > kReleaseTime) contacts.emplace_back();
    last_touch = t;
    std::vector<double>& times = contacts.back();
    if (times.empty() || t - times.back() >= kPointInterval) times.push_back(t);
  }
  std::erase_if(contacts, [](const auto& times) { return times.size() < kMinPointsOfContact; });
  return contacts;
}

/// A movable body that is tracked.
struct TrackedBody {
  TouchedObject object = {};
  std::vector<TrackedPose> tracked = {};

  [[nodiscard]] bool covers(double t) const {
    return t >= tracked.front().t && t <= tracked.back().t;
  }
};

Expected<std::vector<TrackedBody>> tracked_bodies(const Recording& recording,
                                                  const ObjectsInput& input,
                                                  std::vector<std::string>& notes) {
  std::vector<TrackedBody> bodies;
  const auto folder = tracked_folder_of(recording, std::nullopt);
  for (const ObjectEntry& entry : recording.manifest.objects) {
    if (!folder || entry.mesh.empty() || !entry.is_movable) continue;
    Expected<TrackedFile> tracked = read_tracked_poses(
        *folder, entry.name, {.zero = start_of(recording), .skip_bad = input.skip_bad});
    if (!tracked) return tracked.error();
    if (tracked->note) notes.push_back(*tracked->note);
    if (tracked->poses.empty()) continue;
    Expected<CadModel> model =
        read_cad_model(recording.folder / entry.mesh, entry.name, {}, entry.mesh_unit);
    if (!model) return model.error();
    TrackedBody body{
        .object = {.name = entry.name,
                   .model = *std::move(model),
                   .mesh_unit = entry.mesh_unit,
                   .T_tracked_object = entry.T_tracked_object,
                   .tip_radius = recording.manifest.tool_radius.value_or(kUsualTipRadius)},
        .tracked = std::move(tracked->poses)};
    body.object.up_tracked =
        body.tracked.front().T_base_object.rotation().conjugate() * Eigen::Vector3d::UnitZ();
    bodies.push_back(std::move(body));
  }
  if (bodies.empty()) {
    return Error{.message = "no movable object has a mesh and tracked poses",
                 .file = input.recording.string(),
                 .hint = "the tracker's poses are read from tracked/objects/NAME/tracked.txt"};
  }
  return bodies;
}

std::vector<ContactPoint> points_of(const std::vector<double>& times, const Trajectory& tool,
                                    Stamp start, const TrackedBody& body) {
  std::vector<ContactPoint> points;
  for (const double t : times) {
    if (!body.covers(t)) continue;
    const std::optional<Pose> T_base_tool = tool.at(start + duration_from_seconds(t));
    if (!T_base_tool) continue;
    points.push_back(
        {.contact = body.object.contacts,
         .p_tracked = pose_at(body.tracked, t).inverse() * T_base_tool->translation()});
  }
  return points;
}

/// [m] Median distance of the points from the stated surface.
double distance_to(const std::vector<ContactPoint>& points, const TouchedObject& object,
                   const BodySurface& surface) {
  std::vector<double> gaps;
  for (const ContactPoint& point : points) {
    gaps.push_back(
        std::abs(surface.touch(object.T_tracked_object, point.p_tracked, object.tip_radius).gap));
  }
  return points.empty() ? std::numeric_limits<double>::infinity() : median(std::move(gaps));
}

std::optional<Error> missing_stream(const Recording& recording, const ObjectsInput& input) {
  if (!recording.tool.empty() && !recording.wrench.empty()) return std::nullopt;
  return Error{.message = recording.tool.empty() ? "has no tool.csv" : "has no wrench.csv",
               .file = input.recording.string(),
               .hint = "objects are found by the points at which the tip pushes them"};
}

}  // namespace

Expected<TouchedObjects> read_touched_objects(const ObjectsInput& input, const Observer& observer) {
  ReadOptions reading;
  reading.skip_bad = input.skip_bad;
  const Expected<Recording> recording = read_recording(input.recording, reading);
  if (!recording) return recording.error();
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  if (const auto error = missing_stream(*recording, input)) return *error;
  TouchedObjects found;
  Expected<std::vector<TrackedBody>> bodies = tracked_bodies(*recording, input, found.notes);
  if (!bodies) return bodies.error();
  std::vector<BodySurface> surfaces;
  for (const TrackedBody& body : *bodies) surfaces.emplace_back(body.object.model);
  std::size_t elsewhere = 0;
  for (const std::vector<double>& times : contact_times(*recording, input)) {
    double nearest = std::numeric_limits<double>::infinity();
    std::size_t touched = 0;
    std::vector<ContactPoint> points;
    for (std::size_t i = 0; i < bodies->size(); ++i) {
      std::vector<ContactPoint> own =
          points_of(times, recording->tool, start_of(*recording), (*bodies)[i]);
      const double distance = distance_to(own, (*bodies)[i].object, surfaces[i]);
      if (!(distance < nearest)) continue;
      nearest = distance;
      touched = i;
      points = std::move(own);
    }
    elsewhere += std::isfinite(nearest) ? 0 : 1;
    if (!std::isfinite(nearest)) continue;
    TouchedObject& object = (*bodies)[touched].object;
    ++object.contacts;
    object.points.insert(object.points.end(), points.begin(), points.end());
  }
  if (elsewhere > 0) {
    found.notes.push_back(
        fmt::format("{} contacts are farther than 20 cm from all objects: not used", elsewhere));
  }
  const bool is_any_touched = std::any_of(
      bodies->begin(), bodies->end(), [](const auto& body) { return body.object.contacts > 0; });
  for (TrackedBody& body : *bodies) {
    if (is_any_touched && body.object.contacts == 0) {
      found.notes.push_back(body.object.name + " is not touched: it stays as stated");
      continue;
    }
    found.objects.push_back(std::move(body.object));
  }
  return found;
}

}  // namespace pcavr
