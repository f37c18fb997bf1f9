// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Bullet (Debian libbullet-dev): bullet_engine JOBS
// options: iterations of the solver; two_directions: friction also across the slip, without which a
// tip that does not slip has hardly any; plane: the support is its upper side alone; compliant: the
// tip's contact has the identified stiffness; feet_friction: each foot has its own coefficient, set
// in its contacts (a body has one). A body with a law has friction by slip speed.
#include <functional>
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

constexpr int kSupport = 0, kBody = 1, kTool = 2;

/// A world that calls a function between collision and solver. Contacts last for many steps: a
/// contact callback would set the friction of their beginning.
class World : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  std::function<void()> before_solver = [] {};

 protected:
  void solveConstraints(btContactSolverInfo& info) override {
    before_solver();
    btDiscreteDynamicsWorld::solveConstraints(info);
  }
};

class BulletEngine : public Engine {
 public:
  explicit BulletEngine(const Json& job)
      : dt_(job["experiment"]["dt"]), law_(job["world"]["body"]) {
    const Json& world = job["world"];
    const Json& options = job["options"];
    world_.setGravity(bullet(vector_of(world["gravity"])));
    world_.getDispatchInfo().m_enableSatConvex = true;  // else a face meets another at one point
    world_.getSolverInfo().m_numIterations = options.value("iterations", 10);
    if (options.value("two_directions", false)) {
      world_.getSolverInfo().m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    }
    if (options.value("feet_friction", false))
      world_.before_solver = [this] { set_feet_friction(); };
    for (const Json& support : world["supports"]) {
      if (options.value("plane", false)) {
        add_plane(support, world);
      } else {
        add_support(support, world);
      }
    }
    add_body(world["body"], options);
    add_tool(world, options);
  }

  void step() override { world_.stepSimulation(scalar(dt_), 0); }

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
        ->setUserIndex(kSupport);
  }

  /// Spheres meet a box with an error of position that makes their forces vary by a tenth.
  void add_plane(const Json& support, const Json& world) {
    const btVector3 normal = quatRotate(quaternion(support["quaternion"]), {0, 0, 1});
    const btScalar half = scalar(support["size"][2].get<double>() / 2.0);
    const btScalar offset = normal.dot(bullet(vector_of(support["position"]))) + half;
    add(0.0, shape<btStaticPlaneShape>(normal, offset), {0, 0, 0}, btTransform::getIdentity(),
        world["bullet_support_friction"])
        ->setUserIndex(kSupport);
  }

  /// The friction of the contacts of the body's shapes with the support.
  void set_feet_friction() {
    const double share = law_.share(state());
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      btPersistentManifold* manifold = dispatcher_.getManifoldByIndexInternal(i);
      const int first = manifold->getBody0()->getUserIndex();
      if (first + manifold->getBody1()->getUserIndex() != kSupport + kBody) continue;
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        btManifoldPoint& point = manifold->getContactPoint(k);
        const int shape = first == kBody ? point.m_index0 : point.m_index1;
        if (shape < 0) continue;
        const double of_shape = friction_[static_cast<std::size_t>(shape)];
        // Shape 0 is the body's own surface.
        point.m_combinedFriction = scalar((shape == 0 ? 1.0 : share) * of_shape);
      }
    }
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
    body_->setUserIndex(kBody);
  }

  void add_tool(const Json& world, const Json& options) {
    tool_ =
        add(kToolMass, shape<btSphereShape>(scalar(world["tool_radius"])),
            btVector3(1, 1, 1) * scalar(kToolMass),
            btTransform(btQuaternion::getIdentity(), bullet(kAway)), world["bullet_tip_friction"]);
    tool_->setGravity({0, 0, 0});
    tool_->setUserIndex(kTool);
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
  World world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
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
