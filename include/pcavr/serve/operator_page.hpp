// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/page_world.hpp"
#include "pcavr/serve/robot_picture.hpp"
#include "pcavr/serve/scene_arm.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"
#include "pcavr/teleoperation/sites/operator_interface.hpp"

namespace pcavr {

/// The person at a page or a device as the operator of an operator's site, and the world that the
/// site's pages show: the scene, with the bodies as the site predicts and the robot's site corrects
/// them. The site's thread calls it as OperatorInterface, the server as PageWorld.
///
/// Without a session the bodies stay as they were last predicted and the clutch is open; it must be
/// opened before it closes again. The tool moves within the robot's limits, so that the robot can
/// follow it.
class OperatorPage final : public OperatorInterface, public PageWorld {
 public:
  /// `objects`: names in the order of the site's world, which the model must have too, in any
  /// order: else an Error.
  [[nodiscard]] static Expected<std::unique_ptr<OperatorPage>> create(
      HapticWorldModel model, const std::vector<std::string>& objects,
      std::unique_ptr<Device> device, const LiveWorldOptions& options, const MotionLimits& limits,
      std::unique_ptr<LiveArm> arm = nullptr);
  ~OperatorPage() override;

  /// Sets where pages find the pictures of the robot's camera; kept. Call it before the site runs.
  void set_pictures(RobotPicture& pictures);

  // The site's thread.
  [[nodiscard]] bool needs_follower() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start(std::size_t next, const LinkState* robot) override;
  void begin(LiveOperatorSite& site) override;
  [[nodiscard]] OperatorCommand step(std::size_t cycle, LiveOperatorSite& site,
                                     const OperatorLink& link) override;
  void end() override;
  void wait(const OperatorLink& link) override;
  void show_picture(const LinkPicture& picture, double t) override;
  [[nodiscard]] OperatorRequests take_requests() override;

  // Any thread, as in PageWorld.
  [[nodiscard]] const std::vector<std::string>& notes() const override;
  [[nodiscard]] const std::vector<std::string>& names() const override;
  [[nodiscard]] std::string_view device_name() const override;
  [[nodiscard]] RemoteDevice* page_device() noexcept override;
  [[nodiscard]] bool is_remote() const noexcept override { return true; }
  void hold(bool is_on_hold) noexcept override;
  void emergency_stop() noexcept override;
  void release_emergency_stop() noexcept override;
  void reset() noexcept override {}
  void undo_reset() noexcept override {}
  void set_time_scale(double) noexcept override {}
  [[nodiscard]] double time_scale() const noexcept override { return 1.0; }
  [[nodiscard]] const WorldSnapshot& newest() noexcept override;

 private:
  struct Content;
  explicit OperatorPage(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
