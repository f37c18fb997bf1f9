// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/link/link_keys.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include "pcavr/core/output.hpp"

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

/// Creates a file that must not exist yet, with the mode from the beginning.
Expected<void> create_file(const fs::path& file, mode_t mode, const std::string& content) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor < 0) {
    const bool exists = errno == EEXIST;
    return Error{.message = exists ? "exists already" : std::strerror(errno),
                 .file = file.string(),
                 .hint = exists ? "choose another name; a key is never replaced" : ""};
  }
  const bool is_written =
      ::write(descriptor, content.data(), content.size()) == static_cast<ssize_t>(content.size()) &&
      ::fsync(descriptor) == 0;
  ::close(descriptor);
  if (is_written) return {};
  ::unlink(file.c_str());
  return Error{.message = "can't be written", .file = file.string()};
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
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return Error{.message = "this machine's libzmq has no CurveZMQ"};
  }
  const LinkKeyFiles files{folder / (std::string(name) + ".key"),
                           folder / (std::string(name) + ".pub")};
  const std::string public_line = fmt::format("{}{}\n", kPublicLabel, public_key.data());
  const Expected<void> created =
      create_file(files.public_file, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH, public_line);
  if (!created) return created.error();
  const Expected<void> secret =
      create_file(files.secret_file, S_IRUSR | S_IWUSR,
                  fmt::format("{}{}\n{}", kSecretLabel, secret_key.data(), public_line));
  if (!secret) {
    ::unlink(files.public_file.c_str());
    return secret.error();
  }
  return files;
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

std::optional<std::string> find_authorized(const fs::path& folder, std::string_view public_key) {
  std::error_code fault;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    if (entry->path().extension() == ".pub") files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const Expected<std::string> key = read_public_link_key(file);
    if (key && *key == public_key) return file.stem().string();
  }
  return std::nullopt;
}

}  // namespace pcavr
