// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/robot_picture.hpp"

#include <utility>

#include "numbered_path.hpp"

namespace pcavr {

void RobotPicture::set(const LinkPicture& picture, std::uint32_t number) {
  auto content = std::make_shared<const Content>(
      Content{"image/jpeg", std::string(picture.jpeg.begin(), picture.jpeg.end()), false});
  const std::lock_guard lock(mutex_);
  newest_ = std::move(content);
  number_ = number;
}

Expected<std::shared_ptr<const Content>> RobotPicture::find(std::string_view path) const {
  const std::optional<std::size_t> number = number_in(path, "/api/robot/", ".jpg");
  if (!number) return others_.find(path);
  const std::lock_guard lock(mutex_);
  return *number <= number_ ? newest_ : std::shared_ptr<const Content>();
}

}  // namespace pcavr
