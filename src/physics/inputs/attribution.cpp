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
void project_onto(const Eigen::Vector3d& direction_base, const PathView& tip,
                  AttributedContact& contact) {
  ContactEpisode& episode = contact.episode;
  episode.direction_base = direction_base;
  for (std::size_t i = 0; i < episode.t.size(); ++i) {
    episode.tool[i] = tip.at(episode.t[i]).dot(direction_base);
    episode.force[i] = contact.force_base[i].dot(direction_base);
  }
}

class Attribution {
 public:
  Attribution(const InputSeries& series, const Segmentation& found, std::span<const double> t_force,
              const PathView& tip, const InputOptions& options, BodyPoses& poses)
      : series_(series),
        found_(found),
        t_force_(t_force),
        tip_(tip),
        options_(options),
        poses_(poses),
        directions_(series.bodies.size()) {}

  AttributedContact attribute(const ContactEpisode& episode) {
    AttributedContact contact;
    contact.episode = episode;
    if (episode.t.empty() || episode.t.front() > episode.end || episode.t.back() < episode.begin) {
      contact.left_out = "the tool's motion was not recorded during it";
      return contact;
    }
    const auto first = std::lower_bound(t_force_.begin(), t_force_.end(), episode.t.front());
    const auto begin = found_.force_base.begin() + (first - t_force_.begin());
    contact.force_base.assign(begin, begin + std::ssize(episode.t));
    const Eigen::Vector3d p_base_tip = tip_.at(episode.begin);
    std::vector<Touch> touches;
    for (std::size_t i = 0; i < series_.bodies.size(); ++i) {
      touches.push_back(poses_.touch(i, episode.begin, p_base_tip, series_.tool_radius));
    }
    const std::optional<TouchedBody> touched = touched_body(touches, options_);
    if (!touched) {
      contact.left_out = "no known object is at the contact point";
      return contact;
    }
    contact.object = touched->body;
    contact.gap = touches[touched->body].gap;
    contact.normal_object = touches[touched->body].normal_object;
    if (touched->is_ambiguous) contact.left_out = "two objects are at the contact point";
    set_direction(contact);
    check_others(contact);
    return contact;
  }

 private:
  void set_direction(AttributedContact& contact) {
    const ContactEpisode& episode = contact.episode;
    const std::size_t object = *contact.object;
    const Pose T_base_object = poses_.at(object, episode.begin);
    const bool is_on_face =
        align_with_face(T_base_object, series_.bodies[object].model->centre_of_mass_object, tip_,
                        directions_[object], contact);
    if (is_on_face) directions_[object].push_back(episode.direction_base);
    const bool has_moved = episode.kind == ContactKind::slide && series_.bodies[object].is_movable;
    if (has_moved && !poses_.is_tracked(object)) {
      poses_.displace(object, episode.slides.back().end,
                      displacement_at(episode, episode.slides.back().end) * episode.direction_base);
    }
  }

  /// Excludes a push that moves two objects: its force can't be divided.
  void check_others(AttributedContact& contact) const {
    for (std::size_t i = 0; i < series_.bodies.size(); ++i) {
      if (i == *contact.object || !poses_.is_tracked(i)) continue;
      const double moved = translation_distance(poses_.at(i, contact.episode.begin - kAround),
                                                poses_.at(i, contact.episode.end + kAround));
      if (moved > options_.min_other_displacement) {
        contact.left_out = "it also moved " + series_.bodies[i].name;
      }
    }
  }

  const InputSeries& series_;
  const Segmentation& found_;
  std::span<const double> t_force_;
  const PathView& tip_;
  const InputOptions& options_;
  BodyPoses& poses_;
  std::vector<std::vector<Eigen::Vector3d>> directions_;  ///< by object: those of earlier contacts
};

}  // namespace

bool align_with_face(const Pose& T_base_object, const Eigen::Vector3d& centre_of_mass_object,
                     const PathView& tip, std::span<const Eigen::Vector3d> directions_base,
                     AttributedContact& contact) {
  const ContactEpisode& episode = contact.episode;
  Eigen::Vector3d inward = -(T_base_object.rotation() * contact.normal_object);
  const bool is_on_face = inward.dot(episode.direction_base) > kFaceCosine;
  if (is_on_face) {
    // Tracking noise varies a face's direction between contacts: at a lever of half a metre, 0.1
    // degrees would displace each press's surface by a millimetre.
    for (const Eigen::Vector3d& known : directions_base) {
      if (known.dot(inward) > kSameDirection) inward = known;
    }
    project_onto(inward, tip, contact);
  }
  const Eigen::Vector3d arm = tip.at(episode.begin) - T_base_object * centre_of_mass_object;
  const Eigen::Vector2d along = episode.direction_base.head<2>().normalized();
  contact.lever = arm.x() * along.y() - arm.y() * along.x();
  return is_on_face;
}

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

std::vector<AttributedContact> attribute_contacts(const InputSeries& series,
                                                  const Segmentation& found,
                                                  std::span<const double> t_force,
                                                  const PathView& tip,
                                                  std::span<const UnusableInterval> bad,
                                                  const InputOptions& options, BodyPoses& poses) {
  std::vector<AttributedContact> contacts;
  Attribution attribution(series, found, t_force, tip, options, poses);
  for (const ContactEpisode& episode : found.contacts) {
    AttributedContact& contact = contacts.emplace_back(attribution.attribute(episode));
    for (const UnusableInterval& interval : bad) {
      if (interval.end < episode.begin || interval.begin > episode.end) continue;
      contact.left_out = interval.reason;
    }
  }
  return contacts;
}

}  // namespace pcavr
