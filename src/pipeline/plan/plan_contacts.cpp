// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "plan_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

namespace pcavr {
namespace {

constexpr double kGuessedCompression = 5e-4;  // [m] of contact and arm at breakaway
constexpr double kMinLoadingSpeed = 5e-4, kMaxLoadingSpeed = 5e-3;  // [m/s]
constexpr double kAfterBreakaway = 0.003;  // [m] that an object then slides
/// [m] further than the expected compression before a slide.
constexpr double kLoadingMargin = 0.001;
// Height of a push, as a share of the object's: below that at which it would tip over.
constexpr double kPushHeight = 0.5, kTippingShare = 0.6;
constexpr double kMinPushHeight = 0.005;  // [m] of the tip above the support
constexpr double kGuessedFrictionCoefficient = 0.5;

/// The point at which the ray from outside towards the object's centre of mass, or past it at
/// `height` [m] above its lowest point, meets its surface.
std::optional<ContactSite> site_of(const CadModel& model, const Pose& T_base_object,
                                   const Eigen::Vector3d& outward_base,
                                   std::optional<double> height) {
  const SurfaceQuery surface(model.mesh_object);
  const double reach = static_cast<double>(surface.bounds().diagonal().norm());
  Eigen::Vector3d centre_base = T_base_object * model.centre_of_mass_object;
  if (height) {
    double lowest = centre_base.z();
    for (const Eigen::Vector3f& vertex : model.mesh_object.vertices) {
      lowest = std::min(lowest, (T_base_object * vertex.cast<double>()).z());
    }
    centre_base.z() = lowest + *height;
  }
  const Pose T_object_base = T_base_object.inverse();
  const Eigen::Vector3d from = centre_base + reach * outward_base;
  const auto hit = surface.cast((T_object_base * from).cast<float>(),
                                (T_object_base.rotation() * -outward_base).cast<float>());
  if (!hit) return std::nullopt;
  return ContactSite{from - static_cast<double>(hit->distance) * outward_base, outward_base};
}

/// Outward, in base and level: the side that was pushed most often, else the one that faces the
/// robot's base, along the object's own axes.
Eigen::Vector3d side_of(const PlannedObject& known, const Pose& T_base_object) {
  Eigen::Vector3d chosen = Eigen::Vector3d::Zero();
  for (const Contact* contact : known.contacts) {
    if (contact->kind == ContactKind::press || !is_centred(contact)) continue;
    Eigen::Vector3d normal = T_base_object.rotation() * contact->normal_object;
    normal.z() = 0.0;
    if (chosen.isZero() || normal.dot(chosen) > 0.0) chosen += normal;
  }
  if (chosen.norm() > 1e-6) return chosen.normalized();
  const Eigen::Vector3d to_base = -(T_base_object * known.object.model.centre_of_mass_object);
  double best = -1.0;
  const double heading = heading_of(T_base_object);
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double angle = heading + quarter * 0.5 * std::numbers::pi;
    const Eigen::Vector3d axis(std::cos(angle), std::sin(angle), 0.0);
    if (axis.dot(to_base.normalized()) <= best) continue;
    best = axis.dot(to_base.normalized());
    chosen = axis;
  }
  return chosen;
}

/// [m] above the object's lowest point.
double push_height(const PlannedObject& known, const Pose& T_base_object,
                   const Eigen::Vector3d& outward, double tool_radius) {
  const Eigen::AlignedBox3d box = extents_of(known.object.model, T_base_object);
  const Eigen::Vector3d half = 0.5 * box.sizes();
  const double along = std::abs(outward.x()) * half.x() + std::abs(outward.y()) * half.y();
  const auto& coefficient = known.found.parameters.sliding_friction_coefficient;
  const double friction = coefficient ? coefficient->value : kGuessedFrictionCoefficient;
  const double tipping = kTippingShare * along / std::max(friction, 0.05);
  return std::max(tool_radius + kMinPushHeight, std::min(2.0 * kPushHeight * half.z(), tipping));
}

/// [m] of contact and arm at breakaway.
double compression_of(const ObjectParameters& p, double arm_stiffness) {
  const std::optional<HuntCrossley> law = contact_law_of(p);
  if (!law || !p.limiting_static_friction) return kGuessedCompression;
  const double force = p.limiting_static_friction->value;
  return static_penetration(*law, force) + force / arm_stiffness;
}

/// Pushes from one side, slides from both in turn, so that the object stays about where it is.
class PlannedPushes {
 public:
  PlannedPushes(const PlannedObject& known, Pose T_base_object, double tool_radius,
                double arm_stiffness, ObjectPlan& plan, PlanPath& path)
      : known_(known),
        T_base_object_(std::move(T_base_object)),
        outward_(side_of(known, T_base_object_)),
        height_(push_height(known, T_base_object_, outward_, tool_radius)),
        compression_(compression_of(known.found.parameters, arm_stiffness)),
        plan_(plan),
        path_(path) {
    plan.loading_speed =
        std::clamp(compression_ / kLoadingTime, kMinLoadingSpeed, kMaxLoadingSpeed);
  }

