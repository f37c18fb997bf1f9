// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robot/workspace.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "robot/sin_cos.hpp"

namespace pcavr::robot {
namespace {

Vec to_child(const Body& body, const BodyState& state, Vec v) {
  if (body.is_branch) v = back_about_z(body.branch, v);
  return back_about_z(state.turn, back_about_x(body.twist, v));
}

Vec to_parent(const Body& body, const BodyState& state, const Vec& v) {
  const Vec turned = about_x(body.twist, about_z(state.turn, v));
  return body.is_branch ? about_z(body.branch, turned) : turned;
}

Wrench to_parent(const Body& body, const BodyState& state, const Wrench& w) {
  const Vec force = to_parent(body, state, w.force);
  return {to_parent(body, state, w.moment) + cross(state.origin, force), force};
}

void add_to(Wrench& sum, const Wrench& w) {
  sum = {sum.moment + w.moment, sum.force + w.force};
}

/// skew(domega) + omega omega^T - |omega|^2.
Rows spin_of(const Vec& omega, const Vec& domega) {
  const double xx = omega.x * omega.x;
  const double yy = omega.y * omega.y;
  const double zz = omega.z * omega.z;
  const double xy = omega.x * omega.y;
  const double xz = omega.x * omega.z;
  const double yz = omega.y * omega.z;
  return {{-yy - zz, xy - domega.z, xz + domega.y},
          {xy + domega.z, -xx - zz, yz - domega.x},
          {xz - domega.y, yz + domega.x, -xx - yy}};
}

/// The rate of the moment of momentum about the origin of a body whose origin does not accelerate:
/// the sum of m r x (spin r), from the matrix spin * pseudo-inertia [Balafoutis & Patel 1991].
Vec spin_moment(const Rows& spin, const Sym& j) {
  const Vec jx{j.xx, j.xy, j.xz};
  const Vec jy{j.xy, j.yy, j.yz};
  const Vec jz{j.xz, j.yz, j.zz};
  return {dot(spin.z, jy) - dot(spin.y, jz), dot(spin.x, jz) - dot(spin.z, jx),
          dot(spin.y, jx) - dot(spin.x, jy)};
}

/// The spatial inertia of a rigid body about its origin.
ArticulatedInertia rigid_inertia(const Body& body) {
  const Vec& h = body.first_moment;
  return {body.inertia,
          {{0.0, -h.z, h.y}, {h.z, 0.0, -h.x}, {-h.y, h.x, 0.0}},
          {body.mass, 0.0, 0.0, body.mass, 0.0, body.mass}};
}

/// The inertia times the axis of the joint.
Wrench force_of_axis(const ArticulatedInertia& inertia, bool is_prismatic) {
  const Rows& h = inertia.coupling;
  if (is_prismatic) {
    const Sym& m = inertia.translation;
    return {{h.x.z, h.y.z, h.z.z}, {m.xz, m.yz, m.zz}};
  }
  const Sym& r = inertia.rotation;
  return {{r.xz, r.yz, r.zz}, h.z};
}

/// inertia - U U^T / D: what the joint passes on to its parent [Featherstone 2008, eq. 7.23].
ArticulatedInertia handed_on(const ArticulatedInertia& inertia, const Wrench& u, double inverse_d) {
  const Vec n = inverse_d * u.moment;
  const Vec f = inverse_d * u.force;
  const Sym& r = inertia.rotation;
  const Rows& h = inertia.coupling;
  const Sym& m = inertia.translation;
  return {{r.xx - n.x * u.moment.x, r.xy - n.x * u.moment.y, r.xz - n.x * u.moment.z,
           r.yy - n.y * u.moment.y, r.yz - n.y * u.moment.z, r.zz - n.z * u.moment.z},
          {h.x + -u.moment.x * f, h.y + -u.moment.y * f, h.z + -u.moment.z * f},
          {m.xx - f.x * u.force.x, m.xy - f.x * u.force.y, m.xz - f.x * u.force.z,
           m.yy - f.y * u.force.y, m.yz - f.y * u.force.z, m.zz - f.z * u.force.z}};
}

ArticulatedInertia to_parent(const Body& body, const BodyState& state,
                             const ArticulatedInertia& inertia) {
  ArticulatedInertia turned{about_x(body.twist, about_z(state.turn, inertia.rotation)),
                            about_x(body.twist, about_z(state.turn, inertia.coupling)),
                            about_x(body.twist, about_z(state.turn, inertia.translation))};
  if (body.is_branch) {
    turned = {about_z(body.branch, turned.rotation), about_z(body.branch, turned.coupling),
              about_z(body.branch, turned.translation)};
  }
  return shifted(turned, state.origin);
}

}  // namespace

Workspace::Workspace(BodyTree body_tree)
    : tree(std::move(body_tree)), places(tree.bodies.size()), states_(tree.bodies.size()) {
  const auto dof = static_cast<Eigen::Index>(tree.dof);
  mass.setZero(dof, dof);
  factor_.setZero(dof, dof);
  bias_.setZero(dof);
}

void Workspace::set_positions(const double* q) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    const double position = body.multiplier * q[body.coordinate] + body.offset;
    if (body.is_prismatic) {
      state.turn = body.fixed_turn;
      state.origin = body.origin + position * body.slide;
    } else {
      state.turn = turn_of(position + body.angle_offset);
      state.origin = body.origin;
    }
  }
}

