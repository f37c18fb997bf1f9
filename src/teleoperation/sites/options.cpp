// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/teleoperation/sites/link_sites.hpp"

namespace pcavr {
namespace {

constexpr auto kRobotSiteFields = std::to_array<OptionField<RobotSiteOptions>>({
    {"cycle", &RobotSiteOptions::cycle, 0.001, 2e-4, 0.1, "s", "period of the site's loop",
     "lower: computing time; higher: the tool moves in steps"},
    {"state_rate", &RobotSiteOptions::state_rate, 100.0, 1.0, 1000.0, "Hz",
     "states sent to the operator's site",
     "lower: the operator sees the robot late; higher: bandwidth"},
    {"start_delay", &RobotSiteOptions::start_delay, 1.5, 0.0, 60.0, "s",
     "time from the first operator's arrival to the beginning of a recording",
     "lower: the operator's clock is not known when it begins; higher: waiting"},
});
static_assert(are_valid_fields(kRobotSiteFields));

constexpr auto kOperatorSiteFields = std::to_array<OptionField<OperatorSiteOptions>>({
    {"connection_timeout", &OperatorSiteOptions::connection_timeout, 10.0, 0.1, 3600.0, "s",
     "time until the first connection to the robot's site is given up",
     "lower: a slow link is given up; higher: a wrong address is noticed late"},
    {"timeout", &OperatorSiteOptions::timeout, 0.25, 0.01, 10.0, "s",
     "time without any message of the robot's site, after which the link counts as lost",
     "lower: jitter opens the clutch; higher: the operator moves a tool that nothing follows"},
    {"lead_margin", &OperatorSiteOptions::lead_margin, 0.005, 0.0, 1.0, "s",
     "time by which commands shall arrive before their execution, beyond four variations of the "
     "delay",
     "lower: commands are executed late; higher: predicts further than necessary"},
    {"correction_margin", &OperatorSiteOptions::correction_margin, 0.02, 0.0, 1.0, "s",
     "time by which corrections shall arrive before a command contains them, beyond four "
     "variations of the delay",
     "lower: it depends on the machines' load which command contains a correction, and no run is "
     "like another; higher: the world is corrected later than necessary"},
    {"min_clock_time", &OperatorSiteOptions::min_clock_time, 0.5, 0.05, 60.0, "s",
     "time of round trips before the first command",
     "lower: the clock is uncertain at first; higher: waiting"},
});
static_assert(are_valid_fields(kOperatorSiteFields));

}  // namespace

RobotSiteOptions::RobotSiteOptions() { set_defaults(*this, kRobotSiteFields); }
OptionSection section_of(RobotSiteOptions& options) {
  return make_section("robot_site", options, kRobotSiteFields);
}

OperatorSiteOptions::OperatorSiteOptions() { set_defaults(*this, kOperatorSiteFields); }
OptionSection section_of(OperatorSiteOptions& options) {
  return make_section("operator_site", options, kOperatorSiteFields);
}

}  // namespace pcavr
