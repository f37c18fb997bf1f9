// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/link/picture_pacer.hpp"
#include "pcavr/teleoperation/sites/picture_source.hpp"

#include "picture_encoder.hpp"

namespace pcavr {

/// The pictures of a robot's camera, in its site's cycle: which is sent when. One thread.
class PictureFeed {
 public:
  /// `source`: null if there is no camera; kept.
  PictureFeed(PictureSource* source, const PictureOptions& options) : pacer_(options) {
    if (source != nullptr && options.max_rate > 0.0) encoder_.emplace(*source);
  }

  /// A picture to be sent now; `start` [s]: time zero of the scene on the shared clock.
  [[nodiscard]] std::optional<LinkPicture> step(double now, double start) {
    if (!encoder_) return std::nullopt;
    std::optional<LinkPicture> picture = encoder_->take();
    if (picture) {
      picture->t += start;
      return picture;
    }
    if (now < next_request_) return std::nullopt;
    if (const std::optional<std::size_t> bytes = pacer_.max_bytes(now)) {
      next_request_ = now + kRequestInterval;
      encoder_->request(now - start, *bytes);
    }
    return std::nullopt;
  }
  void note_sent(std::uint32_t sequence, std::size_t bytes, double now) {
    pacer_.note_sent(sequence, bytes, now);
  }
  void note_receipt(const LinkPictureReceipt& receipt, double now) {
    pacer_.note_receipt(receipt.sequence, receipt.received, now);
  }
  void restart() { pacer_.restart(); }
  [[nodiscard]] std::optional<std::string> take_fault() {
    return encoder_ ? encoder_->take_fault() : std::nullopt;
  }

 private:
  static constexpr double kRequestInterval = 0.005;  // [s] until the camera has another one

  PicturePacer pacer_;
  std::optional<PictureEncoder> encoder_ = {};
  double next_request_ = 0.0;  ///< [s]
};

}  // namespace pcavr
