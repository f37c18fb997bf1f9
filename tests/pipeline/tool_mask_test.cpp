// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/build/tool_mask.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/stamp.hpp"

namespace pcavr {
namespace {

constexpr float kWall = 1.5F;   // [m]
constexpr float kShaft = 1.0F;  // [m]
constexpr double kShaftHalfWidth = 0.012;

/// A horizontal camera 1 m above base that looks along base x. A thin shaft extends upwards from
/// the tip; the tip moves along y by a step per frame.
class ToolBeforeAWall : public testing::Test {
 protected:
  ToolBeforeAWall() {
    CameraModel camera;
    camera.width = 320;
    camera.height = 240;
    camera.fx = camera.fy = 300.0;
    camera.cx = 160.0;
    camera.cy = 120.0;
    recording_.manifest.camera = camera;
    recording_.manifest.tool_radius = 0.01;
    Eigen::Matrix3d R_base_camera;
    R_base_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T_base_camera_ = Pose(Eigen::Quaterniond(R_base_camera), Eigen::Vector3d::UnitZ());
    for (int i = 0; i < kFrames; ++i) {
      recording_.tool.append(stamp_of(i), Pose(Eigen::Quaterniond::Identity(), tip_at(i)));
    }
  }

  static constexpr int kFrames = 8;
  static Stamp stamp_of(int frame) { return Stamp::from_seconds(0.05 * frame); }
  static Eigen::Vector3d tip_at(int frame) { return {kShaft, -0.16 + 0.04 * frame, 0.95}; }

  /// The shaft, occluded by a body up to `hidden` [m] above the tip that is 0.2 m nearer; the body
  /// is marked in `mask`.
  RgbdFrame frame_of(int index, double hidden, MaskImage& mask) const {
    const CameraModel& camera = *recording_.manifest.camera;
    RgbdFrame frame;
    frame.index = static_cast<std::size_t>(index);
    frame.color_stamp = frame.depth_stamp = stamp_of(index);
    frame.depth = DepthImage(camera.width, camera.height);
    mask = MaskImage(camera.width, camera.height);
    const Eigen::Vector3d tip = T_base_camera_.inverse() * tip_at(index);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d p = camera.unproject(Eigen::Vector2d(u, v), kShaft);
        const double above = tip.y() - p.y();
        const bool is_body = hidden > 0.0 && above < hidden;
        const bool is_shaft = above > -0.01 && std::abs(p.x() - tip.x()) < kShaftHalfWidth;
        frame.depth(u, v) = is_body ? kShaft - 0.2F : is_shaft ? kShaft : kWall;
        mask(u, v) = is_body ? 1 : 0;
      }
    }
    return frame;
  }

  /// Shares of the shaft and of the wall that are marked.
  std::pair<double, double> marked(const RgbdFrame& frame, const MaskImage& mask) const {
    double shaft = 0, shaft_marked = 0, wall = 0, wall_marked = 0;
    for (int v = 0; v < frame.depth.height(); ++v) {
      for (int u = 0; u < frame.depth.width(); ++u) {
        (frame.depth(u, v) == kShaft ? shaft : wall) += frame.depth(u, v) >= kShaft ? 1 : 0;
        if (mask(u, v) == 0) continue;
        (frame.depth(u, v) == kShaft ? shaft_marked : wall_marked) +=
            frame.depth(u, v) >= kShaft ? 1 : 0;
      }
    }
    return {shaft_marked / shaft, wall_marked / wall};
  }

  Recording recording_;
  Pose T_base_camera_;
};

TEST_F(ToolBeforeAWall, IsMarkedFromTheTipUpwards) {
  ToolMask tool(recording_);
  MaskImage mask;
  const RgbdFrame frame = frame_of(0, 0.0, mask);
  tool.mark(frame, T_base_camera_, mask);
  const auto [shaft, wall] = marked(frame, mask);
  EXPECT_EQ(shaft, 1.0);
  EXPECT_LT(wall, 0.05);  // the dilated border, and the disc of the tip
}

TEST_F(ToolBeforeAWall, IsFoundAgainWhereABodyOccludesTheTip) {
  ToolMask tool(recording_);
  MaskImage mask;
  for (int i = 0; i + 1 < kFrames; ++i) {
    const RgbdFrame frame = frame_of(i, 0.0, mask);
    tool.mark(frame, T_base_camera_, mask);
  }
  const RgbdFrame hidden = frame_of(kFrames - 1, 0.1, mask);
  tool.mark(hidden, T_base_camera_, mask);
  const auto [shaft, wall] = marked(hidden, mask);
  EXPECT_EQ(shaft, 1.0);
  EXPECT_LT(wall, 0.05);
}

TEST_F(ToolBeforeAWall, IsNotMarkedWhereItsTipWasNeverVisible) {
  ToolMask tool(recording_);
  MaskImage mask;
  const RgbdFrame hidden = frame_of(0, 0.1, mask);
  tool.mark(hidden, T_base_camera_, mask);
  EXPECT_EQ(marked(hidden, mask).first, 0.0);
}

TEST(ToolShape, ContainsPointsThatMoveWithTheTipAndNoStaticOnes) {
  ToolShape shape;
  const Eigen::Vector3d along(0.0, 0.0, -0.1);
  const Eigen::Vector3d p_base_static(0.5, 0.2, 0.3);
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d tip(0.05 * i, 0.0, 0.0);
    shape.add(along, tip);
    shape.add(p_base_static - tip, tip);
  }
  ASSERT_EQ(shape.points().size(), 1u);
  EXPECT_LT((shape.points().front() - along).norm(), ToolShape::kEdge);
}

TEST(ToolShape, IsEmptyForATipAtRest) {
  ToolShape shape;
  for (int i = 0; i < 100; ++i) shape.add({0.0, 0.0, -0.1}, Eigen::Vector3d::Zero());
  EXPECT_TRUE(shape.points().empty());
}

}  // namespace
}  // namespace pcavr
