// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/import_clouds.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/cloud/cloud_alignment.hpp"
#include "pcavr/recordings/cloud/cloud_list.hpp"
#include "pcavr/recordings/recording/depth_units.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"
#include "pcavr/recordings/recording/manifest_template.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "cloud_camera.hpp"
#include "cloud_pose_check.hpp"
#include "cloud_poses.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Spacing of the points for alignment, as a share of their median distance from the sensor.
constexpr double kThinVoxelShare = 0.015;
/// Clouds read ahead for each thread.
constexpr std::size_t kCloudsPerThread = 2;
/// Interval between the frames of one cloud: the stamps of a recording ascend.
constexpr Duration kFaceInterval = std::chrono::microseconds(1);

/// A cloud as encoded images; what is computed in parallel.
struct EncodedCloud {
  ConvertedCloud converted;
  std::vector<EncodedImage> color;
  std::vector<EncodedImage> depth;
};

Expected<EncodedCloud> encode_cloud(const fs::path& file, const CloudCamera& camera,
                                    double thin_voxel, double depth_scale) {
  Expected<RecordedCloud> cloud = read_cloud(file);
  if (!cloud) return cloud.error();
  Expected<ConvertedCloud> converted =
      convert_cloud(*std::move(cloud), file.string(), camera, thin_voxel);
  if (!converted) return converted.error();
  EncodedCloud encoded{.converted = *std::move(converted), .color = {}, .depth = {}};
  for (const CloudFrame& frame : encoded.converted.frames) {
    Expected<std::string> jpeg = encode_color(frame.color);
    if (!jpeg) return jpeg.error();
    encoded.color.push_back({*std::move(jpeg), ".jpg"});
    encoded.depth.push_back({encode_depth(to_raw_depth(frame.depth, depth_scale)), ".png"});
  }
  return encoded;
}

std::vector<std::size_t> selected_clouds(std::size_t count, const CloudImportOptions& options) {
  std::vector<std::size_t> selected;
  for (std::size_t i = options.first; i < count; i += options.stride) selected.push_back(i);
  return selected;
}

/// One import: state that its steps share.
class CloudImport {
 public:
  CloudImport(const fs::path& source, const fs::path& target, const CloudImportOptions& options,
              const Observer& observer)
      : source_(source), target_(target), options_(options), observer_(observer) {}

  Expected<CloudImportReport> run() {
    if (auto done = prepare(); !done) return done.error();
    if (auto done = convert_all(); !done) return done.error();
    if (auto done = place_clouds(); !done) return done.error();
    if (auto done = write_poses(); !done) return done.error();
    if (auto done = writer_->finish(); !done) return done.error();
    if (auto done = copy_manifest_files(manifest_, options_.manifest.parent_path(), target_);
        !done) {
      return done.error();
    }
    return report_;
  }

 private:
  /// Everything that can be checked before the long work.
  Expected<void> prepare() {
    Expected<CloudList> list = list_clouds(source_, options_.frame_rate);
    if (!list) return list.error();
    list_ = *std::move(list);
    const std::vector<std::size_t> selected = selected_clouds(list_.clouds.size(), options_);
    if (selected.empty()) {
      return Error{.message = "no clouds are left to import",
                   .file = source_.string(),
                   .hint = "choose a smaller --first"};
    }
    if (!options_.poses.empty()) {
      Expected<std::vector<Pose>> poses = read_cloud_poses(options_.poses, list_, selected);
      if (!poses) return poses.error();
      T_world_cloud_ = *std::move(poses);
    }
    for (const std::size_t i : selected) clouds_.push_back(list_.clouds[i]);
    Expected<Manifest> manifest = read_manifest_template(options_.manifest);
    if (!manifest) return manifest.error();
    manifest_ = *std::move(manifest);
    Expected<CloudCamera> camera = choose_cloud_camera(clouds_, options_);
    if (!camera) return camera.error();
    camera_ = *std::move(camera);
    report_camera();
    manifest_.camera = camera_.pinhole.camera;
    const bool is_asked_for = options_.depth_scale != CloudImportOptions{}.depth_scale;
    if (is_asked_for) manifest_.depth_scale = 0.0;  // a template's is of other images
    if (state_depth_units(options_.depth_scale, manifest_)) {
      observer_.on_warning(options_.manifest.string() +
                           ": the depth's offset is left out: its depth_scale is not that of the "
                           "images that are written; give --depth-scale");
    }
    writer_.emplace(target_, manifest_);
    return prepare_placing();
  }

