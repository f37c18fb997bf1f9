// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// DART (Debian libdart-dev, libdart-collision-ode-dev): dart_engine JOBS
// options: along: the friction pyramid's first axis is along the slip of the point. A body with a
// law has friction by slip speed.
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <dart/collision/ode/OdeCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>

#include "experiment.hpp"

namespace engines {
namespace {

namespace dynamics = dart::dynamics;

Eigen::Vector3d eigen(const Vector& v) { return {v[0], v[1], v[2]}; }
Vector numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Quaterniond quaternion(const Json& q) { return {q[3], q[0], q[1], q[2]}; }

Eigen::Isometry3d pose_of(const Json& json) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(eigen(vector_of(json["position"])));
  pose.rotate(quaternion(json["quaternion"]));
  return pose;
}

/// The body's triangles, through assimp, which DART's meshes are of.
std::shared_ptr<dynamics::MeshShape> mesh_of(const Json& body) {
  std::ostringstream text;
  text.precision(17);
  for (const Json& p : body["points"]) text << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const Json& t : body["triangles"]) {
    text << 'f';
    for (const int index : t) text << ' ' << index + 1;
    text << '\n';
  }
  const std::string obj = text.str();
  const aiScene* scene =
      aiImportFileFromMemory(obj.data(), static_cast<unsigned>(obj.size()), aiProcess_GenNormals,
                             "obj");  // which the detector reads
  return std::make_shared<dynamics::MeshShape>(Eigen::Vector3d::Ones(), scene);
}

class DartEngine : public Engine {
 public:
  explicit DartEngine(const Json& job)
      : is_along_(job["options"].value("along", false)),
        law_(job["world"]["body"]),
        world_(dart::simulation::World::create()) {
    const Json& world = job["world"];
    world_->setGravity(eigen(vector_of(world["gravity"])));
    world_->setTimeStep(job["experiment"]["dt"]);
    // As Gazebo uses DART; its own detector has no meshes.
    world_->getConstraintSolver()->setCollisionDetector(
        dart::collision::OdeCollisionDetector::create());
    for (const Json& support : world["supports"]) add_support(support, world);
    add_body(world["body"]);
    tool_ = add_free_body("tool");
    tool_->setMass(kToolMass);
    tool_->setMomentOfInertia(kToolMass, kToolMass, kToolMass);
    tool_->setGravityMode(false);
    add_shape(tool_, std::make_shared<dynamics::SphereShape>(world["tool_radius"].get<double>()),
              world["tip_friction"]);
  }

  void step() override {
    const double share = law_.share(state());
    for (const Foot& foot : feet_) {
      foot.shape->getDynamicsAspect()->setFrictionCoeff(share * foot.friction);
      if (is_along_) set_axis(foot.shape);
    }
    world_->step();
  }

  void set_tool(const Vector& position, const Vector& velocity) override {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translate(eigen(position));
    joint_of(tool_)->setTransform(pose);
    joint_of(tool_)->setLinearVelocity(eigen(velocity));
    joint_of(tool_)->setAngularVelocity(Eigen::Vector3d::Zero());
    wanted_ = eigen(velocity);
  }

  [[nodiscard]] Vector tool_force() const override {
    return numbers((wanted_ - tool_->getLinearVelocity()) * kToolMass / world_->getTimeStep());
  }

  [[nodiscard]] BodyState state() const override {
    const Eigen::Isometry3d& pose = body_->getTransform();
    const Eigen::Quaterniond q(pose.linear());
    return {numbers(pose.translation()),
            {q.x(), q.y(), q.z(), q.w()},
            numbers(body_->getCOMLinearVelocity()),
            numbers(body_->getAngularVelocity())};
  }

  void set_velocity(const Vector& linear, const Vector& angular) override {
    const Eigen::Vector3d arm = body_->getCOM() - body_->getTransform().translation();
    joint_of(body_)->setAngularVelocity(eigen(angular));
    joint_of(body_)->setLinearVelocity(eigen(linear) - eigen(angular).cross(arm));
  }

  void apply_wrench(const Vector& force, const Vector& torque) override {
    body_->addExtForce(eigen(force), body_->getLocalCOM(), false, true);
    body_->addExtTorque(eigen(torque), false);
  }

