// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// Maximum distance of a candidate surface.
constexpr float kSearchRadius = 0.2F;  // [m]
/// Tolerance for the combined errors of poses, CAD files and the tip's radius.
constexpr double kMaxGap = 0.015;  // [m]
/// With a smaller difference of their gaps, it is ambiguous which of two surfaces was touched.
constexpr double kMinGapDifference = 0.003;  // [m]
/// A face's normal within this cosine of the force gives the direction; the force itself is noisy.
constexpr double kFaceCosine = 0.9;
constexpr double kSameDirection = 0.9998;  // 1 degree
/// Of the tip's radius: penetration and pose errors together are less than the rest.
constexpr double kMinDistance = 0.3;
/// [m] of another object during a contact: it was pushed along.
constexpr double kMinOtherDisplacement = 0.003;

/// Projects the contact's series onto `direction_base`, which is more exact than the mean force's.
void project_onto(const Eigen::Vector3d& direction_base, const PathView& tip,
                  IdentifiedContact& contact) {
  ContactEpisode& episode = contact.episode;
  episode.direction_base = direction_base;
  for (std::size_t i = 0; i < episode.t.size(); ++i) {
    episode.tool[i] = tip.at(episode.t[i]).dot(direction_base);
    episode.force[i] = contact.force_base[i].dot(direction_base);
  }
}

class Attribution {
 public:
  Attribution(const IdentificationInput& input, const Segmentation& found,
              std::span<const double> t_force, const PathView& tip, ObjectPoses& object_poses)
      : input_(input),
        found_(found),
        t_force_(t_force),
        tip_(tip),
        object_poses_(object_poses),
        directions_(input.objects.size()) {}

  IdentifiedContact attribute(const ContactEpisode& episode) {
    IdentifiedContact contact;
    contact.episode = episode;
    if (episode.t.empty() || episode.t.front() > episode.end || episode.t.back() < episode.begin) {
      contact.left_out = "the tool's motion was not recorded during it";
      return contact;
    }
    const auto first = std::lower_bound(t_force_.begin(), t_force_.end(), episode.t.front());
    const auto begin = found_.force_base.begin() + (first - t_force_.begin());
    contact.force_base.assign(begin, begin + std::ssize(episode.t));
    const Eigen::Vector3d p_base_tip = tip_.at(episode.begin);
    std::optional<ObjectPoses::Touch> nearest, second;
    for (std::size_t i = 0; i < input_.objects.size(); ++i) {
      const auto touch = object_poses_.touch(i, episode.begin, p_base_tip, input_.tool_radius);
      if (!touch) continue;
      if (!nearest || touch->gap < nearest->gap) {
        second = nearest;
        nearest = touch;
        contact.object = i;
      } else if (!second || touch->gap < second->gap) {
        second = touch;
      }
    }
    if (!nearest || nearest->gap > kMaxGap) {
      contact.object.reset();
      contact.left_out = "no known object is at the contact point";
      return contact;
    }
    contact.gap = nearest->gap;
    contact.normal_object = nearest->normal_object;
    const bool is_ambiguous = second && second->gap - nearest->gap < kMinGapDifference;
    if (is_ambiguous) contact.left_out = "two objects are at the contact point";
    set_direction(contact);
    check_others(contact);
    return contact;
  }

 private:
  void set_direction(IdentifiedContact& contact) {
    ContactEpisode& episode = contact.episode;
    const std::size_t object = *contact.object;
    const Pose T_base_object = object_poses_.at(object, episode.begin);
    Eigen::Vector3d inward = -(T_base_object.rotation() * contact.normal_object);
    if (inward.dot(episode.direction_base) > kFaceCosine) {
      // Tracking noise varies a face's direction between contacts: at a lever of half a metre, 0.1
      // degrees would displace each press's surface by a millimetre.
      for (const Eigen::Vector3d& known : directions_[object]) {
        if (known.dot(inward) > kSameDirection) inward = known;
      }
      directions_[object].push_back(inward);
      project_onto(inward, tip_, contact);
    }
    const Eigen::Vector3d arm =
        tip_.at(episode.begin) - T_base_object * input_.objects[object].model.centre_of_mass_object;
    const Eigen::Vector2d along = episode.direction_base.head<2>().normalized();
    contact.lever = arm.x() * along.y() - arm.y() * along.x();
    if (episode.kind == ContactKind::slide && !object_poses_.is_tracked(object)) {
      object_poses_.displace(
          object, episode.slides.back().end,
          displacement_at(episode, episode.slides.back().end) * episode.direction_base);
    }
  }

