// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/perception/marker/tag_layout.hpp"

#include "marker/tag_rendering.hpp"

namespace pcavr::test {

/// Tags on and above a table, tilted, and a walk of a camera around them. Corners have noise.
struct RandomLayout {
  struct Options {
    int tags = 4;
    int views = 25;
    double corner_std = 0.1;  ///< [px]
    /// By tag: its pose in world from the given view on.
    std::vector<Pose> T_world_moved = {};
    int moved_tag = -1;
    int moved_from = 0;
  };

  std::vector<LayoutTag> tags;  ///< with their true poses
  std::vector<std::vector<TagDetection>> frames;

  RandomLayout(std::uint64_t seed, const Options& options) {
    Random random(seed);
    for (int i = 0; i < options.tags; ++i) tags.push_back(random_tag(i, random));
    for (int view = 0; view < options.views; ++view) {
      const Pose T_camera_world =
          facing({random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.9, 1.5)},
                 random.uniform(0.2, 0.9), random.uniform(0.0, 6.28), random.uniform(-0.3, 0.3));
      std::vector<TagDetection>& frame = frames.emplace_back();
      for (int i = 0; i < options.tags; ++i) {
        const LayoutTag& tag = tags[static_cast<std::size_t>(i)];
        const bool is_moved = i == options.moved_tag && view >= options.moved_from;
        const Pose T_world_tag = is_moved ? options.T_world_moved.front() : *tag.T_body_tag;
        add_if_seen(tag, T_camera_world * T_world_tag, options.corner_std, random, frame);
      }
    }
  }

  /// The tags without their poses, but for the first `stated` ones.
  [[nodiscard]] std::vector<LayoutTag> with_stated(std::size_t stated) const {
    std::vector<LayoutTag> known = tags;
    for (std::size_t i = stated; i < known.size(); ++i) known[i].T_body_tag.reset();
    return known;
  }

 private:
  static LayoutTag random_tag(int number, Random& random) {
    Vector6d tilt = Vector6d::Zero();
    tilt.tail<3>() << random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5),
        random.uniform(-3.0, 3.0);
    const double angle = 1.57 * number + random.uniform(-0.4, 0.4);
    const double radius = 0.25 * (1.0 + random.uniform(-0.3, 0.3)) + 0.02 * number;
    const Eigen::Vector3d p(radius * std::cos(angle), radius * std::sin(angle),
                            random.uniform(0.0, 0.15));
    return {.id = {"tag36h11", number},
            .size = random.uniform(0.06, 0.12),
            .T_body_tag = Pose::from_translation(p) * Pose::exp(tilt)};
  }

  static void add_if_seen(const LayoutTag& tag, const Pose& T_camera_tag, double corner_std,
                          Random& random, std::vector<TagDetection>& frame) {
    const Eigen::Vector3d normal = T_camera_tag.rotation() * Eigen::Vector3d::UnitZ();
    if (normal.dot(T_camera_tag.translation().normalized()) > -0.3) return;
    TagDetection detection{.id = tag.id, .corners = {}};
    const auto corners = tag_corners(tag.size);
    for (std::size_t i = 0; i < 4; ++i) {
      detection.corners[i] = a_camera().project(T_camera_tag * corners[i]) +
                             corner_std * Eigen::Vector2d(random.normal(), random.normal());
      if (!a_camera().contains(detection.corners[i])) return;
    }
    frame.push_back(detection);
  }
};

}  // namespace pcavr::test
