// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/ros2/ros2_robot.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/sites/prediction_sink.hpp"

namespace pcavr {

/// Publishes the predicted bodies over DDS: pose, force of the tip and phase of each, and its frame
/// on /tf [docs/ros2.md]. The site's thread passes predictions on through a queue without locks; a
/// thread of this object encodes and publishes them until the destruction.
class Ros2Publisher final : public PredictionSink {
 public:
  /// An Error where there is no usable network.
  [[nodiscard]] static Expected<std::unique_ptr<Ros2Publisher>> create(
      const Ros2Publication& publication, const SiteScene& scene,
      const Ros2Opener& open = open_dds);
  ~Ros2Publisher() override;
  Ros2Publisher(const Ros2Publisher&) = delete;
  Ros2Publisher& operator=(const Ros2Publisher&) = delete;

  void on_predictions(double ahead,
                      const std::vector<LinkPrediction>& predictions) noexcept override;

 private:
  struct Content;
  explicit Ros2Publisher(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
