// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Bullet (Debian libbullet-dev): bullet_engine JOBS
// options: iterations of the solver; compliant: the tip's contact has the identified stiffness;
// feet_friction: each foot has its own coefficient, by a contact callback (a body has one). A body
// with a law has friction by slip speed.
#include <memory>
#include <string>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "experiment.hpp"

namespace engines {
namespace {

/// [m] Bullet's contacts need a margin about convex shapes. It is half of what feet stand out.
constexpr btScalar kMargin = 5e-5F;

btScalar scalar(double value) { return static_cast<btScalar>(value); }
btVector3 bullet(const Vector& v) { return {scalar(v[0]), scalar(v[1]), scalar(v[2])}; }
Vector numbers(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btQuaternion quaternion(const Json& q) {
  return {scalar(q[0]), scalar(q[1]), scalar(q[2]), scalar(q[3])};
}

/// Coefficients of the shapes of the body, by their index: of feet they differ.
std::vector<double>* child_friction = nullptr;
/// Of feet, the coefficient at the present slip over the exported one.
double feet_share = 1.0;

bool set_friction(btManifoldPoint& point, const btCollisionObjectWrapper* first, int,
                  int first_index, const btCollisionObjectWrapper* second, int, int second_index) {
  const bool is_first = first->getCollisionObject()->getUserIndex() == 1;
  const auto* other = is_first ? second : first;
  const int index = is_first ? first_index : second_index;
  if (child_friction == nullptr || index < 0 || other->getCollisionObject()->getUserIndex() != 0) {
    return false;
  }
  const double share = index == 0 ? 1.0 : feet_share;  // 0 is the body's own surface
  point.m_combinedFriction = scalar(share * (*child_friction)[static_cast<std::size_t>(index)]);
  return true;
}

class BulletEngine : public Engine {
 public:
  explicit BulletEngine(const Json& job)
      : dt_(job["experiment"]["dt"]), law_(job["world"]["body"]) {
    const Json& world = job["world"];
    const Json& options = job["options"];
    world_.setGravity(bullet(vector_of(world["gravity"])));
    world_.getDispatchInfo().m_enableSatConvex = true;  // else a face meets another at one point
    world_.getSolverInfo().m_numIterations = options.value("iterations", 10);
    for (const Json& support : world["supports"]) add_support(support, world);
    add_body(world["body"], options);
    add_tool(world, options);
  }

  void step() override {
    feet_share = law_.share(state());
    world_.stepSimulation(scalar(dt_), 0);
  }

  void set_tool(const Vector& position, const Vector& velocity) override {
    tool_->setWorldTransform(btTransform(btQuaternion::getIdentity(), bullet(position)));
    tool_->setInterpolationWorldTransform(tool_->getWorldTransform());
    wanted_ = bullet(velocity);
    tool_->setLinearVelocity(wanted_);
    tool_->setAngularVelocity({0, 0, 0});
  }

  [[nodiscard]] Vector tool_force() const override {
    return numbers((wanted_ - tool_->getLinearVelocity()) * scalar(kToolMass / dt_));
  }

  [[nodiscard]] BodyState state() const override {
    const btTransform origin = body_->getWorldTransform() * T_body_frame_.inverse();
    const btQuaternion q = origin.getRotation();
    return {numbers(origin.getOrigin()),
            {q.x(), q.y(), q.z(), q.w()},
            numbers(body_->getLinearVelocity()),
            numbers(body_->getAngularVelocity())};
  }

  void set_velocity(const Vector& linear, const Vector& angular) override {
    body_->setLinearVelocity(bullet(linear));
    body_->setAngularVelocity(bullet(angular));
  }

  void apply_wrench(const Vector& force, const Vector& torque) override {
    body_->applyCentralForce(bullet(force));
    body_->applyTorque(bullet(torque));
  }

  ~BulletEngine() override {
    child_friction = nullptr;
    for (const auto& object : objects_) world_.removeRigidBody(object.get());
  }
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

 private:
  template <typename Shape, typename... Arguments>
  Shape* shape(Arguments&&... arguments) {
    auto made = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* kept = made.get();
    shapes_.push_back(std::move(made));
    return kept;
  }

  btRigidBody* add(double mass, btCollisionShape* shape, const btVector3& inertia,
                   const btTransform& pose, const Json& friction) {
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, shape, inertia);
    info.m_startWorldTransform = pose;
    if (!friction.is_null()) info.m_friction = friction;
    objects_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody* made = objects_.back().get();
    made->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(made);
    return made;
  }

  void add_support(const Json& support, const Json& world) {
    auto* box = shape<btBoxShape>(bullet(vector_of(support["size"])) / 2.0);
    box->initializePolyhedralFeatures();
    add(0.0, box, {0, 0, 0},
        btTransform(quaternion(support["quaternion"]), bullet(vector_of(support["position"]))),
        world["bullet_support_friction"])
        ->setUserIndex(0);
  }

  /// Bullet's bodies have their centre of mass at the origin, along their principal axes.
  void add_body(const Json& body, const Json& options) {
    T_body_frame_ = btTransform(quaternion(body["inertia_quaternion"]),
                                bullet(vector_of(body["centre_of_mass"])));
    auto* parts = shape<btCompoundShape>();
    auto* hull = shape<btConvexHullShape>();
    for (const Json& point : body["points"]) hull->addPoint(bullet(vector_of(point)), false);
    hull->recalcLocalAabb();
    hull->setMargin(kMargin);
    hull->initializePolyhedralFeatures();
    parts->addChildShape(T_body_frame_.inverse(), hull);
    friction_.assign(1, body["friction"].is_null() ? 0.5 : body["friction"].get<double>());
    for (const Json& foot : body["feet"]) {
      const btTransform place(btQuaternion::getIdentity(), bullet(vector_of(foot["centre"])));
      parts->addChildShape(T_body_frame_.inverse() * place,
                           shape<btSphereShape>(scalar(foot["radius"])));
      friction_.push_back(foot["friction"]);
    }
    parts->setMargin(kMargin);
    const btTransform pose(quaternion(body["quaternion"]), bullet(vector_of(body["position"])));
    body_ = add(body["mass"], parts, bullet(vector_of(body["inertia"])), pose * T_body_frame_,
                body["bullet_friction"]);
    body_->setUserIndex(1);
    if (options.value("feet_friction", false)) {
      child_friction = &friction_;
      gContactAddedCallback = &set_friction;
      body_->setCollisionFlags(body_->getCollisionFlags() |
                               btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    }
  }

  void add_tool(const Json& world, const Json& options) {
    tool_ =
        add(kToolMass, shape<btSphereShape>(scalar(world["tool_radius"])),
            btVector3(1, 1, 1) * scalar(kToolMass),
            btTransform(btQuaternion::getIdentity(), bullet(kAway)), world["bullet_tip_friction"]);
    tool_->setGravity({0, 0, 0});
    tool_->setUserIndex(2);
    // The other side has none, which counts as stiff.
    if (options.value("compliant", false)) {
      tool_->setContactStiffnessAndDamping(world["body"]["stiffness"], world["body"]["damping"]);
    }
  }

  double dt_;
  FrictionLaw law_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> objects_;
  std::vector<double> friction_;
  btTransform T_body_frame_;
  btRigidBody* body_ = nullptr;
  btRigidBody* tool_ = nullptr;
  btVector3 wanted_{0, 0, 0};
};

}  // namespace
}  // namespace engines

int main(int argc, char** argv) {
  return engines::run_jobs(argc, argv, [](const engines::Json& job) {
    return std::make_unique<engines::BulletEngine>(job);
  });
}
