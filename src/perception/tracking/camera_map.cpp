// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_map.hpp"

namespace pcavr::tracking {

ActiveModel activate(const Sensor& sensor, const std::vector<Keyframe>& keyframes,
                     std::size_t keyframe) {
  ActiveModel active;
  active.keyframe = keyframe;
  active.pyramid = make_pyramid(keyframes[keyframe].gray, true);
  const Keyframe& model = keyframes[keyframe];
  active.inverse_depth = model.model.inverse_depth;
  active.texture = cell_texture(sensor.grid, model.gray);
  active.T_depth_color = model.T_depth_color;
  active.surface = make_surface(sensor.grid, model.model.inverse_depth, sensor.noise);
  active.landmarks = make_landmarks(model.corners, sensor.grid, active.surface, sensor.camera,
                                    model.T_depth_color);
  return active;
}

void refresh(const Sensor& sensor, const Keyframe& keyframe, ActiveModel& active) {
  active.surface = make_surface(sensor.grid, keyframe.model.inverse_depth, sensor.noise);
  for (Landmark& landmark : active.landmarks) {
    const Eigen::Vector2d pixel(landmark.pixel.x, landmark.pixel.y);
    const auto p_color = point_at(sensor.grid, active.surface, sensor.camera, pixel);
    if (p_color) landmark.p_model = keyframe.T_depth_color * *p_color;
  }
}

Alignment match(const Sensor& sensor, const ActiveModel& model, const FrameView& frame,
                const Pose& T_keyframe_frame_predicted, Parallelism parallelism) {
  // Error of the prediction that the features still correct [px].
  constexpr double kInitialScale = 20.0;
  const std::vector<FeatureMatch> features =
      track_landmarks(model.pyramid, model.landmarks, frame.pyramid,
                      T_keyframe_frame_predicted * frame.T_depth_color, sensor.camera);
  AlignmentInput input;
  input.grid = &sensor.grid;
  input.model = &model.surface;
  input.frame = &frame.inverse_depth;
  input.features = &features;
  input.focal_length = sensor.camera.fx;
  input.has_distortion = sensor.camera.has_distortion();
  input.noise = sensor.noise;
  input.T_depth_color = frame.T_depth_color;
  const Pose start = align_features(input, T_keyframe_frame_predicted, kInitialScale);
  Alignment alignment = align(input, start, parallelism);
  alignment.evidence = compare_views(
      sensor.grid, sensor.noise, {&model.inverse_depth, model.texture, model.T_depth_color},
      {&frame.inverse_depth, frame.texture, frame.T_depth_color}, alignment.T_model_frame);
  return alignment;
}

}  // namespace pcavr::tracking
