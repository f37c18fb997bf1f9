// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_keys.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kKeyCharacters = 40;
constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kMaxKeyName = 64;
constexpr char kSecretLabel[] = "pcavr-link-secret ";
constexpr char kPublicLabel[] = "pcavr-link-public ";

bool is_plain_name(std::string_view name) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  return !name.empty() && name.size() <= kMaxKeyName && name.front() != '.' &&
         name.find_first_not_of(kPlain) == std::string_view::npos;
}

bool is_key(const std::string& text) {
  std::array<std::uint8_t, kKeyBytes> bytes{};
  return text.size() == kKeyCharacters && zmq_z85_decode(bytes.data(), text.c_str()) != nullptr;
}

/// The key after a label at the beginning of a line; empty if there is none.
std::string key_after(std::string_view label, std::string_view content) {
  std::size_t begin = 0;
  while (begin < content.size()) {
    const std::size_t end = std::min(content.find('\n', begin), content.size());
    const std::string_view line = content.substr(begin, end - begin);
    if (line.starts_with(label)) {
      std::string key(line.substr(label.size(), kKeyCharacters));
      const bool is_whole = line.size() == label.size() + kKeyCharacters && is_key(key);
      return is_whole ? key : std::string();
    }
    begin = end + 1;
  }
  return {};
}

Error not_a_key(const fs::path& file, const char* kind) {
  return {.message = std::string("is not a ") + kind + " of pcavr",
          .file = file.string(),
          .hint = "create one with: pcavr keygen NAME -o FOLDER"};
}

Error can_not_create(const fs::path& file, int code) {
  const bool exists = code == EEXIST;
  return {.message = exists ? "exists already" : std::strerror(code),
          .file = file.string(),
          .hint = exists ? "choose another name; a key is never replaced" : ""};
}

/// A new file under a hidden name until commit(); without it nothing remains.
class NewFile {
 public:
  NewFile(fs::path target, mode_t mode, const std::string& content)
      : target_(std::move(target)),
        hidden_(target_.parent_path() / ('.' + target_.filename().string() + ".partial")) {
    ::unlink(hidden_.c_str());  // of a process that was killed
    const int descriptor =
        ::open(hidden_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, mode);
    if (descriptor < 0) {
      failure_ = errno;
      return;
    }
    errno = ENOSPC;  // of a write that takes a part only
    const auto size = static_cast<ssize_t>(content.size());
    const bool is_written =
        ::write(descriptor, content.data(), content.size()) == size && ::fsync(descriptor) == 0;
    if (!is_written) failure_ = errno;
    ::close(descriptor);
  }
  ~NewFile() { ::unlink(hidden_.c_str()); }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Fails where the target exists.
  [[nodiscard]] Expected<void> commit() {
    // Some file systems have only one of the two.
    const bool is_done =
        failure_ == 0 &&
        (::renameat2(AT_FDCWD, hidden_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0 ||
         (errno == EINVAL && ::link(hidden_.c_str(), target_.c_str()) == 0));
    if (failure_ == 0 && !is_done) failure_ = errno;
    return failure_ == 0 ? Expected<void>() : can_not_create(target_, failure_);
  }
  [[nodiscard]] Expected<void> prepared() const {
    return failure_ == 0 ? Expected<void>() : can_not_create(target_, failure_);
  }

 private:
  fs::path target_, hidden_;
  int failure_ = 0;
};

constexpr mode_t kPublicMode = S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH;

std::string public_line(const std::string& key) { return fmt::format("{}{}\n", kPublicLabel, key); }

/// Completes the keys of a process that was killed between the two files, or whose .pub was moved
/// to the other site.
Expected<LinkKeyFiles> complete(const LinkKeyFiles& files) {
  const Expected<LinkKeys> keys = read_link_keys(files.secret_file);
  if (!keys) return keys.error();
  NewFile file(files.public_file, kPublicMode, public_line(keys->public_key));
  const Expected<void> done = file.commit();
  if (!done) return done.error();
  return files;
}

}  // namespace

Expected<LinkKeyFiles> generate_link_keys(const fs::path& folder, std::string_view name) {
  if (!is_plain_name(name)) {
    return Error{.message = "'" + std::string(name) + "' is no name for a key",
                 .hint = "use letters, digits, '-', '_' and '.'"};
  }
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) return Error{.message = fault.message(), .file = folder.string()};
  const LinkKeyFiles files{folder / (std::string(name) + ".key"),
                           folder / (std::string(name) + ".pub")};
  if (fs::exists(files.secret_file, fault) && !fs::exists(files.public_file, fault)) {
    return complete(files);
  }
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return Error{.message = "this machine's libzmq has no CurveZMQ"};
  }
  // The secret key's file contains both halves: of it the other one can be made again.
  NewFile secret(
      files.secret_file, S_IRUSR | S_IWUSR,
      fmt::format("{}{}\n{}", kSecretLabel, secret_key.data(), public_line(public_key.data())));
  NewFile shared(files.public_file, kPublicMode, public_line(public_key.data()));
  Expected<void> done = shared.prepared();
  if (done && fs::exists(files.public_file, fault)) {
    done = can_not_create(files.public_file, EEXIST);
  }
  if (done) done = secret.commit();
  if (!done) return done.error();
  done = shared.commit();
  if (done) return files;
  ::unlink(files.secret_file.c_str());
  return done.error();
}

Expected<LinkKeys> read_link_keys(const fs::path& file) {
  const Expected<std::string> content = read_file(file);
  if (!content) return content.error();
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return Error{.message = "the secret key can be read by others",
                 .file = file.string(),
                 .hint = "chmod 600, or create a new one if others had access"};
  }
  LinkKeys keys{key_after(kPublicLabel, *content), key_after(kSecretLabel, *content)};
  if (keys.public_key.empty() || keys.secret_key.empty()) return not_a_key(file, "secret key");
  return keys;
}

Expected<std::string> read_public_link_key(const fs::path& file) {
  const Expected<std::string> content = read_file(file);
  if (!content) return content.error();
  std::string key = key_after(kPublicLabel, *content);
  if (key.empty()) return not_a_key(file, "public key");
  return key;
}

std::string public_link_key_in(std::string_view content) {
  return key_after(kPublicLabel, content);
}

}  // namespace pcavr
