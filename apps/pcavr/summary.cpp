// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

namespace pcavr::app {
namespace {

constexpr double kMillimetres = 1e3;
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string object_line(const SceneObject& object) {
  const std::string name = "  " + object.model.name;
  if (object.evidence == kNotSeen)
    return name + ": not found, not in the scene: " + object.reason + '\n';
  const Eigen::Vector3d& p = object.T_base_object.translation();
  const double moved = translation_distance(object.T_base_object_start, object.T_base_object);
  std::string line = name + fmt::format(": at {:.3f} {:.3f} {:.3f} m", p.x(), p.y(), p.z());
  if (object.position_std > 0.0) {
    line += fmt::format(" (+-{:.1f} mm, +-{:.2f} deg)", object.position_std * kMillimetres,
                        object.rotation_std * kDegrees);
  }
  line += ", by " + object.evidence;
  if (object.refinement_translation > 0.0 || object.refinement_rotation > 0.0) {
    line += fmt::format("; depth refined the tags' pose by {:.1f} mm, {:.2f} deg",
                        object.refinement_translation * kMillimetres,
                        object.refinement_rotation * kDegrees);
  }
  if (moved > 3.0 * object.position_std && moved > 0.001) {
    line += fmt::format("; it was moved by {:.0f} mm", moved * kMillimetres);
  }
  if (const auto& simplification = object.model.simplification) {
    line += fmt::format("; CAD mesh simplified from {} to {} triangles, within {:.3f} mm",
                        simplification->full_triangles, object.model.mesh_object.triangles.size(),
                        simplification->max_error * kMillimetres);
  }
  return line + '\n';
}

std::string warnings_lines(const std::vector<InputWarning>& warnings) {
  std::string lines;
  for (const InputWarning& warning : warnings) {
    lines += "warning    " + warning.input + ": " + warning.message + '\n';
  }
  return lines;
}

/// Frames that gave surfaces; in a scene without them, those that gave the poses of bodies.
std::size_t frames_used(const SceneQuality& quality) {
  if (quality.frames_used > 0) return quality.frames_used;
  std::size_t frames = quality.frames_recorded;
  for (const auto& [reason, count] : quality.frames_dropped) frames -= std::min(frames, count);
  return frames;
}

std::string tags_line(const Counts& tags_seen, std::size_t frames) {
  std::string line = "tags       ";
  for (const auto& [tag, count] : tags_seen) {
    line += tag + (count == 0 ? " never detected, "
                              : fmt::format(" in {} of {} frames, ", count, frames));
  }
  return line.substr(0, line.size() - 2) + '\n';
}

}  // namespace

std::string frames_line(std::size_t recorded, std::size_t used, const Counts& dropped) {
  std::string line = fmt::format("frames     {} of {} used", used, recorded);
  if (recorded == 0) line = "frames     none";
  for (const auto& [reason, count] : dropped) line += fmt::format("; {}: {}", reason, count);
  return line + '\n';
}

std::string times_table(const std::vector<StageTime>& times) {
  std::string table;
  for (const StageTime& time : times) {
    table += fmt::format("  {:<28} {:>6.1f} s  ({:.1f} s of CPU)\n", time.stage, time.wall_seconds,
                         time.cpu_seconds);
  }
  return table;
}

namespace {

/// The results of the frames: camera, mesh, cloud and occupancy.
std::string surfaces_summary(const Scene& scene) {
  const SceneQuality& quality = scene.quality;
  std::string text = fmt::format("camera     {}; +-{:.1f} mm, +-{:.2f} deg in base",
                                 quality.is_fixed_camera ? "fixed" : "moving",
                                 quality.camera_position_std * kMillimetres,
                                 quality.camera_rotation_std * kDegrees);
  if (quality.tag_reprojection_rms) {
    text += fmt::format("; tag corners fit to {:.2f} px", *quality.tag_reprojection_rms);
  }
  text += fmt::format("\nmesh       {} triangles, {:.2f} m^2", scene.mesh_base.triangles.size(),
                      surface_area(scene.mesh_base));
  if (quality.surface_rms) {
    text +=
        fmt::format("; frames lie {:.1f} mm from it (median)", *quality.surface_rms * kMillimetres);
  }
  text += fmt::format("\ncloud      {} points, averaged in voxels of {:.1f} mm\n",
                      scene.cloud_base.points.size(), scene.voxel_size * kMillimetres);
  const OccupancyMap::Counts cells = scene.occupancy.counts();
  return text + fmt::format("occupancy  {} cells occupied, {} free\n", cells.occupied, cells.free);
}

}  // namespace

std::string scene_summary(const Scene& scene, const std::string& folder) {
  const SceneQuality& quality = scene.quality;
  const bool is_scanned = quality.frames_used > 0;
  std::string text =
      frames_line(quality.frames_recorded, frames_used(quality), quality.frames_dropped);
  if (!quality.tags_seen.empty()) {
    text +=
        tags_line(quality.tags_seen, is_scanned ? quality.frames_used : quality.frames_recorded);
  }
  text += warnings_lines(quality.input_warnings);
  if (is_scanned) text += surfaces_summary(scene);
  for (const SupportPlane& plane : scene.support_planes) {
    text += fmt::format("support    a plane at z = {:.3f} m",
                        plane.plane_base.offset / plane.plane_base.normal.z());
    // Without surfaces the plane is where bodies stand, and nobody measured how flat it is.
    if (plane.rms > 0.0) text += fmt::format(", flat to {:.1f} mm", plane.rms * kMillimetres);
    text += '\n';
  }
  if (!scene.objects.empty()) text += "objects\n";
  for (const SceneObject& object : scene.objects) text += object_line(object);
  text += "time\n" + times_table(quality.times);
  text += "open " + folder + "/preview.png, or " + folder + "/scene.glb in any glTF viewer\n";
  return text;
}

nlohmann::ordered_json times_json(const std::vector<StageTime>& times) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const StageTime& time : times) {
    json.push_back({{"stage", time.stage},
                    {"wall_seconds", time.wall_seconds},
                    {"cpu_seconds", time.cpu_seconds}});
  }
  return json;
}

