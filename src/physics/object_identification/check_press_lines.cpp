// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/press_line.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

/// Difference between the stiffnesses of push and press that is stated: paper C's just noticeable
/// difference of force, beyond the bias of a few per cent by the object's creep.
constexpr double kMaxStiffnessDifference = 0.10;
constexpr double kMinDifferenceStds = 3.0;

bool is_given_by_presses(const ObjectParameters& parameters) {
  return parameters.sources.presses.count("contact.stiffness") > 0;
}

}  // namespace

void check_press_lines(std::vector<Contact>& contacts, std::size_t object,
                       const BreakawayOptions& options, ObjectIdentification& result) {
  const std::optional<HuntCrossley> law = contact_law_of(result.parameters);
  if (!law || !is_given_by_presses(result.parameters)) return;
  std::vector<double> ratios;
  std::size_t different = 0;
  for (Contact* push : contacts_of(contacts, object, false)) {
    push->press_line = compare_with_press(push->series(), push->breakaway, *law, options);
    const IdentifiedParameter& ratio = push->press_line->ratio;
    // Off the centre of mass the object turns under the load: its line is less steep.
    if (!ratio.is_excited || !is_centred(push)) continue;
    ratios.push_back(ratio.value);
    const double difference = std::abs(ratio.value - 1.0);
    const bool is_different =
        difference > kMaxStiffnessDifference && difference > kMinDifferenceStds * ratio.std;
    different += is_different ? 1 : 0;
  }
  if (2 * different <= ratios.size()) return;
  result.notes.push_back(fmt::format(
      "{} of {} pushes rise {:.2f} times (median) as steeply as the press's law predicts: the "
      "faces differ, or the presses were not on this material; the limiting friction uses the "
      "pushes' own lines",
      different, ratios.size(), median(ratios)));
}

}  // namespace pcavr