  void report_camera() {
    report_.is_organised = camera_.is_organised;
    report_.camera = camera_.pinhole.camera;
    report_.ray_spacing = camera_.ray_spacing;
    report_.unit = camera_.unit;
    if (!camera_.is_unit_guessed) return;
    observer_.on_warning(source_.string() +
                         ": coordinates are taken as millimetres: the points are " +
                         std::to_string(std::lround(1e3 * camera_.median_range)) +
                         " units from the sensor (median); give --unit if that is wrong");
  }

  Expected<void> prepare_placing() {
    thin_voxel_ = kThinVoxelShare * camera_.median_range;
    report_.poses = !options_.poses.empty()  ? CloudPoses::given
                    : camera_.has_viewpoints ? CloudPoses::viewpoints
                                             : CloudPoses::aligned;
    const bool has_base_tags = !base_placements(manifest_).empty();
    if (options_.anchor_by_tags && !has_base_tags) {
      return Error{
          .message = "no base tag is declared to anchor the clouds by",
          .file = options_.manifest.empty() ? source_.string() : options_.manifest.string(),
          .hint = "give --manifest with a marker of role: base"};
    }
    const bool is_free = report_.poses == CloudPoses::aligned && !options_.T_base_world;
    if (!options_.anchor_by_tags && !(is_free && has_base_tags)) return {};
    Expected<TagAnchorCollector> collector =
        TagAnchorCollector::create(manifest_, camera_.pinhole.camera);
    if (!collector) return collector.error();
    anchor_.emplace(*std::move(collector));
    return {};
  }

