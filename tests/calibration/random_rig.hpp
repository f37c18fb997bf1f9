// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr {

inline Eigen::Vector3d normal_vector(Random& random, double std) {
  return {std * random.normal(), std * random.normal(), std * random.normal()};
}

/// A camera at the flange, or beside the arm, that looks at a board from around it, with noise as
/// HandEyeNoise states it.
struct RandomRig {
  struct Options {
    CameraMount mount = CameraMount::arm;
    int views = 25;
    double max_tilt = 0.6;  ///< [rad] of the camera about the board
    HandEyeNoise noise = {.arm_position = 5e-4,
                          .arm_rotation = 5e-4,
                          .camera_across = 5e-4,
                          .camera_depth = 2e-3,
                          .camera_rotation = 2e-3};
    bool is_one_axis = false;  ///< the flange turns about the vertical only
  };

  Pose T_mount_camera;
  Pose T_world_board;
  std::vector<HandEyeView> views;

  RandomRig(std::uint64_t seed, const Options& options) {
    Random random(seed);
    Vector6d camera, board;
    camera << normal_vector(random, 0.05), normal_vector(random, 1.0);
    board << 0.5, 0.1, 0.0, normal_vector(random, 0.5);
    T_mount_camera = Pose::exp(camera);
    T_world_board = Pose::exp(board);
    for (int i = 0; i < options.views; ++i) add_view(i, options, random);
  }

 private:
  void add_view(int index, const Options& options, Random& random) {
    const double distance = random.uniform(0.3, 0.9);
    const Eigen::Vector3d tilt = options.is_one_axis
                                     ? Eigen::Vector3d(0.0, 0.0, random.uniform(-1.0, 1.0))
                                     : Eigen::Vector3d(random.uniform(-1.0, 1.0) * options.max_tilt,
                                                       random.uniform(-1.0, 1.0) * options.max_tilt,
                                                       random.uniform(-1.0, 1.0));
    Vector6d turn = Vector6d::Zero();
    turn.tail<3>() = tilt;
    // The camera looks along its z at the board, off its centre by a tenth of the distance.
    const Pose T_camera_centre = Pose::from_translation(
        {0.1 * distance * random.normal(), 0.1 * distance * random.normal(), distance});
    const Pose T_camera_board = T_camera_centre * Pose::exp(turn);
    const Pose T_world_mount = T_world_board * T_camera_board.inverse() * T_mount_camera.inverse();
    const bool is_on_arm = options.mount == CameraMount::arm;
    Pose T_base_flange = is_on_arm ? T_world_mount : T_world_mount.inverse();
    views.push_back({"view " + std::to_string(index),
                     with_arm_noise(T_base_flange, options, random),
                     with_camera_noise(T_camera_board, options, random)});
  }

  static Pose turned(const Pose& pose, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
    Vector6d twist = Vector6d::Zero();
    twist.tail<3>() = turn;
    return Pose(Pose::exp(twist).rotation() * pose.rotation(), pose.translation() + shift);
  }
  static Pose with_arm_noise(const Pose& pose, const Options& options, Random& random) {
    return turned(pose, normal_vector(random, options.noise.arm_rotation),
                  normal_vector(random, options.noise.arm_position));
  }
  static Pose with_camera_noise(const Pose& pose, const Options& options, Random& random) {
    const double distance = pose.translation().norm();
    const Eigen::Vector3d sight = pose.translation() / distance;
    const Eigen::Vector3d across = normal_vector(random, options.noise.camera_across * distance);
    const double depth = options.noise.camera_depth * distance * distance * random.normal();
    return turned(pose, normal_vector(random, options.noise.camera_rotation),
                  across - across.dot(sight) * sight + depth * sight);
  }
};

}  // namespace pcavr
