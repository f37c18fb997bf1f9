// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robots/robot/workspace.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "robots/robot/sin_cos.hpp"

namespace pcavr::robot {
namespace {

template <typename T>
Triple<T> to_child(const Body& body, const BodyState& state, Triple<T> v) {
  if (body.is_branch) v = back_about_z(body.branch, v);
  return back_about_z(state.turn, back_about_x(body.twist, v));
}

template <typename T>
Triple<T> turned_to_parent(const Body& body, const BodyState& state, const Triple<T>& v) {
  const Triple<T> turned = about_x(body.twist, about_z(state.turn, v));
  return body.is_branch ? about_z(body.branch, turned) : turned;
}

/// A moment about the origin and a force.
VecPair wrench_to_parent(const Body& body, const BodyState& state, const VecPair& wrench) {
  VecPair turned = turned_to_parent(body, state, wrench);
  const Vec moment = cross(state.origin, second(turned));
  turned.x[0] += moment.x;
  turned.y[0] += moment.y;
  turned.z[0] += moment.z;
  return turned;
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
  return {paired(body.inertia, Sym{body.mass, 0.0, 0.0, body.mass, 0.0, body.mass}),
          {{0.0, -h.z, h.y}, {h.z, 0.0, -h.x}, {-h.y, h.x, 0.0}}};
}

/// The inertia times the axis of the joint: moment and force.
VecPair force_of_axis(const ArticulatedInertia& inertia, bool is_prismatic) {
  const SymPair& m = inertia.blocks;
  const Rows& h = inertia.coupling;
  if (is_prismatic) return paired(Vec{h.x.z, h.y.z, h.z.z}, Vec{m.xz[1], m.yz[1], m.zz[1]});
  return paired(Vec{m.xz[0], m.yz[0], m.zz[0]}, h.z);
}

/// The component along the joint.
double along_joint(const VecPair& wrench, bool is_prismatic) {
  return is_prismatic ? wrench.z[1] : wrench.z[0];
}

/// inertia - U U^T / D: what the joint passes on to its parent [Featherstone 2008, eq. 7.23].
ArticulatedInertia handed_on(const ArticulatedInertia& inertia, const VecPair& u,
                             double inverse_d) {
  const VecPair n = inverse_d * u;
  const SymPair& m = inertia.blocks;
  const Rows& h = inertia.coupling;
  const Vec f = second(n);
  return {{m.xx - n.x * u.x, m.xy - n.x * u.y, m.xz - n.x * u.z, m.yy - n.y * u.y, m.yz - n.y * u.z,
           m.zz - n.z * u.z},
          {h.x + -u.x[0] * f, h.y + -u.y[0] * f, h.z + -u.z[0] * f}};
}

ArticulatedInertia to_parent(const Body& body, const BodyState& state,
                             const ArticulatedInertia& inertia) {
  ArticulatedInertia turned{about_x(body.twist, about_z(state.turn, inertia.blocks)),
                            about_x(body.twist, about_z(state.turn, inertia.coupling))};
  if (body.is_branch) {
    turned = {about_z(body.branch, turned.blocks), about_z(body.branch, turned.coupling)};
  }
  return shifted(turned, state.origin);
}

}  // namespace

Workspace::Workspace(BodyTree body_tree)
    : tree(std::move(body_tree)), places(tree.bodies.size()), states_(tree.bodies.size()) {
  const auto dof = static_cast<Eigen::Index>(tree.dof);
  angles_.resize(tree.bodies.size() + 1);  // read in pairs
  mass.setZero(dof, dof);
  factor_.setZero(dof, dof);
  bias_.setZero(dof);
}

void Workspace::set_positions(const double* q) {
  const std::size_t count = tree.bodies.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Body& body = tree.bodies[i];
    const double position = body.multiplier * q[body.coordinate] + body.offset;
    angles_[i] = body.angle_offset + (body.is_prismatic ? 0.0 : position);
    states_[i].origin = body.is_prismatic ? body.origin + position * body.slide : body.origin;
  }
  for (std::size_t i = 0; i < count; i += 2) {
    const TurnPair turns = turns_of(Pair{angles_[i], angles_[i + 1]});
    states_[i].turn = {turns.c[0], turns.s[0]};
    if (i + 1 < count) states_[i + 1].turn = {turns.c[1], turns.s[1]};
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
    R_parent_body << to_eigen(turned_to_parent(body, state, Vec{1.0, 0.0, 0.0})),
        to_eigen(turned_to_parent(body, state, Vec{0.0, 1.0, 0.0})),
        to_eigen(turned_to_parent(body, state, Vec{0.0, 0.0, 1.0}));
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
/// the acceleration of the points of a body by its matrix `spin`; and the force that each body
/// needs.
template <bool kHasAcceleration>
void Workspace::move_bodies(const double* dq, const double* ddq) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    const double speed = body.multiplier * dq[body.coordinate];
    double acceleration = 0.0;
    if constexpr (kHasAcceleration) acceleration = body.multiplier * ddq[body.coordinate];
    Vec omega;
    Vec domega;
    Vec origin_acceleration;
    if (body.parent == Body::kBase) {
      origin_acceleration = to_child(body, state, tree.minus_gravity);
    } else {
      const BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
      const VecPair rotation = to_child(body, state, parent.rotation);
      omega = first(rotation);
      domega = second(rotation);
      origin_acceleration = to_child(body, state, parent.acceleration + parent.spin * state.origin);
    }
    if (body.is_prismatic) {
      origin_acceleration =
          origin_acceleration + Vec{2.0 * speed * omega.y, -2.0 * speed * omega.x, acceleration};
    } else {
      domega = domega + Vec{speed * omega.y, -speed * omega.x, acceleration};
      omega.z += speed;
    }
    const Rows spin = spin_of(omega, domega);
    state.rotation = paired(omega, domega);
    state.acceleration = origin_acceleration;
    state.spin = spin;
    state.force = paired(
        cross(body.first_moment, origin_acceleration) + spin_moment(spin, body.pseudo_inertia),
        body.mass * origin_acceleration + spin * body.first_moment);
  }
}

