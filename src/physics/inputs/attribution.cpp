// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/attribution.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pcavr/physics/inputs/align_with_face.hpp"

namespace pcavr {
namespace {

/// A face's normal within this cosine of the force gives the direction; the force itself is noisy.
constexpr double kFaceCosine = 0.9;
constexpr double kSameDirection = 0.9998;  // 1 degree
constexpr double kAround = 0.1;  // [s] of a contact, in which another body may move with it

/// Projects the contact's series onto `direction_base`, which is more exact than the mean force's.
void project_onto(const Eigen::Vector3d& direction_base, const PathView& tip, Contact& contact) {
  contact.direction_base = direction_base;
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    contact.tool[i] = tip.at(contact.t[i]).dot(direction_base);
    contact.force[i] = contact.force_base[i].dot(direction_base);
  }
}

class Attribution {
 public:
  Attribution(const InputSeries& series, const PathView& tip, const InputOptions& options,
              BodyPoses& poses)
      : series_(series),
        tip_(tip),
        options_(options),
        poses_(poses),
        directions_(series.bodies.size()) {}

  void attribute(Contact& contact) {
    if (contact.t.empty() || contact.t.front() > contact.end || contact.t.back() < contact.begin) {
      contact.left_out = "the tool's motion was not recorded during it";
      return;
    }
    const Eigen::Vector3d p_base_tip = tip_.at(contact.begin);
    std::vector<Touch> touches;
    for (std::size_t i = 0; i < series_.bodies.size(); ++i) {
      touches.push_back(poses_.touch(i, contact.begin, p_base_tip, series_.tool_radius));
    }
    const std::optional<TouchedBody> touched = touched_body(touches, options_);
    if (!touched) {
      contact.left_out = "no known object is at the contact point";
      return;
    }
    contact.object = touched->body;
    contact.gap = touches[touched->body].gap;
    contact.normal_object = touches[touched->body].normal_object;
    if (touched->is_ambiguous) contact.left_out = "two objects are at the contact point";
    set_direction(contact);
    check_others(contact);
  }

 private:
  void set_direction(Contact& contact) {
    const std::size_t object = *contact.object;
    contact.T_base_object = poses_.at(object, contact.begin);
    const bool is_on_face = align_with_face(series_.bodies[object].model->centre_of_mass_object,
                                            tip_, directions_[object], contact);
    if (is_on_face) directions_[object].push_back(contact.direction_base);
    const bool has_moved = contact.kind == ContactKind::slide && series_.bodies[object].is_movable;
    if (has_moved && !poses_.is_tracked(object)) {
      poses_.displace(object, contact.slides.back().end,
                      displacement_at(contact, contact.slides.back().end) * contact.direction_base);
    }
  }

  /// Excludes a push that moves two objects: its force can't be divided.
  void check_others(Contact& contact) const {
    for (std::size_t i = 0; i < series_.bodies.size(); ++i) {
      if (i == *contact.object || !poses_.is_tracked(i)) continue;
      const double moved = translation_distance(poses_.at(i, contact.begin - kAround),
                                                poses_.at(i, contact.end + kAround));
      if (moved > options_.min_other_displacement) {
        contact.left_out = "it also moved " + series_.bodies[i].name;
      }
    }
  }

  const InputSeries& series_;
  const PathView& tip_;
  const InputOptions& options_;
  BodyPoses& poses_;
  std::vector<std::vector<Eigen::Vector3d>> directions_;  ///< by object: those of earlier contacts
};

}  // namespace

bool align_with_face(const Eigen::Vector3d& centre_of_mass_object, const PathView& tip,
                     std::span<const Eigen::Vector3d> directions_base, Contact& contact) {
  Eigen::Vector3d inward = -(contact.T_base_object.rotation() * contact.normal_object);
  const bool is_on_face = inward.dot(contact.direction_base) > kFaceCosine;
  if (is_on_face) {
    // Tracking noise varies a face's direction between contacts: at a lever of half a metre, 0.1
    // degrees would displace each press's surface by a millimetre.
    for (const Eigen::Vector3d& known : directions_base) {
      if (known.dot(inward) > kSameDirection) inward = known;
    }
    project_onto(inward, tip, contact);
  }
  const Eigen::Vector3d arm = tip.at(contact.begin) - contact.T_base_object * centre_of_mass_object;
  const Eigen::Vector2d along = contact.direction_base.head<2>().normalized();
  contact.lever = arm.x() * along.y() - arm.y() * along.x();
  return is_on_face;
}

std::vector<Contact> attribute_contacts(const InputSeries& series, std::vector<Contact> contacts,
                                        const PathView& tip, std::span<const UnusableInterval> bad,
                                        const InputOptions& options, BodyPoses& poses) {
  Attribution attribution(series, tip, options, poses);
  for (Contact& contact : contacts) {
    attribution.attribute(contact);
    for (const UnusableInterval& interval : bad) {
      if (interval.end < contact.begin || interval.begin > contact.end) continue;
      contact.left_out = interval.reason;
    }
  }
  return contacts;
}

}  // namespace pcavr
