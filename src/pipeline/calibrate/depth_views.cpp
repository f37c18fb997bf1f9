// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/geometry/pixel.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/pipeline/calibrate_depth.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "pipeline/build/survey.hpp"

namespace pcavr {
namespace {

/// Share of the tag, from its centre, whose pixels are used: near its edge they may be of what is
/// behind it.
constexpr double kInnerShareOfTag = 0.8;
/// Fewer pixels than this do not determine a plane.
constexpr std::size_t kMinPixelsOfTag = 40;
/// Share of these that has to be measured: black ink may be seen by no sensor.
constexpr double kMinMeasuredShare = 0.5;
/// Pixels farther from the plane than this many standard deviations are of something else.
constexpr double kMaxDeviation = 4.0;
/// Views of a body nearer to each other than this are of one place [m, rad].
constexpr double kPlaceDistance = 0.05, kPlaceAngle = 0.1;

/// A pixel inside a tag.
struct TagPixel {
  double x = 0.0, y = 0.0;  ///< [px] on the depth's grid
  double depth = 0.0;       ///< [m] measured
  double missing = 0.0;     ///< [m] the tag's less that
};

bool is_inside(const std::array<Eigen::Vector2d, 4>& corners, double x, double y) {
  bool has_left = false, has_right = false;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d b = Eigen::Vector2d(x, y) - corners[i];
    const double side = a.x() * b.y() - a.y() * b.x();
    has_left = has_left || side < 0.0;
    has_right = has_right || side > 0.0;
  }
  return !(has_left && has_right);
}

/// The pixels inside the tag that are measured; none where too few are.
std::vector<TagPixel> pixels_of(const DepthImage& depth, const CameraModel& grid,
                                const std::array<Eigen::Vector2d, 4>& corners,
                                const Pose& T_camera_tag) {
  std::array<Eigen::Vector2d, 4> inner;
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < 4; ++i) {
    inner[i] = middle + kInnerShareOfTag * (corners[i] - middle);
    box.extend(inner[i]);
  }
  const int x0 = clamp_to_int(std::ceil(box.min().x()), 0, depth.width());
  const int y0 = clamp_to_int(std::ceil(box.min().y()), 0, depth.height());
  const int x1 = clamp_to_int(std::floor(box.max().x()), -1, depth.width() - 1);
  const int y1 = clamp_to_int(std::floor(box.max().y()), -1, depth.height() - 1);
  const Eigen::Vector3d normal = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
  const double distance = normal.dot(T_camera_tag.translation());
  std::vector<TagPixel> pixels;
  std::size_t inside = 0;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      if (!is_inside(inner, x, y)) continue;
      ++inside;
      const auto z = static_cast<double>(depth(x, y));
      const double by_tags = distance / normal.dot(grid.normalise({x, y}).homogeneous());
      if (!(z > 0.0) || !(by_tags > 0.0) || !std::isfinite(by_tags)) continue;
      pixels.push_back({static_cast<double>(x), static_cast<double>(y), z, by_tags - z});
    }
  }
  const auto needed = static_cast<std::size_t>(kMinMeasuredShare * static_cast<double>(inside));
  if (pixels.size() < std::max(kMinPixelsOfTag, needed)) pixels.clear();
  return pixels;
}

/// Of the missing depth over the image: at the middle [m], and its slopes [m/px].
Eigen::Vector3d plane_of(const std::vector<TagPixel>& pixels, const Eigen::Vector2d& middle) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const TagPixel& pixel : pixels) {
    const Eigen::Vector3d row(1.0, pixel.x - middle.x(), pixel.y - middle.y());
    information += row * row.transpose();
    right += pixel.missing * row;
  }
  return information.ldlt().solve(right);
}

double deviation(const TagPixel& pixel, const Eigen::Vector3d& plane,
                 const Eigen::Vector2d& middle) {
  return pixel.missing -
         plane.dot(Eigen::Vector3d(1.0, pixel.x - middle.x(), pixel.y - middle.y()));
}

/// Leaves out the pixels that are far from the plane of the others.
void keep_plane(std::vector<TagPixel>& pixels, const Eigen::Vector2d& middle) {
  for (int round = 0; round < 2; ++round) {
    const Eigen::Vector3d plane = plane_of(pixels, middle);
    std::vector<double> sizes;
    for (const TagPixel& pixel : pixels) {
      sizes.push_back(std::abs(deviation(pixel, plane, middle)));
    }
    const double limit = kMaxDeviation * kStdOverMad * median(sizes);
    std::erase_if(pixels, [&](const TagPixel& pixel) {
      return std::abs(deviation(pixel, plane, middle)) > limit;
    });
  }
}

std::vector<DepthCell> cells_of(const std::vector<TagPixel>& pixels, const CameraModel& grid) {
  std::map<int, DepthCell> cells;
  for (const TagPixel& pixel : pixels) {
    const int column = static_cast<int>(pixel.x) * kDepthCellColumns / grid.width;
    const int row = static_cast<int>(pixel.y) * kDepthCellRows / grid.height;
    DepthCell& cell = cells[row * kDepthCellColumns + column];
    cell.cell = row * kDepthCellColumns + column;
    ++cell.pixels;
    cell.depth += pixel.depth;
    cell.missing += pixel.missing;
  }
  std::vector<DepthCell> list;
  for (const auto& [number, cell] : cells) list.push_back(cell);
  return list;
}