/// The inward pass: the torque is the force's component along the joint.
void Workspace::sum_forces(double* tau) {
  for (std::size_t i = 0; i < tree.dof; ++i) tau[i] = 0.0;
  for (std::size_t i = tree.bodies.size(); i-- > 0;) {
    const Body& body = tree.bodies[i];
    const BodyState& state = states_[i];
    tau[body.coordinate] += body.multiplier * along_joint(state.force, body.is_prismatic);
    if (body.parent == Body::kBase) continue;
    VecPair& sum = states_[static_cast<std::size_t>(body.parent)].force;
    sum = sum + wrench_to_parent(body, state, state.force);
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
    state.acceleration = to_child(
        body, state,
        body.parent == Body::kBase ? tree.minus_gravity
                                   : states_[static_cast<std::size_t>(body.parent)].acceleration);
    state.force =
        paired(cross(body.first_moment, state.acceleration), body.mass * state.acceleration);
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
    const VecPair u = force_of_axis(state.inertia, body.is_prismatic);
    state.force_of_joint = u;
    state.inverse_inertia = 1.0 / (along_joint(u, body.is_prismatic) + body.armature);
    state.remaining_torque = tau[body.coordinate] - along_joint(state.force, body.is_prismatic);
    if (body.parent == Body::kBase) continue;
    BodyState& parent = states_[static_cast<std::size_t>(body.parent)];
    const double share = state.remaining_torque * state.inverse_inertia;
    parent.force = parent.force + wrench_to_parent(body, state, state.force + share * u);
    add_to(parent.inertia,
           to_parent(body, state, handed_on(state.inertia, u, state.inverse_inertia)));
  }
}

void Workspace::accelerate_bodies(double* ddq) {
  for (std::size_t i = 0; i < tree.bodies.size(); ++i) {
    const Body& body = tree.bodies[i];
    BodyState& state = states_[i];
    VecPair relative;
    if (body.parent != Body::kBase) {
      relative = states_[static_cast<std::size_t>(body.parent)].relative;
      relative =
          to_child(body, state, relative + paired(Vec{}, cross(first(relative), state.origin)));
    }
    const Pair needed = dot(state.force_of_joint, relative);
    const double acceleration =
        (state.remaining_torque - needed[0] - needed[1]) * state.inverse_inertia;
    ddq[body.coordinate] = acceleration;
    // A variable lane would go through memory.
    relative.z += body.is_prismatic ? Pair{0.0, acceleration} : Pair{acceleration, 0.0};
    state.relative = relative;
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
    VecPair force = force_of_axis(states_[i].inertia, body.is_prismatic);
    mass(row, row) +=
        body.multiplier * body.multiplier * (along_joint(force, body.is_prismatic) + body.armature);
    if (body.parent != Body::kBase) {
      add_to(states_[static_cast<std::size_t>(body.parent)].inertia,
             to_parent(body, states_[i], states_[i].inertia));
    }
    std::size_t child = i;
    for (int j = body.parent; j != Body::kBase;
         j = tree.bodies[static_cast<std::size_t>(j)].parent) {
      force = wrench_to_parent(tree.bodies[child], states_[child], force);
      child = static_cast<std::size_t>(j);
      const Body& carrier = tree.bodies[child];
      const auto column = static_cast<Eigen::Index>(carrier.coordinate);
      const double entry =
          body.multiplier * carrier.multiplier * along_joint(force, carrier.is_prismatic);
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
    // These are in the joint frame, like the parameters.
    const Eigen::Matrix3d& R_joint_body = tree.bodies[i].R_joint_body;
    const Eigen::Vector3d w = R_joint_body * to_eigen(first(states_[i].rotation));
    const Eigen::Vector3d dw = R_joint_body * to_eigen(second(states_[i].rotation));
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
        const Eigen::Vector3d v =
            place.rotation.transpose() * axis.cross(place.translation - joint.translation);
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
    Vec omega;
    Vec velocity;
    if (body.parent != Body::kBase) {
      const VecPair& parent = states_[static_cast<std::size_t>(body.parent)].relative;
      omega = to_child(body, state, first(parent));
      velocity = to_child(body, state, second(parent) + cross(first(parent), state.origin));
    }
    (body.is_prismatic ? velocity : omega).z += speed;
    state.relative = paired(omega, velocity);  // angular and linear velocity of the origin
    energy += 0.5 * body.mass * dot(velocity, velocity) +
              dot(velocity, cross(omega, body.first_moment)) +
              0.5 * dot(omega, body.inertia * omega) + 0.5 * body.armature * speed * speed;
  }
  return energy;
}

}  // namespace pcavr::robot