  void append() {
    for (int i = 0; i < plan_.breakaways; ++i) {
      if (!push(outward_, kAfterBreakaway, false)) return;
    }
    if (plan_.breakaways > 0) path_.lift();
    Eigen::Vector3d outward = plan_.breakaways > 0 ? Eigen::Vector3d(-outward_) : outward_;
    for (int i = 0; i < plan_.slides; ++i) {
      if (!push(outward, kLoadingMargin, true)) return;
      path_.lift();
      outward = -outward;
    }
  }

 private:
  bool push(const Eigen::Vector3d& outward, double beyond, bool is_slide) {
    const auto site = site_of(known_.object.model, T_base_object_, outward, height_);
    if (!site) {
      plan_.breakaways = plan_.slides = 0;
      plan_.notes.emplace_back("no pushes: the CAD body has no surface there");
      return false;
    }
    path_.approach(*site);
    path_.load(*site, compression_ + beyond, plan_.loading_speed);
    double travel = beyond;
    if (is_slide) {
      path_.slide(*site, plan_.slide);
      travel += plan_.slide.distance;
    }
    path_.back_off(*site);
    T_base_object_ = Pose(Eigen::Quaterniond::Identity(), -travel * outward) * T_base_object_;
    return true;
  }

  const PlannedObject& known_;
  Pose T_base_object_;
  Eigen::Vector3d outward_;
  double height_, compression_;
  ObjectPlan& plan_;
  PlanPath& path_;
};

}  // namespace

Eigen::AlignedBox3d extents_of(const CadModel& model, const Pose& T_base_object) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : model.mesh_object.vertices) {
    box.extend(T_base_object * vertex.cast<double>());
  }
  return box;
}

void append_presses(const PlannedObject& known, const Pose& T_base_object, ObjectPlan& plan,
                    PlanPath& path) {
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();
  if (!known.object.is_movable && !known.contacts.empty()) {
    outward = -known.contacts.back()->direction_base;
  }
  const auto site = site_of(known.object.model, T_base_object, outward, std::nullopt);
  if (!site) {
    plan.press_series = 0;
    plan.notes.emplace_back("no presses: the CAD body has no surface there");
    return;
  }
  path.approach(*site);
  for (int series = 0; series < plan.press_series; ++series) {
    for (const double speed : kPressSpeeds) path.press(*site, plan.press_depth, speed);
  }
  path.lift();
}

void append_pushes(const PlannedObject& known, const Pose& T_base_object, double tool_radius,
                   double arm_stiffness, ObjectPlan& plan, PlanPath& path) {
  PlannedPushes(known, T_base_object, tool_radius, arm_stiffness, plan, path).append();
}

}  // namespace pcavr
