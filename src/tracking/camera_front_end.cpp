// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_front_end.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/geometry/depth_grid.hpp"

#include "camera_relocaliser.hpp"

namespace pcavr::tracking {
namespace {

// A keyframe serves until the view has changed by one unit of view_change.
constexpr double kBaseline = 0.15;                          // of the mean depth
constexpr double kAngle = 12.0 * std::numbers::pi / 180.0;  // [rad]
constexpr double kNear = 0.7;                               // an old keyframe is taken up again
constexpr double kMinOverlap = 0.65;
constexpr double kMinLandmarks = 0.35;  // of the keyframe's

// Motion is carried forward at most this long: a hand changes its mind [s].
constexpr double kMaxPrediction = 0.2;

// A frame that shows less surface than a tenth of the image is no model for others.
constexpr std::size_t kMinShare = 10;

double mean_depth(const InverseDepth& cells) {
  double sum = 0.0;
  int count = 0;
  for (const float w : cells) {
    if (w <= 0.0F) continue;
    sum += double{w};
    ++count;
  }
  return count > 0 ? count / sum : 1.0;
}

double view_change(const Pose& T_keyframe_frame, double depth) {
  return T_keyframe_frame.translation().norm() / (kBaseline * depth) +
         rotation_distance(Pose(), T_keyframe_frame) / kAngle;
}

/// The picture on the depth image's grid.
cv::Mat gray_of_depth_grid(const RgbdFrame& frame) {
  const int width = frame.depth.width();
  const int height = frame.depth.height();
  if (frame.color.width() == width && frame.color.height() == height) return gray_of(frame.color);
  return gray_of(color_on_grid(frame.color, width, height));
}

/// Landmarks that keep straying lie on something that moves.
void drop_strays(const Alignment& alignment, ActiveModel& model) {
  constexpr int kPatience = 3;  // frames
  for (const std::size_t i : alignment.agreeing) model.landmarks[i].strayed = 0;
  for (const std::size_t i : alignment.straying) ++model.landmarks[i].strayed;
  std::erase_if(model.landmarks,
                [](const Landmark& landmark) { return landmark.strayed >= kPatience; });
}

bool shows_surface(const FrameView& view) {
  const auto filled = static_cast<std::size_t>(std::count_if(
      view.inverse_depth.begin(), view.inverse_depth.end(), [](float w) { return w > 0.0F; }));
  return filled * kMinShare >= view.inverse_depth.size();
}

}  // namespace

CameraFrontEnd::CameraFrontEnd(const CameraModel& camera, const DepthNoise& noise)
    : sensor_{camera, noise, CellGrid(camera)} {}

double CameraFrontEnd::tracking_rms() const {
  return aligned_ > 0 ? std::sqrt(squares_ / aligned_) : 0.0;
}

FrameRecord& CameraFrontEnd::add(const RgbdFrame& frame, const MaskImage& is_dynamic,
                                 Parallelism parallelism) {
  const double color_lag = to_seconds(frame.color_stamp - frame.depth_stamp);
  FrameView view;
  view.inverse_depth = cell_inverse_depth(sensor_.grid, frame.depth, is_dynamic, sensor_.noise);
  view.gray = gray_of_depth_grid(frame);
  view.pyramid = make_pyramid(view.gray, false);
  view.T_depth_color = Pose::exp(velocity_ * color_lag);
  FrameRecord& record = records_.emplace_back();
  record.index = frame.index;
  record.stamp = frame.depth_stamp;
  record.T_depth_color = view.T_depth_color;
  if (follow(view, record, parallelism) || relocalise(view, record, parallelism)) return record;
  velocity_.setZero();
  if (shows_surface(view)) {
    // Perhaps the first frame of a new stretch; if the next ones don't follow it, it stays alone.
    make_keyframe(view, record, next_segment_++, Pose());
  }
  return record;
}

Pose CameraFrontEnd::predict(Stamp stamp) const {
  const double ahead = to_seconds(stamp - last_->stamp);
  if (ahead > kMaxPrediction) return last_->T_keyframe_frame;
  return last_->T_keyframe_frame * Pose::exp(velocity_ * ahead);
}

bool CameraFrontEnd::follow(const FrameView& view, FrameRecord& record, Parallelism parallelism) {
  if (!active_ || !last_) return false;
  Alignment alignment = match(sensor_, *active_, view, predict(record.stamp), parallelism);
  if (!alignment.is_sound()) {
    alignment = match(sensor_, *active_, view, last_->T_keyframe_frame, parallelism);
  }
  if (!alignment.is_sound()) return false;
  accept(view, alignment, record);
  choose_keyframe(view, alignment, record, parallelism);
  return true;
}

void CameraFrontEnd::accept(const FrameView& view, const Alignment& alignment,
                            FrameRecord& record) {
  record.links.push_back({active_->keyframe, alignment.T_model_frame, alignment.information});
  squares_ += alignment.surface_rms * alignment.surface_rms;
  ++aligned_;
  if (last_) {
    const double elapsed = to_seconds(record.stamp - last_->stamp);
    if (elapsed > 0.0) {
      velocity_ = (last_->T_keyframe_frame.inverse() * alignment.T_model_frame).log() / elapsed;
    }
  }
  last_ = Placed{alignment.T_model_frame, record.stamp};
  drop_strays(alignment, *active_);
  Keyframe& keyframe = keyframes_[active_->keyframe];
  fuse(sensor_.grid, active_->surface, view.inverse_depth, alignment.T_model_frame, sensor_.noise,
       keyframe.model);
  // Noise goes down with the square root of the frames: worth the work when they have doubled.
  const int frames = keyframe.model.frames;
  if ((frames & (frames - 1)) == 0 && frames <= 32) refresh(sensor_, keyframe, *active_);
}

void CameraFrontEnd::choose_keyframe(const FrameView& view, const Alignment& alignment,
                                     FrameRecord& record, Parallelism parallelism) {
  const double depth = mean_depth(view.inverse_depth);
  const bool is_enough = view_change(alignment.T_model_frame, depth) < 1.0 &&
                         alignment.overlap > kMinOverlap &&
                         alignment.features_matched >= kMinLandmarks * alignment.features;
  if (is_enough || !shows_surface(view)) return;
  const int segment = keyframes_[active_->keyframe].segment;
  const Pose T_segment_frame =
      keyframes_[active_->keyframe].T_segment_keyframe * alignment.T_model_frame;
  if (const auto old = nearest_keyframe(T_segment_frame, segment, depth)) {
    ActiveModel model = activate(sensor_, keyframes_, *old);
    const Alignment again =
        match(sensor_, model, view, keyframes_[*old].T_segment_keyframe.inverse() * T_segment_frame,
              parallelism);
    if (again.is_sound() && again.overlap > kMinOverlap) {
      record.links.push_back({*old, again.T_model_frame, again.information});
      switch_to(std::move(model), again.T_model_frame, record.stamp);
      return;
    }
  }
  make_keyframe(view, record, segment, T_segment_frame);
  if (segment != keyframes_.front().segment) {
    // A stretch that lost its link to the first one looks for it at each new keyframe.
    (void)relocalise(view, record, parallelism);
  }
}

std::optional<std::size_t> CameraFrontEnd::nearest_keyframe(const Pose& T_segment_frame,
                                                            int segment, double depth) const {
  std::optional<std::size_t> best;
  double best_change = kNear;
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    if (keyframes_[k].segment != segment || k == active_->keyframe) continue;
    const double change =
        view_change(keyframes_[k].T_segment_keyframe.inverse() * T_segment_frame, depth);
    if (change < best_change) {
      best_change = change;
      best = k;
    }
  }
  return best;
}