void Workspace::place_bodies() {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    const BodyState& state = states_[i];
    const Placement parent = body.parent == Body::kBase
                                 ? Placement{tree.R_base_body, Eigen::Vector3d::Zero()}
                                 : places[static_cast<std::size_t>(body.parent)];
    Eigen::Matrix3d R_parent_body;
    R_parent_body << to_eigen(to_parent(body, state, Vec{1.0, 0.0, 0.0})),
        to_eigen(to_parent(body, state, Vec{0.0, 1.0, 0.0})),
        to_eigen(to_parent(body, state, Vec{0.0, 0.0, 1.0}));
    places[i].rotation.noalias() = parent.rotation * R_parent_body;
    places[i].translation = parent.rotation * to_eigen(state.origin) + parent.translation;
  }
}

Placement Workspace::place_of_link(std::size_t link) const {
  const LinkPlace& place = tree.links[link];
  const Placement body = place.body == Body::kBase
                             ? Placement{tree.R_base_body, Eigen::Vector3d::Zero()}
                             : places[static_cast<std::size_t>(place.body)];
  return {body.rotation * place.R_body_link, body.rotation * place.p_body_link + body.translation};
}

/// The outward pass of the recursive Newton-Euler algorithm [Featherstone 2008, table 5.1], with
/// the acceleration of the points of a body by its matrix `spin`; and the force that each body needs.
template <bool kHasAcceleration>
void Workspace::move_bodies(const double* dq, const double* ddq) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    const double speed = body.multiplier * dq[body.coordinate];
    double acceleration = 0.0;
    if constexpr (kHasAcceleration) acceleration = body.multiplier * ddq[body.coordinate];
    if (body.parent == Body::kBase) {
      state.omega = {};
      state.domega = {};
      state.acceleration = to_child(body, state, tree.minus_gravity);
    } else {
      const BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
      state.omega = to_child(body, state, parent.omega);
      state.domega = to_child(body, state, parent.domega);
      state.acceleration =
          to_child(body, state, parent.acceleration + parent.spin * state.origin);
    }
    if (body.is_prismatic) {
      state.acceleration = state.acceleration + Vec{2.0 * speed * state.omega.y,
                                                    -2.0 * speed * state.omega.x, acceleration};
    } else {
      state.domega = state.domega +
                     Vec{speed * state.omega.y, -speed * state.omega.x, acceleration};
      state.omega.z += speed;
    }
    state.spin = spin_of(state.omega, state.domega);
    state.force.force = body.mass * state.acceleration + state.spin * body.first_moment;
    state.force.moment = cross(body.first_moment, state.acceleration) +
                         spin_moment(state.spin, body.pseudo_inertia);
  }
}

/// The inward pass: the torque is the force's component along the joint.
void Workspace::sum_forces(double* tau) {
  for (std::size_t i = 0; i < tree.dof; ++i) tau[i] = 0.0;
  for (std::size_t i = tree.bodies.size(); i-- > 0;) {
    const Body& body = tree.bodies[i];
    const BodyState& state = states_[i];
    tau[body.coordinate] +=
        body.multiplier * (body.is_prismatic ? state.force.force.z : state.force.moment.z);
    if (body.parent == Body::kBase) continue;
    add_to(states_[static_cast<std::size_t>(body.parent)].force,
           to_parent(body, state, state.force));
  }
}