void add_cycle_times(const CycleTimes& times, nlohmann::ordered_json& result) {
  result["cycle_p50_s"] = times.median;
  result["cycle_p99_s"] = times.p99;
  result["cycle_p999_s"] = times.p999;
  result["cycle_longest_s"] = times.longest;
}

nlohmann::ordered_json scene_json(const Scene& scene, const std::string& folder) {
  const SceneQuality& quality = scene.quality;
  nlohmann::ordered_json json{{"scene", folder},
                              {"frames_recorded", quality.frames_recorded},
                              {"frames_used", frames_used(quality)}};
  json["frames_dropped"] = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : quality.frames_dropped) json["frames_dropped"][reason] = count;
  json["tags_seen"] = nlohmann::ordered_json::object();
  for (const auto& [tag, count] : quality.tags_seen) json["tags_seen"][tag] = count;
  json["is_fixed_camera"] = quality.is_fixed_camera;
  json["tag_reprojection_rms_px"] = nullptr;
  if (quality.tag_reprojection_rms) {
    json["tag_reprojection_rms_px"] = *quality.tag_reprojection_rms;
  }
  json["camera_position_sigma_m"] = quality.camera_position_std;
  json["camera_rotation_sigma_rad"] = quality.camera_rotation_std;
  json["surface_distance_median_m"] = nullptr;
  if (quality.surface_rms) json["surface_distance_median_m"] = *quality.surface_rms;
  json["input_warnings"] = nlohmann::ordered_json::array();
  for (const InputWarning& warning : quality.input_warnings) {
    json["input_warnings"].push_back({{"input", warning.input},
                                      {"message", warning.message},
                                      {"factor", warning.factor},
                                      {"frames", warning.frames}});
  }
  json["mesh_triangles"] = scene.mesh_base.triangles.size();
  json["cloud_points"] = scene.cloud_base.points.size();
  json["mesh_area_m2"] = surface_area(scene.mesh_base);
  json["objects"] = nlohmann::ordered_json::array();
  json["not_found"] = nlohmann::ordered_json::array();
  for (const SceneObject& object : scene.objects) {
    if (object.evidence == kNotSeen) {
      json["not_found"].push_back({{"name", object.model.name}, {"reason", object.reason}});
      continue;
    }
    const Eigen::Vector3d& p = object.T_base_object.translation();
    const Eigen::Quaterniond& q = object.T_base_object.rotation();
    json["objects"].push_back({{"name", object.model.name},
                               {"evidence", object.evidence},
                               {"t_m", {p.x(), p.y(), p.z()}},
                               {"q_xyzw", {q.x(), q.y(), q.z(), q.w()}},
                               {"position_sigma_m", object.position_std},
                               {"rotation_sigma_rad", object.rotation_std}});
    if (const auto& simplification = object.model.simplification) {
      json["objects"].back()["full_triangles"] = simplification->full_triangles;
      json["objects"].back()["simplified_error_m"] = simplification->max_error;
    }
  }
  json["times"] = times_json(quality.times);
  return json;
}

}  // namespace pcavr::app
