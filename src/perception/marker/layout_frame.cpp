// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/layout_frame.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

/// A tag that is further from its stated pose has moved, or was measured wrongly [m, rad]: rulers
/// and glued paper are off by a few millimetres and a degree.
constexpr double kMaxRulerOffset = 5e-3;
constexpr double kMaxRulerRotation = 2.0 * std::numbers::pi / 180.0;
constexpr int kAlignIterations = 10;

using Indices = std::vector<std::size_t>;

/// A corner of a tag in the layout, by a twist of the whole layout, and by one of its tag.
struct CornerJacobians {
  Eigen::Matrix<double, 3, 6> layout, tag;
};

CornerJacobians corner_jacobians(const Pose& T_layout_tag, const Eigen::Vector3d& corner) {
  const Eigen::Vector3d p = T_layout_tag * corner;
  const Eigen::Matrix3d R = T_layout_tag.rotation_matrix();
  CornerJacobians jacobians;
  jacobians.layout << Eigen::Matrix3d::Identity(), -skew(p);
  jacobians.tag << R, -R * skew(corner);
  return jacobians;
}

/// The pose of the layout that brings the corners of these tags closest to where they are said to
/// be.
Pose aligned(const std::vector<LayoutTag>& tags, const std::vector<Pose>& T_layout_tag,
             const Indices& references) {
  const std::size_t first = references.front();
  Pose T_body_layout = *tags[first].T_body_tag * T_layout_tag[first].inverse();
  for (int i = 0; i < kAlignIterations; ++i) {
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero();
    for (const std::size_t tag : references) {
      for (const Eigen::Vector3d& corner : tag_corners(tags[tag].size)) {
        const Eigen::Matrix<double, 3, 6> J = corner_jacobians(T_layout_tag[tag], corner).layout;
        const Eigen::Vector3d stated_layout =
            T_body_layout.inverse() * (*tags[tag].T_body_tag * corner);
        matrix += J.transpose() * J;
        gradient += J.transpose() * (stated_layout - T_layout_tag[tag] * corner);
      }
    }
    T_body_layout = T_body_layout * Pose::exp(matrix.ldlt().solve(gradient));
  }
  return T_body_layout;
}

/// The tags that are where they are said to be when the layout is there.
Indices agreeing(const std::vector<LayoutTag>& tags, const std::vector<Pose>& T_layout_tag,
                 const Pose& T_body_layout) {
  Indices found;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i].T_body_tag) continue;
    if (!shift_of(T_body_layout * T_layout_tag[i], *tags[i].T_body_tag).has_moved) {
      found.push_back(i);
    }
  }
  return found;
}

/// The largest set of two or more tags that agree; empty where none is larger than another one that
/// it has no tag in common with.
Indices largest_agreeing_set(const std::vector<LayoutTag>& tags,
                             const std::vector<Pose>& T_layout_tag, const Indices& stated) {
  Indices best;
  bool is_alone = true;
  for (std::size_t a = 0; a < stated.size(); ++a) {
    for (std::size_t b = a + 1; b < stated.size(); ++b) {
      Indices set{stated[a], stated[b]};
      for (int round = 0; round < 3 && set.size() >= 2; ++round) {
        set = agreeing(tags, T_layout_tag, aligned(tags, T_layout_tag, set));
      }
      if (set.size() < 2 || set.size() < best.size()) continue;
      Indices common;
      std::set_intersection(set.begin(), set.end(), best.begin(), best.end(),
                            std::back_inserter(common));
      if (set.size() > best.size()) {
        best = set;
        is_alone = true;
      } else if (common.empty()) {
        is_alone = false;
      }
    }
  }
  return is_alone ? best : Indices{};
}

Error disagreement(const std::vector<LayoutTag>& tags, const std::vector<Pose>& T_layout_tag,
                   const Indices& stated) {
  std::string names;
  for (const std::size_t i : stated) {
    names += (names.empty() ? "" : ", ") + tags[i].id.to_string();
  }
  const std::size_t a = stated.front(), b = stated.back();
  const TagShift shift = shift_of(*tags[a].T_body_tag * T_layout_tag[a].inverse() * T_layout_tag[b],
                                  *tags[b].T_body_tag);
  return {
      .message = fmt::format(
          "the stated poses of {} disagree with the images: seen from {}, {} is {:.0f} mm and "
          "{:.1f} degrees from where it is said to be, and no more tags agree with one than "
          "with the other",
          names, tags[a].id.to_string(), tags[b].id.to_string(), 1e3 * shift.offset,
          180.0 / std::numbers::pi * shift.rotation),
      .hint = fmt::format("name the one that has not moved: --fixed {}", tags[a].id.to_string())};
}

}  // namespace

TagShift shift_of(const Pose& T_body_tag, const Pose& T_body_tag_stated) {
  TagShift shift{translation_distance(T_body_tag, T_body_tag_stated),
                 rotation_distance(T_body_tag, T_body_tag_stated)};
  shift.has_moved = shift.offset > kMaxRulerOffset || shift.rotation > kMaxRulerRotation;
  return shift;
}

Expected<LayoutFrame> find_layout_frame(const std::vector<LayoutTag>& tags,
                                        const std::vector<Pose>& T_layout_tag) {
  LayoutFrame frame;
  Indices stated;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i].T_body_tag) continue;
    stated.push_back(i);
    if (tags[i].is_fixed) frame.references.push_back(i);
  }
  if (frame.references.empty() && stated.size() > 1) {
    frame.references = largest_agreeing_set(tags, T_layout_tag, stated);
    if (frame.references.empty()) return disagreement(tags, T_layout_tag, stated);
  } else if (frame.references.empty()) {
    frame.references = stated;
  }
  frame.T_body_layout = frame.references.empty() ? T_layout_tag.front().inverse()
                                                 : aligned(tags, T_layout_tag, frame.references);
  return frame;
}

Eigen::MatrixXd covariance_in_frame(const std::vector<LayoutTag>& tags,
                                    const std::vector<Pose>& T_layout_tag,
                                    const std::vector<std::size_t>& references,
                                    const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = covariance.rows();
  // The frame follows the references: its twist is the least-squares one of their corners.
  Matrix6d matrix = Matrix6d::Zero();
  Eigen::MatrixXd by_tags = Eigen::MatrixXd::Zero(6, n);
  for (const std::size_t tag : references) {
    for (const Eigen::Vector3d& corner : tag_corners(tags[tag].size)) {
      const CornerJacobians J = corner_jacobians(T_layout_tag[tag], corner);
      matrix += J.layout.transpose() * J.layout;
      by_tags.middleCols<6>(6 * static_cast<Eigen::Index>(tag)) += J.layout.transpose() * J.tag;
    }
  }
  const Eigen::MatrixXd frame_by_tags = matrix.ldlt().solve(by_tags).eval();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t tag = 0; tag < tags.size(); ++tag) {
    // A twist of the layout, expressed in the tag's axes (the adjoint of the inverse pose).
    const Eigen::Matrix3d R = T_layout_tag[tag].rotation_matrix().transpose();
    Matrix6d adjoint = Matrix6d::Zero();
    adjoint.topLeftCorner<3, 3>() = R;
    adjoint.bottomRightCorner<3, 3>() = R;
    adjoint.topRightCorner<3, 3>() = -R * skew(T_layout_tag[tag].translation());
    jacobian.middleRows<6>(6 * static_cast<Eigen::Index>(tag)) -= adjoint * frame_by_tags;
  }
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace pcavr
