// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/camera_verification.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "camera_scene.hpp"
#include "perception/tracking/camera_features.hpp"
#include "perception/tracking/camera_graph.hpp"

namespace pcavr::tracking {
namespace {

using camera_scene::a_camera;
using camera_scene::look_at;
using camera_scene::render;
using camera_scene::Scene;

/// Two views of the table, 13 cm apart.
class TwoViews {
 public:
  explicit TwoViews(bool is_bare, const Scene& second = {}) : grid_(a_camera()) {
    for (std::size_t i = 0; i < 2; ++i) {
      RgbdFrame frame = render(i == 0 ? Scene() : second, a_camera(), pose(i), pose(i), i);
      if (is_bare) {
        std::fill(frame.color.pixels().begin(), frame.color.pixels().end(), Rgb8{90, 90, 90});
      }
      depth_[i] = cell_inverse_depth(grid_, frame.depth, {}, DepthNoise());
      views_[i] = {&depth_[i], cell_texture(grid_, to_gray_mat(frame.color)), Pose()};
    }
  }

  /// Evidence with an error of the second view's pose along the table [m].
  [[nodiscard]] Evidence evidence(double slide = 0.0) const {
    const Pose second(pose(1).rotation(), pose(1).translation() + Eigen::Vector3d(0.0, slide, 0.0));
    return compare_views(grid_, DepthNoise(), views_[0], views_[1], pose(0).inverse() * second);
  }

 private:
  static Pose pose(std::size_t i) {
    const double along = 0.13 * static_cast<double>(i);
    return look_at({-0.9, along, 0.7}, {0.1, 0.5 * along, 0.0});
  }

  CellGrid grid_;
  InverseDepth depth_[2];
  View views_[2];
};

TEST(CompareViews, TextureRefusesAPoseThatHasSlidAlongTheTable) {
  const TwoViews views(false);
  ASSERT_TRUE(views.evidence().correlation);
  EXPECT_GT(*views.evidence().correlation, 0.8);
  EXPECT_LT(views.evidence().contradicted, 0.01);
  EXPECT_TRUE(views.evidence().is_plausible({}));
  EXPECT_LT(*views.evidence(-0.15).correlation, 0.2);
  EXPECT_FALSE(views.evidence(-0.15).is_plausible({}));
}

TEST(CompareViews, WithoutTextureSeesSurfaceWhereTheOtherViewLookedThrough) {
  const TwoViews views(true);
  EXPECT_FALSE(views.evidence().correlation);
  EXPECT_TRUE(views.evidence().is_plausible({}));
  EXPECT_GT(views.evidence(-0.3).contradicted, CameraTrackerOptions().max_contradicted);
  EXPECT_FALSE(views.evidence(-0.3).is_plausible({}));
}

TEST(CompareViews, AllowsThingsThatMoved) {
  Scene moved;
  moved.blocks[0].translate(Eigen::Vector3d(-0.2, -0.2, 0.0));
  moved.first_block_motion = Eigen::Vector3d(-0.2, -0.2, 0.0);
  const TwoViews views(false, moved);
  EXPECT_GT(views.evidence().contradicted, 0.02);
  EXPECT_TRUE(views.evidence().is_plausible({}));
}

/// A row of nodes that are linked without error, whose priors have these errors along y [m].
PoseGraph graph_with_priors(const std::vector<double>& errors) {
  constexpr double kStd = 0.005;
  PoseGraph graph(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const Eigen::Vector3d p(0.1 * static_cast<double>(i), 0.0, 0.0);
    const std::size_t node = graph.add_node(Pose::from_translation(p));
    if (i > 0) {
      graph.add_link(node - 1, node, Pose::from_translation({0.1, 0.0, 0.0}),
                     1e8 * Matrix6d::Identity());
    }
    graph.add_prior(node, Pose::from_translation(p + Eigen::Vector3d(0.0, errors[i], 0.0)), kStd,
                    kStd);
  }
  graph.solve();
  return graph;
}

TEST(PoseGraph, IsLessCertainWhereThePriorsScatterMoreThanStated) {
  const PoseGraph exact = graph_with_priors({0.004, -0.004, 0.004, -0.004, 0.004, -0.004});
  EXPECT_EQ(exact.prior_scatter(1), 1.0);
  PoseGraph rough = graph_with_priors({0.03, -0.03, 0.03, -0.03, 0.03, -0.03});
  const double scatter = rough.prior_scatter(1);
  EXPECT_GT(scatter, 1.5);
  const double before = rough.node_stds({0}).front().value().position;
  const Pose pose = rough.pose(0);
  rough.scale_priors(scatter);
  EXPECT_GT(rough.node_stds({0}).front().value().position, 1.2 * before);
  EXPECT_EQ(rough.pose(0).matrix(), pose.matrix());
}

TEST(PoseGraph, IsAsCertainWithOneOutlierAmongManyPriors) {
  std::vector<double> errors(20, 0.004);
  errors[7] = 0.3;
  EXPECT_LT(graph_with_priors(errors).prior_scatter(1), 1.1);
}

}  // namespace
}  // namespace pcavr::tracking