  /// Excludes a push that moves two objects: its force can't be divided.
  void check_others(IdentifiedContact& contact) const {
    for (std::size_t i = 0; i < input_.objects.size(); ++i) {
      if (i == *contact.object || !object_poses_.is_tracked(i)) continue;
      const double moved = translation_distance(object_poses_.at(i, contact.episode.begin - 0.1),
                                                object_poses_.at(i, contact.episode.end + 0.1));
      if (moved > kMinOtherDisplacement) {
        contact.left_out = "it also moved " + input_.objects[i].name;
      }
    }
  }

  const IdentificationInput& input_;
  const Segmentation& found_;
  std::span<const double> t_force_;
  const PathView& tip_;
  ObjectPoses& object_poses_;
  std::vector<std::vector<Eigen::Vector3d>> directions_;  ///< by object: those of earlier contacts
};

}  // namespace

double displacement_at(const ContactEpisode& episode, double t) {
  const auto object_position = [&](double at) {
    const auto after = std::lower_bound(episode.t.begin(), episode.t.end(), at);
    const auto i =
        std::min(static_cast<std::size_t>(after - episode.t.begin()), episode.t.size() - 1);
    const double stiffness = episode.breakaway.stiffness;
    return episode.tool[i] - (stiffness > 0.0 ? episode.force[i] / stiffness : 0.0);
  };
  double displacement = 0.0;
  for (const SlideInterval& slide : episode.slides) {
    displacement +=
        object_position(std::clamp(t, slide.begin, slide.end)) - object_position(slide.begin);
  }
  return displacement;
}

ObjectPoses::ObjectPoses(const std::vector<IdentifiableObject>& objects)
    : objects_(objects), steps_(objects.size()) {
  for (const IdentifiableObject& object : objects) surfaces_.emplace_back(object.model.mesh_object);
}

bool ObjectPoses::is_tracked(std::size_t object) const { return !objects_[object].tracked.empty(); }

Pose ObjectPoses::at(std::size_t object, double t) const {
  if (is_tracked(object)) return pose_at(objects_[object].tracked, t);
  const Pose& start = objects_[object].T_base_object;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (const Step& step : steps_[object]) {
    if (step.t <= t) moved = step.total_base;
  }
  return Pose(start.rotation(), start.translation() + moved);
}

void ObjectPoses::displace(std::size_t object, double t, const Eigen::Vector3d& displacement_base) {
  std::vector<Step>& steps = steps_[object];
  const Eigen::Vector3d before =
      steps.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : steps.back().total_base;
  // A body on its support keeps its height.
  steps.push_back({t, before + Eigen::Vector3d(displacement_base.x(), displacement_base.y(), 0.0)});
}

std::optional<ObjectPoses::Touch> ObjectPoses::touch(std::size_t object, double t,
                                                     const Eigen::Vector3d& p_base_tip,
                                                     double tool_radius) const {
  const Pose T_base_object = at(object, t);
  const Eigen::Vector3d p_object = T_base_object.inverse() * p_base_tip;
  const auto closest = surfaces_[object].closest(p_object.cast<float>(), kSearchRadius);
  if (!closest) return std::nullopt;
  const Eigen::Vector3d point = closest->point.cast<double>();
  const Eigen::Vector3d normal = closest->normal.cast<double>();
  const bool is_inside = (p_object - point).dot(normal) < 0.0;
  const double distance = static_cast<double>(closest->distance);
  // Where the tip's centre is close to the surface, or behind it, the direction to it is
  // ill-defined: the normal is used.
  const bool has_direction = !is_inside && distance > kMinDistance * tool_radius;
  const Eigen::Vector3d inward =
      has_direction ? Eigen::Vector3d((point - p_object) / distance) : Eigen::Vector3d(-normal);
  return Touch{(is_inside ? -distance : distance) - tool_radius, normal,
               T_base_object.rotation() * inward};
}

std::vector<IdentifiedContact> attribute_contacts(
    const IdentificationInput& input, const Segmentation& found, std::span<const double> t_force,
    const PathView& tip, const std::vector<BadInterval>& bad, ObjectPoses& object_poses) {
  std::vector<IdentifiedContact> contacts;
  Attribution attribution(input, found, t_force, tip, object_poses);
  for (const ContactEpisode& episode : found.contacts) {
    IdentifiedContact& contact = contacts.emplace_back(attribution.attribute(episode));
    for (const BadInterval& interval : bad) {
      if (interval.when.end < episode.begin || interval.when.begin > episode.end) continue;
      contact.left_out = interval.reason;
    }
  }
  return contacts;
}

std::vector<IdentifiedContact*> contacts_of(std::vector<IdentifiedContact>& contacts,
                                            std::size_t object, bool presses) {
  std::vector<IdentifiedContact*> chosen;
  for (IdentifiedContact& contact : contacts) {
    const bool is_press = contact.episode.kind == ContactKind::press;
    if (contact.object == object && contact.left_out.empty() && is_press == presses) {
      chosen.push_back(&contact);
    }
  }
  return chosen;
}

}  // namespace pcavr
