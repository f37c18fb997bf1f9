// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "authorized_keys.hpp"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <system_error>
#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/teleoperation/link/link_keys.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// [s] A file that has changed so recently may change again without another stamp.
constexpr time_t kStampResolution = 2;
constexpr off_t kMaxKeyFile = 65536;  // bytes

bool is_same(const struct stat& a, const struct stat& b) {
  return a.st_ino == b.st_ino && a.st_dev == b.st_dev && a.st_size == b.st_size &&
         a.st_ctim.tv_sec == b.st_ctim.tv_sec && a.st_ctim.tv_nsec == b.st_ctim.tv_nsec;
}

/// Compares the number: where no descriptor is left, the sanitizer can't examine the category.
bool is_gone(const std::error_code& fault) {
  return fault.value() == ENOENT || fault.value() == ENOTDIR;
}

}  // namespace

AuthorizedKeys::AuthorizedKeys(fs::path folder) : folder_(std::move(folder)) { refresh(); }

bool AuthorizedKeys::update(const fs::path& path, File& file) const {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT) return false;
    file.key.clear();
    return true;
  }
  const bool is_settled = std::time(nullptr) > status.st_ctim.tv_sec + kStampResolution;
  if (is_settled && is_same(status, file.status)) return true;
  if (!S_ISREG(status.st_mode) || status.st_size > kMaxKeyFile) {
    file = {status, {}};
    return true;
  }
  const Expected<std::string> content = read_file(path);
  if (!content) return false;
  file = {status, public_link_key_in(*content)};
  return true;
}

std::string AuthorizedKeys::read(Files& files) const {
  std::error_code fault;
  std::string failed;
  for (fs::directory_iterator entry(folder_, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const fs::path& path = entry->path();
    if (path.extension() != ".pub") continue;
    const auto known = files_.find(path);
    File& file = files[path];
    if (known != files_.end()) file = known->second;
    if (!update(path, file)) failed = path.string() + " can't be read";
  }
  if (!fault) return failed;
  files = is_gone(fault) ? Files() : files_;
  return folder_.string() + ": " + std::strerror(fault.value());
}

std::string AuthorizedKeys::refresh() {
  Files files;
  const std::string fault = read(files);
  files_ = std::move(files);
  auto keys = std::make_shared<std::set<std::string, std::less<>>>();
  for (const auto& [path, file] : files_) {
    if (!file.key.empty()) keys->insert(file.key);
  }
  {
    const std::lock_guard lock(mutex_);
    keys_ = std::move(keys);
  }
  const bool has_begun = !fault.empty() && !has_failed_;
  has_failed_ = !fault.empty();
  return has_begun ? fault + ": the keys that were authorised before stay so" : std::string();
}

bool AuthorizedKeys::contains(std::string_view public_key) const {
  std::shared_ptr<const std::set<std::string, std::less<>>> keys;
  {
    const std::lock_guard lock(mutex_);
    keys = keys_;
  }
  return keys->contains(public_key);
}

}  // namespace pcavr
