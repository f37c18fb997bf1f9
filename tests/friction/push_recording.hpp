// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/physics/friction/limit_surface_fit.hpp"

namespace pcavr {

/// Reader of the planar pushes of Zhou et al. (2016), see ABOUT.md next to them: poses before and
/// after, force in the finger's frame, the finger's path; lengths in millimetres.
class PushRecording {
 public:
  struct Push {
    Eigen::Vector3d before, after;        // x, y [m], yaw [rad] of the block's corner
    std::vector<Eigen::Vector3d> forces;  // t [s], fx, fy [N], finger frame
    std::vector<Eigen::Vector4d> finger;  // t [s], x, y [m], yaw [rad]
  };

  explicit PushRecording(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::size_t count = 0;
    file >> count;
    while (file && pushes_.size() < count) pushes_.push_back(read_push(file));
  }

  [[nodiscard]] std::size_t size() const { return pushes_.size(); }
  [[nodiscard]] const Push& operator[](std::size_t i) const { return pushes_[i]; }

  /// Mean wrench and whole displacement of one push, at the block's centre of mass, body axes.
  [[nodiscard]] PushSample sample(std::size_t i) const {
    const Push& push = pushes_[i];
    const Eigen::Vector3d before = at_centre_of_mass(push.before);
    const Eigen::Vector3d after = at_centre_of_mass(push.after);
    std::vector<std::size_t> rows = loaded_rows(push.forces);
    PushSample sample;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const double fraction = rows.size() < 2 ? 0.5 : double(k) / double(rows.size() - 1);
      const Eigen::Vector3d pose = before + fraction * (after - before);
      const Eigen::Vector4d finger = interpolate(push.finger, push.forces[rows[k]].x());
      const Eigen::Matrix2d to_body = Eigen::Rotation2Dd(-pose.z()).toRotationMatrix();
      const Eigen::Vector2d force =
          to_body * Eigen::Rotation2Dd(finger.w()) * applied_force(push, rows[k]);
      const Eigen::Vector2d arm = to_body * (finger.segment<2>(1) - pose.head<2>());
      sample.wrench +=
          Eigen::Vector3d(force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x());
    }
    sample.wrench /= std::max<double>(1.0, double(rows.size()));
    sample.twist = after - before;
    const double middle = 0.5 * (before.z() + after.z());
    sample.twist.head<2>() = Eigen::Rotation2Dd(-middle) * sample.twist.head<2>();
    return sample;
  }

 private:
  static double yaw_of(double qw, double qx, double qy, double qz) {
    return std::atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz));
  }
  static Eigen::Vector3d read_pose(std::istream& file) {
    double x, y, z, qw, qx, qy, qz;
    file >> x >> y >> z >> qw >> qx >> qy >> qz;
    return {0.001 * x, 0.001 * y, yaw_of(qw, qx, qy, qz)};
  }
  static Push read_push(std::istream& file) {
    Push push;
    push.before = read_pose(file);
    push.after = read_pose(file);
    push.after.z() = push.before.z() + std::remainder(push.after.z() - push.before.z(), 2 * M_PI);
    std::size_t rows = 0;
    file >> rows;
    for (std::size_t i = 0; i < rows && file; ++i) {
      Eigen::Vector3d row;
      file >> row.x() >> row.y() >> row.z();
      push.forces.push_back(row);
    }
    file >> rows;
    for (std::size_t i = 0; i < rows && file; ++i) {
      double t;
      file >> t;
      const Eigen::Vector3d pose = read_pose(file);
      push.finger.emplace_back(t, pose.x(), pose.y(), pose.z());
    }
    return push;
  }

  /// Force on the block, in the finger's frame, with the first sample as the sensor's bias.
  static Eigen::Vector2d applied_force(const Push& push, std::size_t row) {
    const double c = std::sqrt(0.5);
    Eigen::Matrix2d sensor;
    sensor << c, c, c, -c;
    return -(sensor * (push.forces[row] - push.forces.front()).tail<2>());
  }
  static Eigen::Vector3d at_centre_of_mass(const Eigen::Vector3d& corner) {
    Eigen::Vector3d pose = corner;
    pose.head<2>() += Eigen::Rotation2Dd(corner.z()) * Eigen::Vector2d(0.05, 0.05);
    return pose;
  }
  /// Rows with more than the push's mean force, of the last 70 %.
  static std::vector<std::size_t> loaded_rows(const std::vector<Eigen::Vector3d>& forces) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto& row : forces) mean += (row - forces.front()).tail<2>();
    mean /= double(forces.size());
    std::vector<std::size_t> rows;
    for (std::size_t i = forces.size() * 3 / 10; i < forces.size(); ++i) {
      if ((forces[i] - forces.front()).tail<2>().squaredNorm() >= mean.squaredNorm()) {
        rows.push_back(i);
      }
    }
    return rows;
  }
  static Eigen::Vector4d interpolate(const std::vector<Eigen::Vector4d>& path, double t) {
    std::size_t i = 1;
    while (i + 1 < path.size() && path[i].x() < t) ++i;
    const double span = path[i].x() - path[i - 1].x();
    const double fraction = std::clamp((t - path[i - 1].x()) / span, 0.0, 1.0);
    return path[i - 1] + fraction * (path[i] - path[i - 1]);
  }

  std::vector<Push> pushes_;
};

}  // namespace pcavr
