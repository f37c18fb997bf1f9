// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/picture_file.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/recording/image_codec.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxNumberDigits = 9;
constexpr double kMaxPixels = 200e6;  ///< more than any camera has: a header that is wrong

std::optional<int> number_at_end(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::size_t begin = stem.size();
  while (begin > 0 && std::isdigit(static_cast<unsigned char>(stem[begin - 1])) != 0) --begin;
  if (begin == stem.size() || stem.size() - begin > kMaxNumberDigits) return std::nullopt;
  return std::stoi(stem.substr(begin));
}

}  // namespace

Expected<std::vector<NumberedPicture>> list_pictures(const std::string& pictures) {
  std::error_code code;
  const fs::path path(pictures);
  const bool is_folder = fs::is_directory(path, code);
  const fs::path folder = is_folder                ? path
                          : path.has_parent_path() ? path.parent_path()
                                                   : fs::path(".");
  const std::string start = is_folder ? "" : path.filename().string();
  std::map<int, fs::path> files;
  for (fs::directory_iterator entry(folder, code), end; !code && entry != end;
       entry.increment(code)) {
    const fs::path& file = entry->path();
    if (!is_picture_file(file) || !file.filename().string().starts_with(start)) continue;
    const std::optional<int> number = number_at_end(file);
    if (!number) continue;
    const auto [before, is_new] = files.emplace(*number, file);
    if (is_new) continue;
    return Error{
        .message = fmt::format("two pictures have the number {}: {} and {}", *number,
                               before->second.filename().string(), file.filename().string()),
        .file = pictures,
        .hint =
            "give the folder with what the pictures' names begin with, such as "
            "rig/color"};
  }
  if (files.empty()) {
    return Error{.message = "has no pictures: none has a number and is png or jpg",
                 .file = pictures,
                 .hint = "give a folder with a picture for each view, such as color_0.png"};
  }
  std::vector<NumberedPicture> found;
  for (const auto& [number, file] : files) found.push_back({file, number});
  return found;
}

Expected<ColorImage> read_picture(const fs::path& file) {
  const Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  RosCompressedImage compressed;
  compressed.data = {reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()};
  const ImageSize size = image_size(compressed);
  if (size.width <= 0 || size.height <= 0) {
    return Error{.message = "is neither PNG nor JPEG", .file = file.string()};
  }
  if (static_cast<double>(size.width) * size.height > kMaxPixels) {
    return Error{.message = fmt::format("states {} x {} pixels", size.width, size.height),
                 .file = file.string(),
                 .hint = "give pictures of at most 200 million pixels"};
  }
  ImageDecoder decoder;
  return decoder.color(*bytes, {file.string(), size.width, size.height});
}

}  // namespace pcavr
