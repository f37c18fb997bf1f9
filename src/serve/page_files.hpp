// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "pcavr/serve/content.hpp"

namespace pcavr {

/// The page's static files as built: "/" is index.html. Text is compressed once and cached; a file
/// that has changed is read again. Files outside the folder (path traversal, symbolic links) and
/// hidden files are not found.
class PageFiles final : public ContentSource {
 public:
  explicit PageFiles(std::filesystem::path folder);

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  struct CacheEntry {
    std::filesystem::file_time_type changed;
    std::shared_ptr<const Content> content;
  };

  std::filesystem::path folder_;  ///< without symbolic links
  mutable std::mutex mutex_;
  mutable std::map<std::string, CacheEntry, std::less<>> cache_;
};

}  // namespace pcavr