/// A tag of a body whose pose in the camera is known; nothing where too little depth is inside it.
std::optional<DepthView> view_of(const DepthImage& depth, const CameraModel& camera,
                                 const TagDetection& detection, const Pose& T_camera_tag) {
  const CameraModel grid = on_grid(camera, depth.width(), depth.height());
  std::array<Eigen::Vector2d, 4> corners = detection.corners;
  for (Eigen::Vector2d& corner : corners) corner = to_grid(corner, camera, grid);
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  std::vector<TagPixel> pixels = pixels_of(depth, grid, corners, T_camera_tag);
  if (pixels.empty()) return std::nullopt;
  keep_plane(pixels, middle);
  if (pixels.size() < kMinPixelsOfTag) return std::nullopt;
  const Eigen::Vector3d plane = plane_of(pixels, middle);
  DepthView view{.tag = detection.id.to_string()};
  double squares = 0.0;
  for (const TagPixel& pixel : pixels) {
    view.by_depth += pixel.depth;
    view.by_tags += pixel.depth + pixel.missing;
    squares += std::pow(deviation(pixel, plane, middle), 2);
  }
  const auto count = static_cast<double>(pixels.size());
  view.by_depth /= count;
  view.by_tags /= count;
  view.plane_rms = std::sqrt(squares / count);
  view.plane_tilt = std::atan(std::hypot(plane.y() * grid.fx, plane.z() * grid.fy) / view.by_depth);
  view.cells = cells_of(pixels, grid);
  return view;
}

/// A body with tags: base, or an object.
struct TaggedBody {
  std::vector<TagPlacement> tags = {};
  std::vector<std::pair<Pose, std::size_t>> places = {};  ///< T_body_camera, number
};

std::vector<TaggedBody> bodies_of(const Manifest& manifest) {
  std::vector<TaggedBody> bodies{{.tags = base_placements(manifest)}};
  for (const ObjectEntry& object : manifest.objects) {
    bodies.push_back({.tags = object_placements(manifest, object.name)});
  }
  std::erase_if(bodies, [](const TaggedBody& body) { return body.tags.empty(); });
  return bodies;
}

/// The number of the place that the camera is at, a new one where it was not there before.
std::size_t place_of(const Pose& T_body_camera, TaggedBody& body, std::size_t& places) {
  for (const auto& [known, number] : body.places) {
    if ((known.translation() - T_body_camera.translation()).norm() < kPlaceDistance &&
        rotation_distance(known, T_body_camera) < kPlaceAngle) {
      return number;
    }
  }
  body.places.emplace_back(T_body_camera, places);
  return places++;
}

void add_views(const RgbdFrame& frame, const CameraModel& camera,
               const std::vector<TagDetection>& tags, std::vector<TaggedBody>& bodies,
               DepthViews& found) {
  for (TaggedBody& body : bodies) {
    const BodyPose pose = solve_body_pose(body.tags, tags, camera);
    if (pose.status != BodyPoseStatus::solved || pose.tags_rejected > 0) continue;
    const Pose& T_camera_body = pose.pose.T_camera_body;
    std::optional<std::size_t> place;
    for (const TagPlacement& placement : body.tags) {
      for (const TagDetection& detection : tags) {
        if (detection.id != placement.id) continue;
        std::optional<DepthView> view =
            view_of(frame.depth, camera, detection, T_camera_body * placement.T_body_marker);
        if (!view) continue;
        if (!place) place = place_of(T_camera_body.inverse(), body, found.places);
        view->frame = frame.index;
        view->place = *place;
        found.views.push_back(*std::move(view));
      }
    }
  }
}

std::optional<Error> missing_input(const Recording& recording, const DepthInput& input) {
  if (recording.frames.empty() || !recording.has_depth) {
    return Error{.message = recording.frames.empty() ? "has no images" : "has no depth images",
                 .file = input.recording.string(),
                 .hint = "give a recording with depth images of tags"};
  }
  if (!recording.manifest.markers.empty()) return std::nullopt;
  return Error{.message = "lists no tags, against which depth could be compared",
               .file = (input.recording / "recording.yaml").string(),
               .place = "markers",
               .hint = "add the tags in view with their sizes"};
}

}  // namespace

Expected<DepthViews> read_depth_views(const DepthInput& input, const Observer& observer) {
  ReadOptions reading;
  reading.skip_bad = input.skip_bad;
  const Expected<Recording> recording = read_recording(input.recording, reading);
  if (!recording) return recording.error();
  for (const std::string& warning : recording->warnings) observer.on_warning(warning);
  if (const auto error = missing_input(*recording, input)) return *error;
  const Manifest& manifest = recording->manifest;
  Expected<std::optional<TagDetector>> detector = make_tag_detector(*recording, {});
  if (!detector) return detector.error();
  DepthViews found{.depth_scale = manifest.depth_scale, .depth_offset = manifest.depth_offset};
  std::vector<TaggedBody> bodies = bodies_of(manifest);
  const std::size_t frames = std::min(input.max_frames, recording->frames.size());
  std::size_t unread = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    const Expected<RgbdFrame> frame =
        decode_frame(*recording, i * recording->frames.size() / frames);
    if (!frame && !input.skip_bad) return frame.error();
    observer.on_progress("Measuring tags", i + 1, frames);
    unread += frame ? 0 : 1;
    if (!frame) continue;
    add_views(*frame, *manifest.camera, (*detector)->detect(to_gray(frame->color)), bodies, found);
  }
  found.frames = frames - unread;
  if (unread > 0) found.notes.push_back(fmt::format("{} images can't be read: left out", unread));
  return found;
}

}  // namespace pcavr
