// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// ODE (Debian libode-dev): ode_engine JOBS
// options: quick (dWorldQuickStep) with iterations, else dWorldStep; compliant: contacts have the
// stiffness and damping of the export; along: the friction pyramid's first axis is along the slip.
// A body with a law has friction by slip speed.
#include <cmath>
#include <memory>
#include <vector>

#include <ode/ode.h>

#include "experiment.hpp"

namespace engines {
namespace {

/// Of a geom: NaN where a number is the engine's default.
struct Surface {
  double friction = 0.0;
  double stiffness = 0.0;  ///< [N/m]; 0: ODE's own
  double damping = 0.0;    ///< [N s/m]
  bool is_foot = false;
};

Vector numbers(const dReal* v) { return {v[0], v[1], v[2]}; }

void set_quaternion(const Json& q, dQuaternion result) {
  for (int i = 0; i < 4; ++i) result[i] = q[i == 0 ? 3 : i - 1].get<double>();
}

class OdeEngine : public Engine {
 public:
  explicit OdeEngine(const Json& job)
      : dt_(job["experiment"]["dt"]),
        options_(job["options"]),
        law_(job["world"]["body"]),
        world_(dWorldCreate()) {
    const Json& world = job["world"];
    const Vector g = vector_of(world["gravity"]);
    dWorldSetGravity(world_, g[0], g[1], g[2]);
    if (options_.contains("iterations")) {
      dWorldSetQuickStepNumIterations(world_, options_["iterations"]);
    }
    is_default_ = world["partner_friction"].is_null();
    for (const Json& support : world["supports"]) add_support(support, world);
    add_body(world["body"]);
    tool_ = dBodyCreate(world_);
    dBodySetGravityMode(tool_, 0);
    set_mass(tool_, kToolMass, {kToolMass, kToolMass, kToolMass});
    dGeomSetBody(add_geom(dCreateSphere(space_, world["tool_radius"]),
                          {.friction = number(world["tip_friction"])}),
                 tool_);
  }
  ~OdeEngine() override {
    dSpaceDestroy(space_);
    for (dTriMeshDataID data : meshes_) dGeomTriMeshDataDestroy(data);
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
  }
  OdeEngine(const OdeEngine&) = delete;
  OdeEngine& operator=(const OdeEngine&) = delete;

  void step() override {
    feet_share_ = law_.share(state());
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) {
      static_cast<OdeEngine*>(self)->add_contacts(a, b);
    });
    if (options_.value("quick", false)) {
      dWorldQuickStep(world_, dt_);
    } else {
      dWorldStep(world_, dt_);
    }
    dJointGroupEmpty(contacts_);
  }

  void set_tool(const Vector& p, const Vector& v) override {
    dBodySetPosition(tool_, p[0], p[1], p[2]);
    dBodySetLinearVel(tool_, v[0], v[1], v[2]);
    dBodySetAngularVel(tool_, 0, 0, 0);
    wanted_ = v;
  }

  [[nodiscard]] Vector tool_force() const override {
    Vector force = numbers(dBodyGetLinearVel(tool_));
    for (std::size_t i = 0; i < 3; ++i) force[i] = (wanted_[i] - force[i]) * kToolMass / dt_;
    return force;
  }

  [[nodiscard]] BodyState state() const override {
    // The body's frame is at its centre of mass, along its principal axes.
    dVector3 origin;
    dBodyGetRelPointPos(body_, origin_body_[0], origin_body_[1], origin_body_[2], origin);
    dQuaternion q;
    dQMultiply2(q, dBodyGetQuaternion(body_), q_object_body_);
    return {numbers(origin),
            {q[1], q[2], q[3], q[0]},
            numbers(dBodyGetLinearVel(body_)),
            numbers(dBodyGetAngularVel(body_))};
  }

  void set_velocity(const Vector& v, const Vector& w) override {
    dBodySetLinearVel(body_, v[0], v[1], v[2]);
    dBodySetAngularVel(body_, w[0], w[1], w[2]);
  }

  void apply_wrench(const Vector& f, const Vector& t) override {
    dBodyAddForce(body_, f[0], f[1], f[2]);
    dBodyAddTorque(body_, t[0], t[1], t[2]);
  }

