// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include <sys/stat.h>

namespace pcavr {

/// The public keys in a folder of .pub files, as last read. A file that is gone is a revocation, a
/// folder or file that can't be read (no descriptors left, a broken disk) is none: what was known
/// of it stays. refresh() is for one thread, the rest for all.
class AuthorizedKeys {
 public:
  explicit AuthorizedKeys(std::filesystem::path folder);

  /// Reads what has changed since the last call. A line that states the cause when reading begins
  /// to fail; else empty.
  std::string refresh();
  /// Neither reads a file nor waits for one.
  [[nodiscard]] bool contains(std::string_view public_key) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  struct File {
    struct stat status {};
    std::string key;  ///< empty: not a public key
  };
  using Files = std::map<std::filesystem::path, File>;
  /// The file as it is now. False if it can't be read.
  bool update(const std::filesystem::path& path, File& file) const;
  /// The error's text; empty if all was read.
  std::string read(Files& files) const;

  std::filesystem::path folder_;
  Files files_;
  bool has_failed_ = false;
  mutable std::mutex mutex_;  ///< held for the copy of a pointer
  std::shared_ptr<const std::set<std::string, std::less<>>> keys_;
};

}  // namespace pcavr
