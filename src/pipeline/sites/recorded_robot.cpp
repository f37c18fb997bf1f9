// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/recorded_robot.hpp"

#include <algorithm>
#include <utility>

namespace pcavr {
namespace {

class RecordedRobot final : public RobotInterface {
 public:
  RecordedRobot(const TeleopInput& input, double tracking_latency,
                std::unique_ptr<PictureSource> pictures)
      : input_(input),
        tracking_latency_(tracking_latency),
        pictures_(std::move(pictures)),
        next_tracked_(input.objects.size(), 0) {}

  [[nodiscard]] std::string name() const override { return "recording"; }
  [[nodiscard]] bool follows_commands() const override { return false; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override {
    return input_.p_base_tip.empty() ? Eigen::Vector3d::Zero().eval() : input_.p_base_tip.front();
  }
  void set_command(const Eigen::Vector3d&, const Eigen::Quaterniond&) override {}

  void advance(double t, RobotSamples& samples) override {
    for (; next_tool_ < input_.t_tool.size() && input_.t_tool[next_tool_] <= t; ++next_tool_) {
      RobotSamples::Tool& tool = samples.tool.emplace_back();
      tool.t = input_.t_tool[next_tool_];
      tool.p_base_tip = input_.p_base_tip[next_tool_];
      if (!input_.q_base_tool.empty()) tool.q_base_tool = input_.q_base_tool[next_tool_];
    }
    for (; next_wrench_ < input_.t_force.size() && input_.t_force[next_wrench_] <= t;
         ++next_wrench_) {
      RobotSamples::Wrench& wrench = samples.wrench.emplace_back();
      wrench.t = input_.t_force[next_wrench_];
      wrench.force_base = input_.force_base[next_wrench_];
    }
    for (std::size_t i = 0; i < input_.objects.size(); ++i) {
      const std::vector<TrackedPose>& tracked = input_.objects[i].tracked;
      std::size_t& next = next_tracked_[i];
      for (; next < tracked.size() && tracked[next].t + tracking_latency_ <= t; ++next) {
        samples.tracked.push_back({i, tracked[next]});
      }
    }
  }

  [[nodiscard]] std::optional<double> end() const override {
    double last = input_.t_tool.empty() ? 0.0 : input_.t_tool.back();
    if (!input_.t_force.empty()) last = std::max(last, input_.t_force.back());
    return last;
  }
  [[nodiscard]] PictureSource* pictures() override { return pictures_.get(); }

 private:
  const TeleopInput& input_;
  double tracking_latency_;
  std::unique_ptr<PictureSource> pictures_;
  std::size_t next_tool_ = 0;
  std::size_t next_wrench_ = 0;
  std::vector<std::size_t> next_tracked_;
};

}  // namespace

std::unique_ptr<RobotInterface> make_recorded_robot(const TeleopInput& input,
                                                    double tracking_latency,
                                                    std::unique_ptr<PictureSource> pictures) {
  return std::make_unique<RecordedRobot>(input, tracking_latency, std::move(pictures));
}

}  // namespace pcavr