 private:
  static double number(const Json& json) {
    return json.is_null() ? std::nan("") : json.get<double>();
  }

  static void set_mass(dBodyID body, double mass, const Vector& inertia) {
    dMass m;
    dMassSetParameters(&m, mass, 0, 0, 0, inertia[0], inertia[1], inertia[2], 0, 0, 0);
    dBodySetMass(body, &m);
  }

  dGeomID add_geom(dGeomID geom, const Surface& surface) {
    surfaces_.push_back(std::make_unique<Surface>(surface));
    dGeomSetData(geom, surfaces_.back().get());
    return geom;
  }

  /// Its upper side, as a plane: triangle meshes meet planes, and not boxes, at their vertices.
  void add_support(const Json& support, const Json& world) {
    dQuaternion q;
    set_quaternion(support["quaternion"], q);
    dMatrix3 r;
    dRfromQ(r, q);
    const Vector p = vector_of(support["position"]);
    const double half = support["size"][2].get<double>() / 2.0;
    const Vector n{r[2], r[6], r[10]};
    const double offset = n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + half;
    add_geom(dCreatePlane(space_, n[0], n[1], n[2], offset),
             {.friction = number(world["partner_friction"])});
  }

  void add_body(const Json& body) {
    body_ = dBodyCreate(world_);
    set_mass(body_, body["mass"], vector_of(body["inertia"]));
    dQuaternion q_base_object, q_base_body;
    set_quaternion(body["quaternion"], q_base_object);
    set_quaternion(body["inertia_quaternion"], q_object_body_);
    dQMultiply0(q_base_body, q_base_object, q_object_body_);
    dMatrix3 R_base_object, R_object_body;
    dRfromQ(R_base_object, q_base_object);
    dRfromQ(R_object_body, q_object_body_);
    const Vector centre = vector_of(body["centre_of_mass"]), p = vector_of(body["position"]);
    dVector3 c{centre[0], centre[1], centre[2]}, turned;
    dMultiply0_331(turned, R_base_object, c);
    dBodySetPosition(body_, p[0] + turned[0], p[1] + turned[1], p[2] + turned[2]);
    dBodySetQuaternion(body_, q_base_body);
    const auto place = [&](dGeomID geom, const Vector& position) {
      dVector3 offset{position[0] - centre[0], position[1] - centre[1], position[2] - centre[2]};
      dVector3 in_body;
      dMultiply1_331(in_body, R_object_body, offset);
      dQuaternion inverse{q_object_body_[0], -q_object_body_[1], -q_object_body_[2],
                          -q_object_body_[3]};
      dGeomSetBody(geom, body_);
      dGeomSetOffsetPosition(geom, in_body[0], in_body[1], in_body[2]);
      dGeomSetOffsetQuaternion(geom, inverse);
    };
    dVector3 back{-centre[0], -centre[1], -centre[2]}, origin;
    dMultiply1_331(origin, R_object_body, back);
    origin_body_ = {origin[0], origin[1], origin[2]};
    place(add_geom(mesh_of(body), {number(body["friction"]), body["stiffness"], body["damping"]}),
          {0, 0, 0});
    for (const Json& foot : body["feet"]) {
      place(add_geom(dCreateSphere(space_, foot["radius"]),
                     {foot["friction"], foot["stiffness"], foot["damping"], true}),
            vector_of(foot["centre"]));
    }
  }

  dGeomID mesh_of(const Json& body) {
    for (const Json& point : body["points"]) {
      for (const double value : point) vertices_.push_back(static_cast<float>(value));
    }
    for (const Json& triangle : body["triangles"]) {
      for (const int index : triangle) indices_.push_back(static_cast<dTriIndex>(index));
    }
    meshes_.push_back(dGeomTriMeshDataCreate());
    dGeomTriMeshDataBuildSingle(meshes_.back(), vertices_.data(), 3 * sizeof(float),
                                static_cast<int>(vertices_.size() / 3), indices_.data(),
                                static_cast<int>(indices_.size()), 3 * sizeof(dTriIndex));
    return dCreateTriMesh(space_, meshes_.back(), nullptr, nullptr, nullptr);
  }