  /// Reads, converts and encodes the clouds on all threads, and writes them in order.
  Expected<void> convert_all() {
    const std::size_t batch =
        kCloudsPerThread * static_cast<std::size_t>(options_.parallelism.threads);
    for (std::size_t begin = 0; begin < clouds_.size(); begin += batch) {
      const std::size_t count = std::min(batch, clouds_.size() - begin);
      std::vector<std::optional<Expected<EncodedCloud>>> encoded(count);
      parallel_for(options_.parallelism, count, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
          encoded[i] = encode_cloud(clouds_[begin + i].file, camera_, voxel_of(begin + i),
                                    options_.depth_scale);
        }
      });
      for (std::size_t i = 0; i < count; ++i) {
        if (!*encoded[i]) return encoded[i]->error();
        if (auto added = add(clouds_[begin + i].stamp, **encoded[i]); !added) return added;
        observer_.on_progress("import", begin + i + 1, clouds_.size());
      }
    }
    return {};
  }

  /// Alignment needs every cloud's thinned points, the check of given poses those of some.
  [[nodiscard]] double voxel_of(std::size_t cloud) const {
    if (report_.poses == CloudPoses::aligned) return thin_voxel_;
    const std::size_t step = compared_cloud_step(clouds_.size());
    return report_.poses == CloudPoses::given && cloud % step == 0 ? thin_voxel_ : 0.0;
  }

  Expected<void> add(Stamp stamp, EncodedCloud& encoded) {
    ConvertedCloud& converted = encoded.converted;
    for (std::size_t i = 0; i < converted.frames.size(); ++i) {
      const CloudFrame& frame = converted.frames[i];
      const Stamp at = stamp + kFaceInterval * static_cast<int>(i);
      if (auto added = writer_->add_encoded_frame(at, encoded.color[i], at, encoded.depth[i]);
          !added) {
        return added;
      }
      if (anchor_) anchor_->add(frames_.size(), frame.color, frame.depth);
      frames_.push_back({at, report_.clouds, frame.T_cloud_camera});
    }
    T_cloud_sensor_.push_back(converted.T_cloud_sensor);
    thinned_.push_back(std::move(converted.thinned_cloud));
    ++report_.clouds;
    report_.frames = frames_.size();
    report_.points += converted.points;
    // Neighbouring faces of a cube both show the points on their common edge.
    report_.points_outside += converted.points - std::min(converted.points, converted.points_used);
    report_.pinhole_residual = std::max(report_.pinhole_residual, converted.residual);
    return {};
  }

  /// The clouds' poses in the world frame.
  Expected<void> place_clouds() {
    switch (report_.poses) {
      case CloudPoses::given: {
        return check_cloud_poses(T_world_cloud_, thinned_, thin_voxel_, options_.poses,
                                 options_.parallelism, observer_);
      }
      case CloudPoses::viewpoints:
        // Points in the world frame themselves, or in that of the sensor at the viewpoint.
        for (const Pose& T_cloud_sensor : T_cloud_sensor_) {
          T_world_cloud_.push_back(camera_.is_in_sensor_frame ? T_cloud_sensor : Pose());
        }
        return {};
      case CloudPoses::aligned:
        break;
    }
    CloudAlignment alignment = align_clouds(thinned_, {.voxel = thin_voxel_}, observer_);
    if (alignment.failed) {
      return Error{.message = "does not overlap with the clouds before it; they can't be aligned",
                   .file = clouds_[*alignment.failed].file.string(),
                   .hint = "give --poses, or record with more overlap"};
    }
    T_world_cloud_ = std::move(alignment.T_world_cloud);
    report_.alignment_rms = alignment.rms;
    report_.alignment_overlap = alignment.min_overlap;
    return {};
  }

  /// Reports how well tags and poses agree, by the thresholds of the checks of a recording.
  [[nodiscard]] std::optional<Error> check_anchor(const TagAnchor& anchor) const {
    constexpr double kDegree = std::numbers::pi / 180.0;
    constexpr double kDoubtful = 0.05;       // [m]
    constexpr double kContradiction = 0.15;  // [m]
    const std::string text =
        fmt::format("base tags and the clouds' poses differ by {:.0f} mm, {:.1f} deg",
                    1e3 * anchor.position_rms, anchor.rotation_rms / kDegree);
    if (anchor.position_rms > kContradiction || anchor.rotation_rms > 10.0 * kDegree) {
      return Error{.message = text + " (rms, " + std::to_string(anchor.frames) + " frames)",
                   .file = options_.poses.empty() ? source_.string() : options_.poses.string(),
                   .hint = "check the tags' sizes and poses; more overlap aligns clouds better"};
    }
    if (anchor.position_rms > kDoubtful || anchor.rotation_rms > 3.0 * kDegree) {
      observer_.on_warning(source_.string() + ": " + text + " (rms)");
    }
    return std::nullopt;
  }

  /// Writes the cameras' poses in base.
  Expected<void> write_poses() {
    std::vector<Pose> T_world_camera;
    for (const Frame& frame : frames_) {
      T_world_camera.push_back(T_world_cloud_[frame.cloud] * frame.T_cloud_camera);
    }
    Pose T_base_world = options_.T_base_world.value_or(Pose());
    if (anchor_) {
      const std::optional<TagAnchor> anchor = anchor_->solve(T_world_camera);
      if (!anchor) {
        return Error{.message = "no base tag is seen in the clouds' colours",
                     .file = source_.string(),
                     .hint = "give --T-base-world, or clouds in colour that show a base tag"};
      }
      if (auto fault = check_anchor(*anchor)) return *std::move(fault);
      T_base_world = anchor->T_base_world;
      report_.anchor_frames = anchor->frames;
      report_.anchor_position_rms = anchor->position_rms;
      report_.anchor_rotation_rms = anchor->rotation_rms;
    } else if (report_.poses == CloudPoses::aligned && !options_.T_base_world) {
      observer_.on_warning(
          "base is the first cloud's frame: neither --T-base-world nor a base tag is given");
    }
    Trajectory T_base_camera;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      T_base_camera.append(frames_[i].stamp, T_base_world * T_world_camera[i]);
    }
    return writer_->write_groundtruth(T_base_camera);
  }

  struct Frame {
    Stamp stamp;
    std::size_t cloud;
    Pose T_cloud_camera;
  };

  const fs::path& source_;
  const fs::path& target_;
  const CloudImportOptions& options_;
  const Observer& observer_;
  CloudList list_;
  std::vector<ListedCloud> clouds_;  ///< those to import
  Manifest manifest_;
  CloudCamera camera_;
  double thin_voxel_ = 0.0;
  std::optional<RecordingWriter> writer_;
  std::optional<TagAnchorCollector> anchor_;
  std::vector<Pose> T_world_cloud_;
  std::vector<Pose> T_cloud_sensor_;
  std::vector<std::vector<Eigen::Vector3f>> thinned_;
  std::vector<Frame> frames_;
  CloudImportReport report_;
};

}  // namespace

Expected<CloudImportReport> import_clouds(const fs::path& source, const fs::path& target,
                                          const CloudImportOptions& options,
                                          const Observer& observer) {
  PCAVR_REQUIRE(options.stride >= 1, options.stride);
  PCAVR_REQUIRE(options.frame_rate >= 0.1 && options.frame_rate <= 1e5, options.frame_rate);
  PCAVR_REQUIRE(options.depth_scale > 0.0, options.depth_scale);
  return CloudImport(source, target, options, observer).run();
}

}  // namespace pcavr
