// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/robot_collision.hpp"

#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "surface_tree.hpp"

namespace pcavr {
namespace {

/// [m] of two links at the reference position; nearer ones, as in a wrist, are always near.
constexpr double kMinReferenceDistance = 0.02;

struct LinkCapsule {
  std::size_t link = 0;
  std::optional<std::size_t> joint;
  bool meets_surfaces = false;
  Capsule in_link;
  Capsule in_base = {};
};

struct PlacedSurface {
  robot::SurfaceTree tree;
  Pose T_surface_base;
  std::vector<std::optional<std::uint32_t>> nearest;  ///< triangle of the last call, by capsule
};

double distance_of(const SegmentDistance& segments, double radius) {
  return std::sqrt(segments.squared) - radius;
}

/// Whether two links are fixed to each other or joined by one joint.
bool are_neighbours(const RobotModel& model, const LinkCapsule& a, const LinkCapsule& b) {
  if (a.joint == b.joint) return true;
  const auto carries = [&](const LinkCapsule& parent, const LinkCapsule& child) {
    return child.joint && model.joints[*child.joint].parent == parent.joint;
  };
  return carries(a, b) || carries(b, a);
}

}  // namespace

struct RobotCollision::Content {
  std::vector<LinkCapsule> links;
  std::vector<std::pair<std::size_t, std::size_t>> counted;  ///< of `links`
  std::vector<PlacedSurface> surfaces;

  void place(const RobotDynamics& robot) noexcept {
    for (LinkCapsule& link : links) {
      const Pose T_base_link = robot.T_base_link(link.link);
      link.in_base = {T_base_link * link.in_link.a, T_base_link * link.in_link.b,
                      link.in_link.radius};
    }
  }

  [[nodiscard]] NearestPair between(std::size_t i, std::size_t k) const noexcept {
    const Capsule& a = links[i].in_base;
    const Capsule& b = links[k].in_base;
    const SegmentDistance segments = segment_segment_distance(a.a, a.b, b.a, b.b);
    return {distance_of(segments, a.radius + b.radius),
            links[i].link,
            links[k].link,
            std::nullopt,
            segments.on_segment,
            segments.on_other};
  }
};

RobotCollision::RobotCollision(const RobotModel& model, const std::vector<TriangleMesh>& meshes,
                               std::size_t tip, const Eigen::VectorXd& q_reference)
    : content_(std::make_unique<Content>()) {
  PCAVR_REQUIRE(meshes.size() == model.links.size() && tip < model.links.size());
  const std::optional<std::size_t> tip_joint = model.links[tip].joint;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::optional<Capsule> capsule = enclosing_capsule(meshes[i].vertices);
    if (!capsule) continue;
    const std::optional<std::size_t> joint = model.links[i].joint;
    content_->links.push_back({i, joint, joint && joint != tip_joint, *capsule});
  }
  RobotDynamics robot(model);
  robot.forward_kinematics(q_reference);
  content_->place(robot);
  for (std::size_t i = 0; i < content_->links.size(); ++i) {
    for (std::size_t k = i + 1; k < content_->links.size(); ++k) {
      if (are_neighbours(model, content_->links[i], content_->links[k])) continue;
      if (content_->between(i, k).distance > kMinReferenceDistance)
        content_->counted.emplace_back(i, k);
    }
  }
}
RobotCollision::RobotCollision(RobotCollision&&) noexcept = default;
RobotCollision& RobotCollision::operator=(RobotCollision&&) noexcept = default;
RobotCollision::~RobotCollision() = default;

std::size_t RobotCollision::add_surface(const TriangleMesh& mesh) {
  content_->surfaces.push_back({robot::SurfaceTree(mesh), Pose(),
                                std::vector<std::optional<std::uint32_t>>(content_->links.size())});
  return content_->surfaces.size() - 1;
}

void RobotCollision::place_surface(std::size_t surface, const Pose& T_base_surface) {
  PCAVR_REQUIRE(surface < content_->surfaces.size());
  content_->surfaces[surface].T_surface_base = T_base_surface.inverse();
}

void RobotCollision::place_links(const RobotDynamics& robot) { content_->place(robot); }

std::optional<NearestPair> RobotCollision::distance_to_itself() const noexcept {
  std::optional<NearestPair> nearest;
  for (const auto& [i, k] : content_->counted) {
    const NearestPair pair = content_->between(i, k);
    if (!nearest || pair.distance < nearest->distance) nearest = pair;
  }
  return nearest;
}

std::optional<NearestPair> RobotCollision::distance_to_surfaces(double reach) noexcept {
  std::optional<NearestPair> nearest;
  double limit = reach;
  for (std::size_t s = 0; s < content_->surfaces.size(); ++s) {
    PlacedSurface& surface = content_->surfaces[s];
    for (std::size_t i = 0; i < content_->links.size(); ++i) {
      const LinkCapsule& link = content_->links[i];
      if (!link.meets_surfaces || limit + link.in_base.radius <= 0.0) continue;
      const Eigen::Vector3d a = surface.T_surface_base * link.in_base.a;
      const Eigen::Vector3d b = surface.T_surface_base * link.in_base.b;
      const double within = limit + link.in_base.radius;
      SegmentDistance best{within * within, a, a};
      std::optional<std::uint32_t>& guess = surface.nearest[i];
      bool is_nearer = false;
      if (guess) {
        const SegmentDistance guessed = surface.tree.distance_to(*guess, a, b);
        is_nearer = guessed.squared < best.squared;
        if (is_nearer) best = guessed;
      }
      if (const auto found = surface.tree.find_nearer(a, b, best)) {
        guess = found;
        is_nearer = true;
      }
      if (!is_nearer) continue;
      limit = distance_of(best, link.in_base.radius);
      const Pose T_base_surface = surface.T_surface_base.inverse();
      nearest = NearestPair{limit,
                            link.link,
                            std::nullopt,
                            s,
                            T_base_surface * best.on_segment,
                            T_base_surface * best.on_other};
    }
  }
  return nearest;
}

std::vector<std::pair<std::size_t, Capsule>> RobotCollision::capsules() const {
  std::vector<std::pair<std::size_t, Capsule>> all;
  for (const LinkCapsule& link : content_->links) all.emplace_back(link.link, link.in_base);
  return all;
}

std::size_t RobotCollision::pairs() const { return content_->counted.size(); }

}  // namespace pcavr
