// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "pcavr/serve/content.hpp"

namespace pcavr {

/// The page's own files, as they were built: "/" is index.html. Text is compressed once and kept;
/// a file that changed is read again. Nothing outside of the folder, and nothing hidden, is found.
class PageFiles final : public ContentSource {
 public:
  explicit PageFiles(std::filesystem::path folder);

  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view path) const override;

 private:
  struct Kept {
    std::filesystem::file_time_type changed;
    std::shared_ptr<const Content> content;
  };

  std::filesystem::path folder_;  ///< without links
  mutable std::mutex mutex_;
  mutable std::map<std::string, Kept, std::less<>> kept_;
};

}  // namespace pcavr
