// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// Farther away a surface is no candidate.
constexpr float kSearchRadius = 0.2F;  // [m]
/// What poses, CAD files and a tip's radius may be off together.
constexpr double kMaxGap = 0.015;  // [m]
/// Nearer to each other than this, two surfaces can't be told apart as the one touched.
constexpr double kTellsApart = 0.003;  // [m]
/// A face's normal this near to the force gives the direction; the force itself is noisy.
constexpr double kFaceCosine = 0.9;
constexpr double kSameDirection = 0.9998;  // 1 degree
/// Of the tip's radius: deeper than the rest of it no tip sinks in, and poses are off by less.
constexpr double kMinDistance = 0.3;
/// [m] an object that another contact moved while one was touched.
constexpr double kMovedToo = 0.003;

/// The contact's series along `direction`, which is exact where the mean force's is not.
void lay_along(const Eigen::Vector3d& direction_base, const PathView& tip,
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
              std::span<const double> t_force, const PathView& tip, ObjectPlaces& places)
      : input_(input),
        found_(found),
        t_force_(t_force),
        tip_(tip),
        places_(places),
        directions_(input.objects.size()) {}

  IdentifiedContact attribute(const ContactEpisode& episode) {
    IdentifiedContact contact;
    contact.episode = episode;
    if (episode.t.empty() || episode.t.front() > episode.end || episode.t.back() < episode.begin) {
      contact.left_out = "the tool was not recorded meanwhile";
      return contact;
    }
    const auto first = std::lower_bound(t_force_.begin(), t_force_.end(), episode.t.front());
    const auto begin = found_.force_base.begin() + (first - t_force_.begin());
    contact.force_base.assign(begin, begin + std::ssize(episode.t));
    const Eigen::Vector3d p_base_tip = tip_.at(episode.begin);
    std::optional<ObjectPlaces::Touch> nearest, second;
    for (std::size_t i = 0; i < input_.objects.size(); ++i) {
      const auto touch = places_.touch(i, episode.begin, p_base_tip, input_.tool_radius);
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
      contact.left_out = "no known object is where the tool touched";
      return contact;
    }
    contact.gap = nearest->gap;
    contact.normal_object = nearest->normal_object;
    const bool is_shared = second && second->gap - nearest->gap < kTellsApart;
    if (is_shared) contact.left_out = "two objects are where the tool touched";
    settle(contact);
    check_others(contact);
    return contact;
  }

 private:
  void settle(IdentifiedContact& contact) {
    ContactEpisode& episode = contact.episode;
    const std::size_t object = *contact.object;
    const Pose T_base_object = places_.at(object, episode.begin);
    Eigen::Vector3d inward = -(T_base_object.rotation() * contact.normal_object);
    if (inward.dot(episode.direction_base) > kFaceCosine) {
      // Tracked anew at each contact, a face's direction shakes: at an arm of half a metre, 0.1
      // degrees would put each press's surface a millimetre elsewhere.
      for (const Eigen::Vector3d& known : directions_[object]) {
        if (known.dot(inward) > kSameDirection) inward = known;
      }
      directions_[object].push_back(inward);
      lay_along(inward, tip_, contact);
    }
    const Eigen::Vector3d arm =
        tip_.at(episode.begin) - T_base_object * input_.objects[object].model.centre_of_mass_object;
    const Eigen::Vector2d along = episode.direction_base.head<2>().normalized();
    contact.lever = arm.x() * along.y() - arm.y() * along.x();
    if (episode.kind == ContactKind::slide && !places_.is_tracked(object)) {
      places_.moved(object, episode.slides.back().end,
                    way_at(episode, episode.slides.back().end) * episode.direction_base);
    }
  }

  /// One push that moves two objects tells of neither alone.
  void check_others(IdentifiedContact& contact) const {
    for (std::size_t i = 0; i < input_.objects.size(); ++i) {
      if (i == *contact.object || !places_.is_tracked(i)) continue;
      const double moved = translation_distance(places_.at(i, contact.episode.begin - 0.1),
                                                places_.at(i, contact.episode.end + 0.1));
      if (moved > kMovedToo) {
        contact.left_out = "it moved " + input_.objects[i].name + ", too";
      }
    }
  }

  const IdentificationInput& input_;
  const Segmentation& found_;
  std::span<const double> t_force_;
  const PathView& tip_;
  ObjectPlaces& places_;
  std::vector<std::vector<Eigen::Vector3d>> directions_;  ///< by object: those of earlier contacts
};

}  // namespace

double way_at(const ContactEpisode& episode, double t) {
  const auto place = [&](double at) {
    const auto after = std::lower_bound(episode.t.begin(), episode.t.end(), at);
    const auto i =
        std::min(static_cast<std::size_t>(after - episode.t.begin()), episode.t.size() - 1);
    const double stiffness = episode.breakaway.stiffness;
    return episode.tool[i] - (stiffness > 0.0 ? episode.force[i] / stiffness : 0.0);
  };
  double way = 0.0;
  for (const SlideInterval& slide : episode.slides) {
    way += place(std::clamp(t, slide.begin, slide.end)) - place(slide.begin);
  }
  return way;
}

ObjectPlaces::ObjectPlaces(const std::vector<IdentifiableObject>& objects)
    : objects_(objects), steps_(objects.size()) {
  for (const IdentifiableObject& object : objects) surfaces_.emplace_back(object.model.mesh_object);
}

bool ObjectPlaces::is_tracked(std::size_t object) const {
  return !objects_[object].tracked.empty();
}

Pose ObjectPlaces::at(std::size_t object, double t) const {
  if (is_tracked(object)) return pose_at(objects_[object].tracked, t);
  const Pose& start = objects_[object].T_base_object;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (const Step& step : steps_[object]) {
    if (step.t <= t) moved = step.total_base;
  }
  return Pose(start.rotation(), start.translation() + moved);
}

void ObjectPlaces::moved(std::size_t object, double t, const Eigen::Vector3d& way_base) {
  std::vector<Step>& steps = steps_[object];
  const Eigen::Vector3d before =
      steps.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : steps.back().total_base;
  // A body on its support keeps its height.
  steps.push_back({t, before + Eigen::Vector3d(way_base.x(), way_base.y(), 0.0)});
}

std::optional<ObjectPlaces::Touch> ObjectPlaces::touch(std::size_t object, double t,
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
  // A centre this near to the surface, or behind it, has no direction to it of its own.
  const bool has_direction = !is_inside && distance > kMinDistance * tool_radius;
  const Eigen::Vector3d inward =
      has_direction ? Eigen::Vector3d((point - p_object) / distance) : Eigen::Vector3d(-normal);
  return Touch{(is_inside ? -distance : distance) - tool_radius, normal,
               T_base_object.rotation() * inward};
}

std::vector<IdentifiedContact> attribute_contacts(
    const IdentificationInput& input, const Segmentation& found, std::span<const double> t_force,
    const PathView& tip, const std::vector<BadStretch>& bad, ObjectPlaces& places) {
  std::vector<IdentifiedContact> contacts;
  Attribution attribution(input, found, t_force, tip, places);
  for (const ContactEpisode& episode : found.contacts) {
    IdentifiedContact& contact = contacts.emplace_back(attribution.attribute(episode));
    for (const BadStretch& stretch : bad) {
      if (stretch.when.end < episode.begin || stretch.when.begin > episode.end) continue;
      contact.left_out = stretch.reason;
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
