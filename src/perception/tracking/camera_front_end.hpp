// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/perception/tracking/camera_tracker.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"

#include "camera_map.hpp"

namespace pcavr::tracking {

/// SLAM front end: tracks the camera from frame to frame against keyframes and gives each frame's
/// pose relative to them, with loop closures and relocalisation. Does not use base tags. Not
/// thread-safe.
class CameraFrontEnd {
 public:
  /// `given` (T_base_camera, may be empty): where to begin to search after a large motion. Keeps a
  /// reference to it.
  CameraFrontEnd(const CameraModel& camera, const Trajectory& given,
                 const CameraTrackerOptions& options);

  /// Aligns the frame and appends its record; the record of a lost frame has no links.
  FrameRecord& add(const RgbdFrame& frame, const MaskImage& is_dynamic, Parallelism parallelism);

  [[nodiscard]] const Sensor& sensor() const { return sensor_; }
  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] const std::vector<FrameRecord>& records() const { return records_; }
  /// Access to change what the frames' tags showed.
  [[nodiscard]] std::vector<FrameRecord>& records() { return records_; }
  [[nodiscard]] double tracking_rms() const;

 private:
  struct Placed {
    Pose T_keyframe_frame;
    Stamp stamp;
  };

  [[nodiscard]] bool follows_gap() const;
  [[nodiscard]] Pose predict(Stamp stamp) const;
  [[nodiscard]] std::optional<Pose> by_given_motion(Stamp stamp) const;
  [[nodiscard]] Alignment align(const FrameView& view, Stamp stamp, Parallelism parallelism) const;
  [[nodiscard]] bool track(const FrameView& view, FrameRecord& record, Parallelism parallelism);
  [[nodiscard]] bool relocalise(const FrameView& view, FrameRecord& record,
                                Parallelism parallelism);
  void accept(const FrameView& view, const Alignment& alignment, FrameRecord& record);
  void choose_keyframe(const FrameView& view, const Alignment& alignment, FrameRecord& record,
                       Parallelism parallelism);
  void make_keyframe(const FrameView& view, FrameRecord& record, int segment,
                     const Pose& T_segment_keyframe);
  [[nodiscard]] std::optional<std::size_t> nearest_keyframe(const Pose& T_segment_frame,
                                                            int segment, double depth) const;
  void switch_to(ActiveModel model, const Pose& T_keyframe_frame, Stamp stamp);
  void merge_segments(int from, int into, const Pose& T_into_from);

  [[nodiscard]] double view_change(const Pose& T_keyframe_frame, double depth) const;

  const Trajectory& given_;
  CameraTrackerOptions options_;
  Sensor sensor_;
  std::vector<Keyframe> keyframes_;
  std::vector<FrameRecord> records_;
  std::optional<ActiveModel> active_;
  std::optional<Placed> last_;            ///< in the active keyframe
  Vector6d velocity_ = Vector6d::Zero();  ///< [v; w] per second, in camera axes
  int next_segment_ = 0;
  double sum_squares_ = 0.0;  ///< of the frames' point-to-plane rms
  int aligned_ = 0;
};

}  // namespace pcavr::tracking
