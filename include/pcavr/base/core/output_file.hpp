// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct OutputFileOptions {
  /// Replaces an existing file if it is empty or `is_replaceable`.
  bool replace = false;
  std::string kind =
      {};  ///< what `is_replaceable` checks for, as messages name it: "parameter file"
  std::function<bool(const std::filesystem::path& file)> is_replaceable = {};
};

/// A file that the user names, written atomically: under a temporary name in the target's folder,
/// and renamed by commit(). Destroyed without commit(), it leaves nothing. The target's folder must
/// exist; symbolic links are followed.
class OutputFile {
 public:
  /// Whether create() would succeed, to be checked before a long computation.
  [[nodiscard]] static Expected<void> check(const std::filesystem::path& target,
                                            const OutputFileOptions& options);
  [[nodiscard]] static Expected<OutputFile> create(const std::filesystem::path& target,
                                                   const OutputFileOptions& options);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// The file to write to before commit(), empty at first, with the target's extension.
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Writes all of the content to path().
  [[nodiscard]] Expected<void> write(std::string_view content);
  /// Adds to path(), for content that is too large for the memory.
  [[nodiscard]] Expected<void> append(std::string_view content);

  [[nodiscard]] Expected<void> commit();
  /// Reverts commit(): the target is what it was before. Where the file system can't exchange two
  /// names, a replaced file is lost, and the new one stays.
  void undo();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pcavr
