// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// A folder that appears whole or not at all: it is filled under a temporary name in the same
/// parent folder, and renamed by commit(). Destroyed without commit(), it leaves nothing.
class OutputFolder {
 public:
  /// Fails where `target` exists and is not an empty folder (unless `replace`), or where its
  /// parent can't be written to.
  [[nodiscard]] static Expected<OutputFolder> create(const std::filesystem::path& target,
                                                     bool replace = false);

  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  ~OutputFolder();

  /// Where to write before commit().
  [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }

  /// Renames the folder to its target name. Call once, at the end.
  [[nodiscard]] Expected<void> commit();

 private:
  OutputFolder(std::filesystem::path target, std::filesystem::path temporary, bool replace);

  std::filesystem::path target_;
  std::filesystem::path temporary_;  ///< empty once committed or moved from
  bool replace_ = false;
};

/// Writes the whole file under a temporary name beside `target`, then renames it. A full disk or a
/// folder that can't be written to is an Error, and leaves nothing behind.
[[nodiscard]] Expected<void> write_file(const std::filesystem::path& target,
                                        std::string_view content);

/// Reads a whole file.
[[nodiscard]] Expected<std::string> read_file(const std::filesystem::path& path);

}  // namespace pcavr
