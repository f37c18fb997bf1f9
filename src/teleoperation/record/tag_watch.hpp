// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {

/// Counts the declared tags in single images of a recording, on a thread of its own, so that the
/// recording does not wait for it. Images come from peers: damaged ones, and depth, say nothing of
/// tags.
class TagWatch {
 public:
  /// An Error for a family that is not known.
  [[nodiscard]] static Expected<std::unique_ptr<TagWatch>> create(
      const std::vector<MarkerId>& declared);
  TagWatch(std::set<MarkerId> declared, TagDetector detector);
  TagWatch(const TagWatch&) = delete;
  TagWatch& operator=(const TagWatch&) = delete;
  ~TagWatch();

  [[nodiscard]] bool is_idle() const;
  /// An image message (CDR) of the type; ignored unless idle.
  void offer(std::size_t topic, const std::string& type, std::span<const std::uint8_t> message);

  struct Sight {
    std::size_t topic = 0;
    std::size_t tags = 0;
  };
  /// The result of the last image, once.
  [[nodiscard]] std::optional<Sight> take();

 private:
  struct Image {
    std::size_t topic = 0;
    std::string type;
    std::vector<std::uint8_t> message;
  };

  void run();
  [[nodiscard]] std::optional<std::size_t> count(const Image& image);

  const std::set<MarkerId> declared_;
  TagDetector detector_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::optional<Image> image_;
  std::optional<Sight> sight_;
  bool is_busy_ = false;
  bool is_stopped_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace pcavr