 private:
  struct Foot {
    dynamics::ShapeNode* shape;
    double friction;  ///< as exported
  };

  static dynamics::FreeJoint* joint_of(dynamics::BodyNode* body) {
    return static_cast<dynamics::FreeJoint*>(body->getParentJoint());
  }

  dynamics::BodyNode* add_free_body(const std::string& name) {
    const auto skeleton = dynamics::Skeleton::create(name);
    auto* body = skeleton->createJointAndBodyNodePair<dynamics::FreeJoint>().second;
    world_->addSkeleton(skeleton);
    return body;
  }

  /// `friction` null: DART's own coefficient, 1.
  static dynamics::ShapeNode* add_shape(dynamics::BodyNode* body,
                                        const std::shared_ptr<dynamics::Shape>& shape,
                                        const Json& friction) {
    auto* node =
        body->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
    if (!friction.is_null()) node->getDynamicsAspect()->setFrictionCoeff(friction.get<double>());
    return node;
  }

  /// Its upper side, as a plane: triangle meshes meet planes, and not boxes, at their vertices.
  void add_support(const Json& support, const Json& world) {
    const Eigen::Isometry3d pose = pose_of(support);
    const Eigen::Vector3d normal = pose.linear().col(2);
    const double half = support["size"][2].get<double>() / 2.0;
    const auto skeleton =
        dynamics::Skeleton::create("support_" + std::to_string(world_->getNumSkeletons()));
    auto* body = skeleton->createJointAndBodyNodePair<dynamics::WeldJoint>().second;
    add_shape(body,
              std::make_shared<dynamics::PlaneShape>(normal, normal.dot(pose.translation()) + half),
              world["partner_friction"]);
    world_->addSkeleton(skeleton);
  }

  void add_body(const Json& body) {
    body_ = add_free_body("body");
    const Eigen::Matrix3d axes = quaternion(body["inertia_quaternion"]).toRotationMatrix();
    const Eigen::Matrix3d inertia =
        axes * eigen(vector_of(body["inertia"])).asDiagonal() * axes.transpose();
    body_->setInertia(
        dynamics::Inertia(body["mass"], eigen(vector_of(body["centre_of_mass"])), inertia));
    add_shape(body_, mesh_of(body), body["friction"]);
    for (const Json& foot : body["feet"]) {
      const auto sphere = std::make_shared<dynamics::SphereShape>(foot["radius"].get<double>());
      feet_.push_back({add_shape(body_, sphere, foot["friction"]), foot["friction"]});
      feet_.back().shape->setRelativeTranslation(eigen(vector_of(foot["centre"])));
    }
    joint_of(body_)->setTransform(pose_of(body));
  }

  /// Of a foot that slides: friction along its slip, none across.
  void set_axis(dynamics::ShapeNode* foot) {
    constexpr double kMinSpeed = 1e-3;  // [m/s] of sliding: slower, it may come to rest
    auto* aspect = foot->getDynamicsAspect();
    const Eigen::Vector3d slip = body_->getLinearVelocity(foot->getRelativeTranslation());
    const double speed = std::hypot(slip.x(), slip.y());
    const bool is_sliding = speed >= kMinSpeed;
    const double mu = aspect->getPrimaryFrictionCoeff();
    aspect->setSecondaryFrictionCoeff(is_sliding ? 0.0 : mu);
    aspect->setFirstFrictionDirectionFrame(dynamics::Frame::World());
    aspect->setFirstFrictionDirection(is_sliding
                                          ? Eigen::Vector3d(slip.x() / speed, slip.y() / speed, 0.0)
                                          : Eigen::Vector3d::Zero());
  }

  bool is_along_;
  FrictionLaw law_;
  dart::simulation::WorldPtr world_;
  dynamics::BodyNode* body_ = nullptr;
  dynamics::BodyNode* tool_ = nullptr;
  std::vector<Foot> feet_;
  Eigen::Vector3d wanted_ = Eigen::Vector3d::Zero();
};

}  // namespace
}  // namespace engines

int main(int argc, char** argv) {
  return engines::run_jobs(argc, argv, [](const engines::Json& job) {
    return std::make_unique<engines::DartEngine>(job);
  });
}