void CameraFrontEnd::switch_to(ActiveModel model, const Pose& T_keyframe_frame, Stamp stamp) {
  active_ = std::move(model);
  last_ = Placed{T_keyframe_frame, stamp};
}

void CameraFrontEnd::make_keyframe(const FrameView& view, FrameRecord& record, int segment,
                                   const Pose& T_segment_keyframe) {
  Keyframe keyframe;
  keyframe.record = records_.size() - 1;
  keyframe.segment = segment;
  keyframe.T_segment_keyframe = T_segment_keyframe;
  keyframe.model.inverse_depth = view.inverse_depth;
  keyframe.model.weight.assign(view.inverse_depth.size(), 1.0F);
  keyframe.gray = view.gray;
  keyframe.T_depth_color = view.T_depth_color;
  keyframe.corners = find_corners(view.gray, sensor_.grid,
                                  make_surface(sensor_.grid, view.inverse_depth, sensor_.noise));
  keyframes_.push_back(std::move(keyframe));
  switch_to(activate(sensor_, keyframes_, keyframes_.size() - 1), Pose(), record.stamp);
}

bool CameraFrontEnd::relocalise(const FrameView& view, FrameRecord& record,
                                Parallelism parallelism) {
  const bool is_keyframe = !keyframes_.empty() && keyframes_.back().record + 1 == records_.size();
  const int segment = is_keyframe ? keyframes_.back().segment : -1;
  for (const RelocalisationStart& start :
       find_relocalisation_starts(sensor_, keyframes_, view, segment)) {
    ActiveModel model = activate(sensor_, keyframes_, start.keyframe);
    const Alignment alignment = match(sensor_, model, view, start.T_keyframe_frame, parallelism);
    if (!alignment.is_sound()) continue;
    record.links.push_back({start.keyframe, alignment.T_model_frame, alignment.information});
    if (is_keyframe) {
      const Pose T_into_frame =
          keyframes_[start.keyframe].T_segment_keyframe * alignment.T_model_frame;
      join_segments(segment, keyframes_[start.keyframe].segment,
                    T_into_frame * keyframes_.back().T_segment_keyframe.inverse());
    } else {
      velocity_.setZero();
      switch_to(std::move(model), alignment.T_model_frame, record.stamp);
    }
    return true;
  }
  return false;
}

void CameraFrontEnd::join_segments(int from, int into, const Pose& T_into_from) {
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.segment != from) continue;
    keyframe.segment = into;
    keyframe.T_segment_keyframe = T_into_from * keyframe.T_segment_keyframe;
  }
}

}  // namespace pcavr::tracking
