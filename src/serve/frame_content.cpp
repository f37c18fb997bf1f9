// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/frame_content.hpp"

#include <algorithm>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "pcavr/recordings/recording/image_codec.hpp"

#include "numbered_path.hpp"

namespace pcavr {
struct FrameContent::Store {
  Store(AugmentedFrames rendered, int cache_size)
      : frames(std::move(rendered)), max_cached(cache_size) {}

  AugmentedFrames frames;
  int max_cached;
  std::mutex mutex;
  /// FIFO cache of JPEG files by frame, newest last.
  std::deque<std::pair<std::size_t, std::shared_ptr<const Content>>> cached;

  std::shared_ptr<const Content> find_cached(std::size_t frame) {
    const std::lock_guard lock(mutex);
    const auto found = std::find_if(cached.begin(), cached.end(),
                                    [&](const auto& item) { return item.first == frame; });
    return found == cached.end() ? nullptr : found->second;
  }
  void add_to_cache(std::size_t frame, std::shared_ptr<const Content> picture) {
    const std::lock_guard lock(mutex);
    cached.emplace_back(frame, std::move(picture));
    if (std::ssize(cached) > max_cached) cached.pop_front();
  }
};

FrameContent::FrameContent(AugmentedFrames frames, int max_cached)
    : store_(std::make_unique<Store>(std::move(frames), max_cached)) {}
FrameContent::FrameContent(FrameContent&&) noexcept = default;
FrameContent& FrameContent::operator=(FrameContent&&) noexcept = default;
FrameContent::~FrameContent() = default;

Expected<std::shared_ptr<const Content>> FrameContent::find(std::string_view path) const {
  const std::optional<std::size_t> frame = number_in(path, "/api/frames/", ".jpg");
  if (!frame || *frame >= store_->frames.size()) return std::shared_ptr<const Content>();
  if (auto picture = store_->find_cached(*frame)) return picture;
  // One thread: the other cores stay free for the world's thread.
  const Expected<ColorImage> rendered = store_->frames.render(*frame);
  if (!rendered) return rendered.error();
  Expected<std::string> jpeg = encode_color(*rendered);
  if (!jpeg) return jpeg.error();
  const auto picture =
      std::make_shared<const Content>(Content{"image/jpeg", std::move(*jpeg), false});
  store_->add_to_cache(*frame, picture);
  return picture;
}

}  // namespace pcavr
