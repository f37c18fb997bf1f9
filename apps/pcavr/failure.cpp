// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "failure.hpp"

#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "pcavr/base/core/utf8.hpp"

namespace pcavr::app {
namespace {

Error thread_limit_error() {
  return {.message = "can't create a thread: the system's limit is reached",
          .hint = "close other programs, raise the limit (ulimit -u), or use fewer --threads"};
}

}  // namespace

Error error_of(const std::exception& failure) {
  const std::string what = failure.what();
  // OpenCV throws its own exception type.
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr ||
      what.find("Insufficient memory") != what.npos) {
    return {.message = "out of memory",
            .hint = "free memory, raise the limit (ulimit -v), or use fewer --threads"};
  }
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&failure)) {
    return {.message = file->code().message(), .file = file->path1().string()};
  }
  if (const auto* system = dynamic_cast<const std::system_error*>(&failure)) {
    if (system->code() == std::errc::resource_unavailable_try_again) return thread_limit_error();
    return {.message = "system error: " + system->code().message()};
  }
  // oneTBB reports a failed pthread_create only in the text.
  if (what.find("pthread_create") != what.npos) return thread_limit_error();
  return {.message = "internal error: " + what,
          .hint = "this is a bug; please report it with the command line"};
}

nlohmann::ordered_json error_json(const Error& error, int exit_code) {
  nlohmann::ordered_json json{{"message", printable(error.message)}};
  if (!error.file.empty()) json["file"] = error.file;
  if (error.line > 0) json["line"] = error.line;
  if (!error.place.empty()) json["place"] = printable(error.place);
  if (!error.hint.empty()) json["hint"] = printable(error.hint);
  json["text"] = error.to_string();
  json["exit_code"] = exit_code;
  return {{"error", json}};
}

}  // namespace pcavr::app
