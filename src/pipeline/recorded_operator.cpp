// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "pcavr/sites/operator_interface.hpp"

namespace pcavr {
namespace {

class RecordedOperator final : public OperatorInterface {
 public:
  explicit RecordedOperator(RecordedCommand command) : command_(std::move(command)) {}

  [[nodiscard]] double start() const override { return command_.start(); }
  [[nodiscard]] std::optional<std::size_t> cycles() const override { return command_.cycles(); }
  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t next, const LinkState*) override {
    return command_.p_base_tip(next - 1);
  }
  [[nodiscard]] OperatorCommand step(std::size_t cycle, LiveOperatorSite& site,
                                     const OperatorLink&) override {
    const Eigen::Vector3d p_base_tip = command_.p_base_tip(cycle);
    site.step(p_base_tip, command_.a_base_tip(cycle));
    return {p_base_tip, Eigen::Quaterniond::Identity(), true, {}};
  }

 private:
  RecordedCommand command_;
};

}  // namespace

Expected<std::unique_ptr<OperatorInterface>> make_recorded_operator(const TeleopInput& world,
                                                                    const TeleopOptions& options) {
  Expected<RecordedCommand> command = RecordedCommand::create(world, options);
  if (!command) return command.error();
  return std::unique_ptr<OperatorInterface>(
      std::make_unique<RecordedOperator>(std::move(*command)));
}

}  // namespace pcavr