  void add_contacts(dGeomID a, dGeomID b) {
    const dBodyID first = dGeomGetBody(a), second = dGeomGetBody(b);
    if (first == second) return;
    constexpr int kMaxContacts = 16;
    std::array<dContact, kMaxContacts> found{};
    int count = dCollide(a, b, kMaxContacts, &found[0].geom, sizeof(dContact));
    if (first == tool_ || second == tool_) {
      // A sphere has a contact with each triangle near it, which would add up their stiffness.
      const auto deeper = [](const dContact& x, const dContact& y) {
        return x.geom.depth > y.geom.depth;
      };
      std::sort(found.begin(), found.begin() + count, deeper);
      count = std::min(count, 1);
    }
    const auto& sa = *static_cast<Surface*>(dGeomGetData(a));
    const auto& sb = *static_cast<Surface*>(dGeomGetData(b));
    const Surface& own = sa.stiffness > 0.0 ? sa : sb;
    for (int i = 0; i < count; ++i) {
      dContact& contact = found[static_cast<std::size_t>(i)];
      // ODE has no default coefficient: Gazebo's is 1, with ODE's pyramid.
      contact.surface.mu = is_default_ ? 1.0 : std::min(sa.friction, sb.friction);
      if (sa.is_foot || sb.is_foot) contact.surface.mu *= feet_share_;
      contact.surface.mode = dContactApprox1;
      if (options_.value("compliant", false) && own.stiffness > 0.0) {
        const double hk = dt_ * own.stiffness;
        contact.surface.mode |= dContactSoftERP | dContactSoftCFM;
        contact.surface.soft_erp = hk / (hk + own.damping);
        contact.surface.soft_cfm = 1.0 / (hk + own.damping);
      }
      if (options_.value("along", false)) set_axis(first, second, contact);
      dJointAttach(dJointCreateContact(world_, contacts_, &contact), first, second);
    }
  }

  /// Of a point that slides: friction along its slip, none across.
  static void set_axis(dBodyID first, dBodyID second, dContact& contact) {
    dVector3 slip{0, 0, 0}, v;
    const dReal* p = contact.geom.pos;
    const dReal* n = contact.geom.normal;
    for (const auto& [body, sign] : {std::pair(first, 1.0), std::pair(second, -1.0)}) {
      if (body == nullptr) continue;
      dBodyGetPointVel(body, p[0], p[1], p[2], v);
      for (int i = 0; i < 3; ++i) slip[i] += sign * v[i];
    }
    const double along = slip[0] * n[0] + slip[1] * n[1] + slip[2] * n[2];
    for (int i = 0; i < 3; ++i) slip[i] -= along * n[i];
    const double speed = std::hypot(slip[0], slip[1], slip[2]);
    constexpr double kMinSpeed = 1e-3;  // [m/s] of sliding: slower, it may come to rest
    if (speed < kMinSpeed) return;
    contact.surface.mode |= dContactFDir1 | dContactMu2;
    contact.surface.mu2 = 0.0;
    for (int i = 0; i < 3; ++i) contact.fdir1[i] = slip[i] / speed;
  }

  double dt_;
  Json options_;
  FrictionLaw law_;
  double feet_share_ = 1.0;
  dWorldID world_;
  dSpaceID space_ = dHashSpaceCreate(nullptr);
  dJointGroupID contacts_ = dJointGroupCreate(0);
  bool is_default_ = false;
  dBodyID body_ = nullptr, tool_ = nullptr;
  Vector wanted_{}, origin_body_{};
  dQuaternion q_object_body_{1, 0, 0, 0};
  std::vector<std::unique_ptr<Surface>> surfaces_;
  std::vector<dTriMeshDataID> meshes_;
  std::vector<float> vertices_;
  std::vector<dTriIndex> indices_;
};

}  // namespace
}  // namespace engines

int main(int argc, char** argv) {
  dInitODE2(0);
  dAllocateODEDataForThread(dAllocateMaskAll);
  const int code = engines::run_jobs(argc, argv, [](const engines::Json& job) {
    return std::make_unique<engines::OdeEngine>(job);
  });
  dCloseODE();
  return code;
}
