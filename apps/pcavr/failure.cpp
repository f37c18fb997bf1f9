// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "failure.hpp"

#include <filesystem>
#include <new>
#include <string>
#include <system_error>

namespace pcavr::app {
namespace {

Error no_more_threads() {
  return {.message = "the system starts no more threads",
          .hint = "end other programs, raise the limit (ulimit -u), or take fewer --threads"};
}

}  // namespace

Error error_of(const std::exception& failure) {
  const std::string what = failure.what();
  // OpenCV has an exception of its own for it.
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr ||
      what.find("Insufficient memory") != what.npos) {
    return {.message = "memory ran out",
            .hint = "free some, raise the limit (ulimit -v), or take fewer --threads"};
  }
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&failure)) {
    return {.message = file->code().message(), .file = file->path1().string()};
  }
  if (const auto* system = dynamic_cast<const std::system_error*>(&failure)) {
    if (system->code() == std::errc::resource_unavailable_try_again) return no_more_threads();
    return {.message = "the system refused: " + system->code().message()};
  }
  // oneTBB has none of its own for it.
  if (what.find("pthread_create") != what.npos) return no_more_threads();
  return {.message = "internal error: " + what,
          .hint = "please report it with the command that you ran"};
}

nlohmann::ordered_json error_json(const Error& error, int exit_code) {
  nlohmann::ordered_json json{{"message", error.message}};
  if (!error.file.empty()) json["file"] = error.file;
  if (error.line > 0) json["line"] = error.line;
  if (!error.place.empty()) json["place"] = error.place;
  if (!error.hint.empty()) json["hint"] = error.hint;
  json["text"] = error.to_string();
  json["exit_code"] = exit_code;
  return {{"error", json}};
}

}  // namespace pcavr::app
