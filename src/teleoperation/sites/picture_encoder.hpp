// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/sites/picture_source.hpp"

namespace pcavr {

/// A picture as JPEG of at most `max_bytes`: first of less quality, then of half the size, down to
/// the coarsest one. `quality` is that of the last picture, and becomes this one's.
[[nodiscard]] Expected<LinkPicture> encode_picture(const CameraPicture& picture,
                                                   std::size_t max_bytes, int& quality);

/// Takes pictures from a source and encodes them on a thread of its own, one after the other, when
/// the site's thread asks for one.
class PictureEncoder {
 public:
  /// Keeps the reference.
  explicit PictureEncoder(PictureSource& source);
  ~PictureEncoder();
  PictureEncoder(const PictureEncoder&) = delete;
  PictureEncoder& operator=(const PictureEncoder&) = delete;

  /// Asks for the newest picture at `t` [s of the scene], unless one is in the making.
  void request(double t, std::size_t max_bytes);
  /// The last one asked for, once; LinkPicture::t is in seconds of the scene.
  [[nodiscard]] std::optional<LinkPicture> take();
  /// Why the last one could not be made, once.
  [[nodiscard]] std::optional<std::string> take_fault();

 private:
  struct Request {
    double t = 0.0;
    std::size_t max_bytes = 0;
  };
  void run();
  [[nodiscard]] Expected<std::optional<LinkPicture>> newest(const Request& wanted, int& quality);

  PictureSource& source_;
  std::mutex mutex_;
  std::condition_variable requested_;
  std::optional<Request> request_ = {};  ///< until its picture is made
  std::optional<LinkPicture> made_ = {};
  std::optional<std::string> fault_ = {};
  bool is_stopped_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace pcavr
