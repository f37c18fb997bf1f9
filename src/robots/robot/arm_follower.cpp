// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/robot/arm_follower.hpp"

#include "pcavr/base/core/check.hpp"

namespace pcavr {

struct ArmFollower::Content {
  Content(const RobotModel& model, const std::vector<TriangleMesh>& meshes, std::size_t tip_link,
          const Eigen::VectorXd& start, const ArmFollowerOptions& follower)
      : options(follower),
        tip(tip_link),
        kinematics(model),
        inverse(model, tip_link, follower.inverse_kinematics),
        collision(model, meshes, tip_link, start),
        q_start(start),
        q_next(start) {
    kinematics.forward_kinematics(start);
    q_base_tip = kinematics.T_base_link(tip).rotation();
    state.q = start;
    place(start);
  }

  /// The nearest pair at a position.
  std::optional<NearestPair> place(const Eigen::VectorXd& q) {
    kinematics.forward_kinematics(q);
    collision.place_links(kinematics);
    std::optional<NearestPair> nearest = collision.distance_to_itself();
    const double reach =
        nearest ? std::min(nearest->distance, options.shown_distance) : options.shown_distance;
    if (auto found = collision.distance_to_surfaces(reach)) nearest = found;
    if (nearest && nearest->distance > options.shown_distance) nearest.reset();
    return nearest;
  }

  ArmFollowerOptions options;
  std::size_t tip;
  RobotDynamics kinematics;
  InverseKinematics inverse;
  RobotCollision collision;
  Eigen::VectorXd q_start;
  Eigen::VectorXd q_next;
  Eigen::Quaterniond q_base_tip;
  ArmState state;
};

ArmFollower::ArmFollower(const RobotModel& model, const std::vector<TriangleMesh>& meshes,
                         std::size_t tip, const Eigen::VectorXd& q_start,
                         const ArmFollowerOptions& options)
    : content_(std::make_unique<Content>(model, meshes, tip, q_start, options)) {}
ArmFollower::ArmFollower(ArmFollower&&) noexcept = default;
ArmFollower& ArmFollower::operator=(ArmFollower&&) noexcept = default;
ArmFollower::~ArmFollower() = default;

std::size_t ArmFollower::add_surface(const TriangleMesh& mesh) {
  return content_->collision.add_surface(mesh);
}

void ArmFollower::place_surface(std::size_t surface, const Pose& T_base_surface) {
  content_->collision.place_surface(surface, T_base_surface);
}

void ArmFollower::reset() {
  Content& own = *content_;
  own.state.q = own.q_start;
  own.state.is_stopped = own.state.is_reached = false;
  own.state.nearest = own.place(own.q_start);
}

const ArmState& ArmFollower::follow(const Eigen::Vector3d& p_base_tip, double dt) {
  PCAVR_REQUIRE(dt > 0.0);
  Content& own = *content_;
  // Bodies may have moved since the last cycle: the present distance is measured anew.
  const std::optional<NearestPair> now = own.place(own.state.q);
  own.q_next = own.state.q;
  const IkResult found = own.inverse.follow(Pose(own.q_base_tip, p_base_tip), dt, own.q_next);
  const std::optional<NearestPair> next = own.place(own.q_next);
  const double closest_allowed =
      now ? std::min(now->distance, own.options.stop_distance) : own.options.stop_distance;
  own.state.is_stopped = next && next->distance < closest_allowed;
  own.state.is_reached = !own.state.is_stopped && found.status == IkStatus::kReached;
  own.state.nearest = own.state.is_stopped ? now : next;
  if (own.state.is_stopped) {
    if (!own.state.nearest) own.state.nearest = next;
    own.place(own.state.q);
  } else {
    own.state.q = own.q_next;
  }
  return own.state;
}

const ArmState& ArmFollower::state() const { return content_->state; }

Pose ArmFollower::T_base_tip() const { return content_->kinematics.T_base_link(content_->tip); }

}  // namespace pcavr
