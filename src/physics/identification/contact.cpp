// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/contact.hpp"

#include <algorithm>

namespace pcavr {

Contact delayed(Contact contact, double delay) {
  Breakaway& breakaway = contact.breakaway;
  for (double* t : {&contact.begin, &contact.end, &breakaway.t_contact, &breakaway.t_alarm,
                    &breakaway.t_decided, &breakaway.t}) {
    *t += delay;
  }
  for (SlideInterval& slide : contact.slides) slide.begin += delay, slide.end += delay;
  for (double& t : contact.t) t += delay;
  for (double& t : contact.t_tool) t += delay;
  for (TrackedPose& pose : contact.tracked) pose.t += delay;
  return contact;
}

double displacement_at(const Contact& contact, double t) {
  const auto object_position = [&](double at) {
    const auto after = std::lower_bound(contact.t.begin(), contact.t.end(), at);
    const auto i =
        std::min(static_cast<std::size_t>(after - contact.t.begin()), contact.t.size() - 1);
    const double stiffness = contact.breakaway.stiffness;
    return contact.tool[i] - (stiffness > 0.0 ? contact.force[i] / stiffness : 0.0);
  };
  double displacement = 0.0;
  for (const SlideInterval& slide : contact.slides) {
    displacement +=
        object_position(std::clamp(t, slide.begin, slide.end)) - object_position(slide.begin);
  }
  return displacement;
}

}  // namespace pcavr
