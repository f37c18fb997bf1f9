// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/command_buffer.hpp"

#include <algorithm>
#include <array>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr auto kCommandFields = std::to_array<OptionField<CommandOptions>>({
    {"max_age", &CommandOptions::max_age, 0.1, 0.001, 10.0, "s",
     "time after its execution was due, until which a late command is executed",
     "lower: jitter discards commands; higher: the robot moves to where the operator was"},
    {"max_lead", &CommandOptions::max_lead, 0.5, 0.01, 20.0, "s",
     "time before its execution, until which a command is accepted",
     "lower: jitter of the network is not bridged; higher: a step of the operator's clock lets the "
     "robot move later by as much"},
    {"timeout", &CommandOptions::timeout, 0.25, 0.01, 10.0, "s",
     "time without any message of the other site, after which this one holds",
     "lower: jitter and lost messages hold the robot; higher: it moves on without an operator"},
});
static_assert(are_valid_fields(kCommandFields));

}  // namespace

CommandOptions::CommandOptions() { set_defaults(*this, kCommandFields); }
OptionSection section_of(CommandOptions& options) {
  return make_section("robot_site.link", options, kCommandFields);
}

bool CommandBuffer::add(LinkCommand command, double now) {
  const double lead = command.t - now;
  const bool is_superseded = executed_ && command.t <= *executed_;
  const auto max_waiting = static_cast<std::size_t>(options_.max_lead / kMinCycle);
  if (lead < -options_.max_age || lead > options_.max_lead || is_superseded ||
      waiting_.size() >= max_waiting ||
      !waiting_.try_emplace(command.t, Waiting{std::move(command), now}).second) {
    ++discarded_;
    return false;
  }
  min_lead_ = std::min(min_lead_.value_or(lead), lead);
  return true;
}

std::vector<LinkCommand> CommandBuffer::take_due(double now) {
  std::vector<LinkCommand> due;
  while (!waiting_.empty() && waiting_.begin()->first <= now) {
    auto next = waiting_.extract(waiting_.begin());
    executed_ = next.key();
    p_base_executed_.reset();
    if (next.key() < now - options_.max_age) {
      ++discarded_;  // waited in vain: this site was not running
    } else {
      last_arrival_ = next.mapped().arrival;
      const LinkCommand& command = due.emplace_back(std::move(next.mapped().command));
      if (command.is_engaged) p_base_executed_ = command.p_base_tip;
    }
  }
  return due;
}

std::optional<Eigen::Vector3d> CommandBuffer::p_base_at(double now) const {
  if (!p_base_executed_ || waiting_.empty()) return std::nullopt;
  const auto& [t, next] = *waiting_.begin();
  if (!next.command.is_engaged || now < *executed_) return std::nullopt;
  const double share = (now - *executed_) / (t - *executed_);
  const Eigen::Vector3d p_base = p_base_executed_->cast<double>();
  return p_base + share * (next.command.p_base_tip.cast<double>() - p_base);
}

}  // namespace pcavr