void Workspace::inverse_dynamics(const double* dq, const double* ddq, double* tau) {
  move_bodies<true>(dq, ddq);
  sum_forces(tau);
  for (const Body& body : tree.bodies) {
    tau[body.coordinate] +=
        body.multiplier * body.multiplier * body.armature * ddq[body.coordinate];
  }
}

void Workspace::gravity_torque(double* tau) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    state.acceleration =
        to_child(body, state,
                 body.parent == Body::kBase
                     ? tree.minus_gravity
                     : states_[static_cast<std::size_t>(body.parent)].acceleration);
    state.force = {cross(body.first_moment, state.acceleration), body.mass * state.acceleration};
  }
  sum_forces(tau);
}

/// Articulated bodies [Featherstone 2008, table 7.1], with the bias as the forces of move_bodies at
/// ddq = 0 and all accelerations relative to that motion: so the terms with c and I c disappear.
void Workspace::forward_dynamics(const double* dq, const double* tau, double* ddq) {
  move_bodies<false>(dq, nullptr);
  fold_inertias(tau);
  accelerate_bodies(ddq);
}

void Workspace::fold_inertias(const double* tau) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    states_[i].inertia = rigid_inertia(tree.bodies[i]);
  }
  for (std::size_t i = tree.bodies.size(); i-- > 0;) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    const Wrench u = force_of_axis(state.inertia, body.is_prismatic);
    const double d = (body.is_prismatic ? u.force.z : u.moment.z) + body.armature;
    const double bias = body.is_prismatic ? state.force.force.z : state.force.moment.z;
    state.force_of_joint = u;
    state.inverse_inertia = 1.0 / d;
    state.remaining_torque = tau[body.coordinate] - bias;
    if (body.parent == Body::kBase) continue;
    BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
    const double share = state.remaining_torque * state.inverse_inertia;
    const Wrench force{state.force.moment + share * u.moment, state.force.force + share * u.force};
    add_to(parent.force, to_parent(body, state, force));
    add_to(parent.inertia,
           to_parent(body, state, handed_on(state.inertia, u, state.inverse_inertia)));
  }
}

void Workspace::accelerate_bodies(double* ddq) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    if (body.parent == Body::kBase) {
      state.domega = {};
      state.acceleration = {};
    } else {
      const BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
      state.domega = to_child(body, state, parent.domega);
      state.acceleration =
          to_child(body, state, parent.acceleration + cross(parent.domega, state.origin));
    }
    const double acceleration =
        (state.remaining_torque - dot(state.force_of_joint.moment, state.domega) -
         dot(state.force_of_joint.force, state.acceleration)) *
        state.inverse_inertia;
    ddq[body.coordinate] = acceleration;
    (body.is_prismatic ? state.acceleration : state.domega).z += acceleration;
  }
}

/// Composite rigid bodies [Featherstone 2008, table 6.2].
void Workspace::fill_mass_matrix() {
  mass.setZero();
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    states_[i].inertia = rigid_inertia(tree.bodies[i]);
  }
  for (std::size_t i = tree.bodies.size(); i-- > 0;) {
    const Body& body = tree.bodies[i];
    const auto row = static_cast<Eigen::Index>(body.coordinate);
    Wrench force = force_of_axis(states_[i].inertia, body.is_prismatic);
    mass(row, row) += body.multiplier * body.multiplier *
                      ((body.is_prismatic ? force.force.z : force.moment.z) + body.armature);
    if (body.parent != Body::kBase) {
      add_to(states_[static_cast<std::size_t>(body.parent)].inertia,
             to_parent(body, states_[i], states_[i].inertia));
    }
    std::size_t child = i;
    for (int j = body.parent; j != Body::kBase;
         j = tree.bodies[static_cast<std::size_t>(j)].parent) {
      force = to_parent(tree.bodies[child], states_[child], force);
      child = static_cast<std::size_t>(j);
      const Body& carrier = tree.bodies[child];
      const auto column = static_cast<Eigen::Index>(carrier.coordinate);
      const double entry = body.multiplier * carrier.multiplier *
                           (carrier.is_prismatic ? force.force.z : force.moment.z);
      mass(row, column) += entry;
      mass(column, row) += entry;  // for a joint that mimics its carrier, both on the diagonal
    }
  }
}

