// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/lens.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/page_world.hpp"
#include "pcavr/serve/viewer_scene.hpp"

namespace pcavr {

using ViewerPayload = std::shared_ptr<const std::vector<std::uint8_t>>;

/// The channels that other viewers can subscribe to: the world as ROS 2 messages in CDR. Topics and
/// frames are those of a site's black box (docs/live-protocol.md). Encodes each message once for
/// all viewers. One thread.
class ViewerChannels {
 public:
  enum class Rate {
    once,    ///< the same for the server's life
    slow,    ///< once a second
    changed  ///< with each state
  };
  struct Channel {
    std::uint32_t id = 0;
    std::string topic;
    std::string_view schema_name;
    std::string schema;  ///< ros2msg
    Rate rate = Rate::changed;
  };

  /// Keeps references to `world` and `content`, which must outlive it.
  ViewerChannels(PageWorld& world, const ContentSource& content, ViewerScene scene);

  [[nodiscard]] const std::vector<Channel>& channels() const { return channels_; }
  [[nodiscard]] const Channel* find(std::uint64_t id) const;

  /// Call it before the messages of another state: `now` [s] by LiveWorld::clock.
  void update(double now);
  /// Stamp of the state that was encoded last, by the system's clock.
  [[nodiscard]] Stamp stamp() const { return stamp_; }
  /// The newest message; null where there is none yet, or none that is newer than the last state's.
  [[nodiscard]] ViewerPayload payload(const Channel& channel);

 private:
  /// An empty message: nothing to say.
  using Encode = std::function<std::vector<std::uint8_t>(const WorldSnapshot&)>;
  struct Source {
    Encode encode;
    ViewerPayload newest = {};
    std::uint64_t update = 0;  ///< when `newest` was encoded
  };

  void add(std::string topic, std::string_view schema_name, std::string schema, Rate rate,
           Encode encode);
  void add_scene();
  void add_motion();
  void add_link();
  void add_state();
  [[nodiscard]] std::vector<std::uint8_t> encode_transforms(const WorldSnapshot& snapshot) const;
  [[nodiscard]] std::vector<std::uint8_t> encode_parameters() const;
  [[nodiscard]] std::vector<std::uint8_t> encode_phases(const WorldSnapshot& snapshot) const;
  [[nodiscard]] std::vector<std::uint8_t> encode_diagnostics(const WorldSnapshot& snapshot) const;
  [[nodiscard]] std::vector<std::uint8_t> encode_picture(const WorldSnapshot& snapshot);
  /// Of each picture whose camera is known.
  [[nodiscard]] std::vector<std::uint8_t> encode_camera(const WorldSnapshot& snapshot);
  /// When the newest picture was taken, by the system's clock.
  [[nodiscard]] Stamp taken(const LinkSnapshot& link) const;

  PageWorld& world_;
  const ContentSource& content_;
  ViewerScene scene_;
  std::vector<std::string> frames_;  ///< of the bodies
  std::vector<Channel> channels_;    ///< ids from 1
  std::vector<Source> sources_;
  Stamp clock_start_;  ///< the system's clock at 0 of LiveWorld::clock
  Stamp stamp_;
  std::uint64_t updates_ = 0;
  std::uint32_t picture_ = 0;            ///< number of the last one
  std::uint32_t described_picture_ = 0;  ///< number of the last one whose camera was encoded
  LensDistortion lens_;                  ///< that camera's, by these coefficients
  std::array<float, 8> coefficients_ = {};
};

}  // namespace pcavr
