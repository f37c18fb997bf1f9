// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

struct OutputFileOptions {
  /// Replaces a file that is there already, if it is empty or `is_replaceable`.
  bool replace = false;
  std::string kind = {};  ///< what `is_replaceable` looks for, for the message: "parameter file"
  std::function<bool(const std::filesystem::path& file)> is_replaceable = {};
};

/// A file that a person names, and that appears whole or not at all: it is written under a
/// temporary name beside the target, and renamed by commit(). Destroyed without commit(), it leaves
/// nothing. The target's folder has to be there; symbolic links are followed.
class OutputFile {
 public:
  /// Whether create() would succeed: for the time before long work.
  [[nodiscard]] static Expected<void> check(const std::filesystem::path& target,
                                            const OutputFileOptions& options);
  [[nodiscard]] static Expected<OutputFile> create(const std::filesystem::path& target,
                                                   const OutputFileOptions& options);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();

  /// Where to write before commit(): an empty file with the target's extension.
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Writes all of the content to path().
  [[nodiscard]] Expected<void> write(std::string_view content);

  [[nodiscard]] Expected<void> commit();
  /// Takes a commit() back: the target is what it was before. Where the file system can't exchange
  /// two names, a replaced file is gone, and the new one stays.
  void undo();

 private:
  struct State;
  explicit OutputFile(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pcavr