void Workspace::solve_with_mass_matrix(const double* dq, const double* tau, double* ddq) {
  move_bodies<false>(dq, nullptr);
  sum_forces(bias_.data());
  fill_mass_matrix();
  // Cholesky, in place: mass = factor factor^T.
  const Eigen::Index n = mass.rows();
  Eigen::Map<Eigen::VectorXd> x(ddq, n);
  x = Eigen::Map<const Eigen::VectorXd>(tau, n) - bias_;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      double rest = mass(i, j);
      for (Eigen::Index k = 0; k < j; ++k) rest -= factor_(i, k) * factor_(j, k);
      factor_(i, j) = i == j ? std::sqrt(rest) : rest / factor_(j, j);
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) x[i] -= factor_(i, k) * x[k];
    x[i] /= factor_(i, i);
  }
  for (Eigen::Index i = n; i-- > 0;) {
    for (Eigen::Index k = i + 1; k < n; ++k) x[i] -= factor_(k, i) * x[k];
    x[i] /= factor_(i, i);
  }
}

void Workspace::fill_regressor(const double* dq, const double* ddq,
                               Eigen::Ref<Eigen::MatrixXd> regressor) {
  regressor.setZero();
  move_bodies<true>(dq, ddq);
  place_bodies();
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    // In the joint frame, like the parameters.
    const Eigen::Matrix3d& R_joint_body = tree.bodies[i].R_joint_body;
    const Eigen::Vector3d w = R_joint_body * to_eigen(states_[i].omega);
    const Eigen::Vector3d dw = R_joint_body * to_eigen(states_[i].domega);
    const Eigen::Vector3d a = R_joint_body * to_eigen(states_[i].acceleration);
    const Eigen::Matrix3d spin = skew(dw) + skew(w) * skew(w);
    // The force and moment that the body needs, by parameter [Atkeson, An & Hollerbach 1986].
    Eigen::Matrix<double, 3, 10> force;
    force << a, spin, Eigen::Matrix<double, 3, 6>::Zero();
    const auto inertia_times = [](const Eigen::Vector3d& v) {
      Eigen::Matrix<double, 3, 6> m;
      m << v.x(), v.y(), v.z(), 0.0, 0.0, 0.0,  //
          0.0, v.x(), 0.0, v.y(), v.z(), 0.0,   //
          0.0, 0.0, v.x(), 0.0, v.y(), v.z();
      return m;
    };
    Eigen::Matrix<double, 3, 10> moment;
    moment << Eigen::Vector3d::Zero(), -skew(a), inertia_times(dw) + skew(w) * inertia_times(w);
    const Placement place{places[i].rotation * R_joint_body.transpose(), places[i].translation};
    for (int j = static_cast<int>(i); j != Body::kBase;
         j = tree.bodies[static_cast<std::size_t>(j)].parent) {
      const Body& carrier = tree.bodies[static_cast<std::size_t>(j)];
      const Placement& joint = places[static_cast<std::size_t>(j)];
      const Eigen::Vector3d axis = carrier.multiplier * joint.rotation.col(2);
      auto block = regressor.block<1, 10>(static_cast<Eigen::Index>(carrier.coordinate),
                                          static_cast<Eigen::Index>(10 * i));
      if (carrier.is_prismatic) {
        const Eigen::Vector3d v = place.rotation.transpose() * axis;
        block += v.transpose() * force;
      } else {
        const Eigen::Vector3d v = place.rotation.transpose() *
                                  axis.cross(place.translation - joint.translation);
        const Eigen::Vector3d omega = place.rotation.transpose() * axis;
        block += v.transpose() * force + omega.transpose() * moment;
      }
    }
  }
}

double Workspace::kinetic_energy(const double* dq) {
  double energy = 0.0;
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    const double speed = body.multiplier * dq[body.coordinate];
    // `acceleration` serves as the velocity of the origin.
    Vec omega;
    Vec velocity;
    if (body.parent != Body::kBase) {
      const BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
      omega = to_child(body, state, parent.omega);
      velocity = to_child(body, state, parent.acceleration + cross(parent.omega, state.origin));
    }
    (body.is_prismatic ? velocity : omega).z += speed;
    state.omega = omega;
    state.acceleration = velocity;
    energy += 0.5 * body.mass * dot(velocity, velocity) +
              dot(velocity, cross(omega, body.first_moment)) +
              0.5 * dot(omega, body.inertia * omega) + 0.5 * body.armature * speed * speed;
  }
  return energy;
}

}  // namespace pcavr::robot
