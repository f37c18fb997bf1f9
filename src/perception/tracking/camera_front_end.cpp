// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_front_end.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/geometry/depth_grid.hpp"

#include "camera_relocaliser.hpp"

namespace pcavr::tracking {
namespace {

// View change up to which an old keyframe is reused: less than 1, so that it is used for a while.
constexpr double kMaxReuseChange = 0.7;

// The next view after a gap may be as far again: a keyframe is made of a smaller change.
constexpr double kMaxChangeAfterGap = 0.3;

// A keyframe needs surface in at least 1 / kMinSurfaceDivisor of the image: with less, the frames
// aligned to it would be lost.
constexpr std::size_t kMinSurfaceDivisor = 10;

// View change below which two starts lead to the same alignment.
constexpr double kSameStart = 0.1;

// An alignment that begins with the motion of given poses is taken unless it agrees less than this
// share of another one does: on repeated patterns the wrong one fits as well; beside the true one,
// a wrong one was never seen to agree with above 0.92.
constexpr double kMinRelativeAgreement = 0.98;

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

/// The colour image in grey, resampled to the depth image's grid.
cv::Mat gray_on_depth_grid(const RgbdFrame& frame) {
  const int width = frame.depth.width();
  const int height = frame.depth.height();
  if (frame.color.width() == width && frame.color.height() == height)
    return to_gray_mat(frame.color);
  return to_gray_mat(color_on_grid(frame.color, width, height));
}

/// Removes landmarks that are outliers in several consecutive frames: they lie on a moving object.
void remove_outliers(const Alignment& alignment, ActiveModel& model) {
  constexpr int kMaxOutlierFrames = 3;  // one or two may be motion blur
  for (const std::size_t i : alignment.inliers) model.landmarks[i].outlier_frames = 0;
  for (const std::size_t i : alignment.outliers) ++model.landmarks[i].outlier_frames;
  std::erase_if(model.landmarks, [](const Landmark& landmark) {
    return landmark.outlier_frames >= kMaxOutlierFrames;
  });
}

/// Share of the surface in view that fits (of the features, where there is no surface), less what
/// contradicts it. Features say less: their outliers are relative to their scatter, which a wrong
/// pose widens.
double agreement(const Alignment& alignment) {
  const auto share = [](auto matched, auto all) {
    return static_cast<double>(matched) / std::max(1.0, static_cast<double>(all));
  };
  const double fits = alignment.surface_in_view > 0
                          ? share(alignment.surface_matched, alignment.surface_in_view)
                          : share(alignment.features_matched, alignment.features);
  return fits * (1.0 - alignment.evidence.contradicted) *
         alignment.evidence.correlation.value_or(1.0);
}

bool has_enough_surface(const FrameView& view) {
  const auto filled = static_cast<std::size_t>(std::count_if(
      view.inverse_depth.begin(), view.inverse_depth.end(), [](float w) { return w > 0.0F; }));
  return filled * kMinSurfaceDivisor >= view.inverse_depth.size();
}

}  // namespace

CameraFrontEnd::CameraFrontEnd(const CameraModel& camera, const Trajectory& given,
                               const CameraTrackerOptions& options)
    : given_(given), options_(options), sensor_{camera, options.depth_noise, CellGrid(camera)} {}

/// A keyframe is used until the view has changed by one unit.
double CameraFrontEnd::view_change(const Pose& T_keyframe_frame, double depth) const {
  return T_keyframe_frame.translation().norm() / (options_.keyframe_baseline * depth) +
         rotation_distance(Pose(), T_keyframe_frame) / options_.keyframe_angle;
}

double CameraFrontEnd::tracking_rms() const {
  return aligned_ > 0 ? std::sqrt(sum_squares_ / aligned_) : 0.0;
}

FrameRecord& CameraFrontEnd::add(const RgbdFrame& frame, const MaskImage& is_dynamic,
                                 Parallelism parallelism) {
  const double color_delay = to_seconds(frame.color_stamp - frame.depth_stamp);
  FrameView view;
  view.inverse_depth = cell_inverse_depth(sensor_.grid, frame.depth, is_dynamic, sensor_.noise);
  view.gray = gray_on_depth_grid(frame);
  view.texture = cell_texture(sensor_.grid, view.gray);
  view.pyramid = make_pyramid(view.gray, false);
  view.T_depth_color = Pose::exp(velocity_ * color_delay);
  FrameRecord& record = records_.emplace_back();
  record.index = frame.index;
  record.stamp = frame.depth_stamp;
  record.T_depth_color = view.T_depth_color;
  if (track(view, record, parallelism) || relocalise(view, record, parallelism)) return record;
  velocity_.setZero();
  if (has_enough_surface(view)) {
    // The first frame of a new segment; if no later frame aligns to it, it remains the only one.
    make_keyframe(view, record, next_segment_++, Pose());
  }
  return record;
}

Pose CameraFrontEnd::predict(Stamp stamp) const {
  const double elapsed = to_seconds(stamp - last_->stamp);
  if (elapsed > options_.max_prediction_time) return last_->T_keyframe_frame;
  return last_->T_keyframe_frame * Pose::exp(velocity_ * elapsed);
}

/// Whether the newest frame comes too long after the one before for the motion to be predicted.
bool CameraFrontEnd::follows_gap() const {
  return records_.size() > 1 && to_seconds(records_.back().stamp - records_.end()[-2].stamp) >
                                    options_.max_prediction_time;
}

/// The pose in the active keyframe by the motion that the given poses say; nullopt without them.
std::optional<Pose> CameraFrontEnd::by_given_motion(Stamp stamp) const {
  const auto before = given_.at(last_->stamp);
  const auto now = given_.at(stamp);
  if (!before || !now) return std::nullopt;
  return last_->T_keyframe_frame * (before->inverse() * *now);
}

/// The alignment that agrees best: from the predicted pose; by features, too, where that may be far
/// off; and from the motion of the given poses, if it is another one.
Alignment CameraFrontEnd::align(const FrameView& view, Stamp stamp, Parallelism parallelism) const {
  const auto from = [&](const Pose& start) {
    return match(sensor_, *active_, view, start, parallelism);
  };
  const Pose predicted = predict(stamp);
  Alignment best = from(predicted);
  if (!best.is_valid(options_)) best = from(last_->T_keyframe_frame);
  const auto try_start = [&](const std::optional<Pose>& start, double min_relative_agreement) {
    if (!start) return;
    const Pose change = predicted.inverse() * *start;
    if (view_change(change, mean_depth(view.inverse_depth)) < kSameStart) return;
    Alignment other = from(*start);
    if (!other.is_valid(options_)) return;
    if (!best.is_valid(options_) || agreement(other) > min_relative_agreement * agreement(best)) {
      best = std::move(other);
    }
  };
  if (follows_gap() || !best.is_valid(options_)) {
    try_start(pose_by_features(sensor_, keyframes_[active_->keyframe], view), 1.0);
  }
  try_start(by_given_motion(stamp), kMinRelativeAgreement);
  return best;
}

bool CameraFrontEnd::track(const FrameView& view, FrameRecord& record, Parallelism parallelism) {
  if (!active_ || !last_) return false;
  const Alignment alignment = align(view, record.stamp, parallelism);
  if (!alignment.is_valid(options_)) return false;
  accept(view, alignment, record);
  choose_keyframe(view, alignment, record, parallelism);
  return true;
}

void CameraFrontEnd::accept(const FrameView& view, const Alignment& alignment,
                            FrameRecord& record) {
  record.links.push_back({active_->keyframe, alignment.T_model_frame, alignment.information});
  sum_squares_ += alignment.surface_rms * alignment.surface_rms;
  ++aligned_;
  if (last_) {
    const double elapsed = to_seconds(record.stamp - last_->stamp);
    if (elapsed > 0.0) {
      velocity_ = (last_->T_keyframe_frame.inverse() * alignment.T_model_frame).log() / elapsed;
    }
  }
  last_ = Placed{alignment.T_model_frame, record.stamp};
  remove_outliers(alignment, *active_);
  Keyframe& keyframe = keyframes_[active_->keyframe];
  fuse(sensor_.grid, active_->surface, view.inverse_depth, alignment.T_model_frame, sensor_.noise,
       keyframe.model);
  // Noise decreases with the square root of the frames: refresh only when their number has doubled.
  const int frames = keyframe.model.frames;
  if ((frames & (frames - 1)) == 0 && frames <= 32) refresh(sensor_, keyframe, *active_);
}

void CameraFrontEnd::choose_keyframe(const FrameView& view, const Alignment& alignment,
                                     FrameRecord& record, Parallelism parallelism) {
  const double depth = mean_depth(view.inverse_depth);
  const bool is_late = follows_gap();
  const bool is_similar =
      view_change(alignment.T_model_frame, depth) < (is_late ? kMaxChangeAfterGap : 1.0) &&
      alignment.overlap > options_.keyframe_overlap &&
      alignment.features_matched >= options_.keyframe_landmark_ratio * alignment.features;
  if (is_similar || !has_enough_surface(view)) return;
  const int segment = keyframes_[active_->keyframe].segment;
  const Pose T_segment_frame =
      keyframes_[active_->keyframe].T_segment_keyframe * alignment.T_model_frame;
  // Loop closure: an old keyframe that shows the place is linked, and reused unless after a gap.
  if (const auto old = nearest_keyframe(T_segment_frame, segment, depth)) {
    ActiveModel model = activate(sensor_, keyframes_, *old);
    const Alignment closure =
        match(sensor_, model, view, keyframes_[*old].T_segment_keyframe.inverse() * T_segment_frame,
              parallelism);
    if (closure.is_valid(options_) && closure.overlap > options_.keyframe_overlap) {
      record.links.push_back({*old, closure.T_model_frame, closure.information});
      if (!is_late) {
        switch_to(std::move(model), closure.T_model_frame, record.stamp);
        return;
      }
    }
  }
  make_keyframe(view, record, segment, T_segment_frame);
  const bool has_others = std::any_of(keyframes_.begin(), keyframes_.end(),
                                      [&](const auto& other) { return other.segment != segment; });
  // Unconnected segments try to relocalise at each new keyframe.
  if (has_others) (void)relocalise(view, record, parallelism);
}

std::optional<std::size_t> CameraFrontEnd::nearest_keyframe(const Pose& T_segment_frame,
                                                            int segment, double depth) const {
  std::optional<std::size_t> best;
  double best_change = kMaxReuseChange;
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
  for (const RelocalisationCandidate& candidate :
       find_relocalisation_candidates(sensor_, keyframes_, view, segment)) {
    ActiveModel model = activate(sensor_, keyframes_, candidate.keyframe);
    const Alignment alignment =
        match(sensor_, model, view, candidate.T_keyframe_frame, parallelism);
    if (!alignment.is_valid(options_)) continue;
    record.links.push_back({candidate.keyframe, alignment.T_model_frame, alignment.information});
    if (is_keyframe) {
      const Pose T_into_frame =
          keyframes_[candidate.keyframe].T_segment_keyframe * alignment.T_model_frame;
      merge_segments(segment, keyframes_[candidate.keyframe].segment,
                     T_into_frame * keyframes_.back().T_segment_keyframe.inverse());
    } else {
      velocity_.setZero();
      switch_to(std::move(model), alignment.T_model_frame, record.stamp);
    }
    return true;
  }
  return false;
}

void CameraFrontEnd::merge_segments(int from, int into, const Pose& T_into_from) {
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.segment != from) continue;
    keyframe.segment = into;
    keyframe.T_segment_keyframe = T_into_from * keyframe.T_segment_keyframe;
  }
}

}  // namespace pcavr::tracking
