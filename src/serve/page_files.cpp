// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "page_files.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "pcavr/base/core/output.hpp"

#include "content_text.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

struct MediaType {
  std::string_view ending;
  const char* name;
  bool is_text;  ///< worth compressing
};
constexpr MediaType kAnyBytes{"", kBinaryMedia, false};
constexpr std::array kMediaTypes{
    MediaType{".html", "text/html; charset=utf-8", true},
    MediaType{".js", "text/javascript; charset=utf-8", true},
    MediaType{".mjs", "text/javascript; charset=utf-8", true},
    MediaType{".css", "text/css; charset=utf-8", true},
    MediaType{".json", kJsonMedia, true},
    MediaType{".webmanifest", "application/manifest+json", true},
    MediaType{".map", kJsonMedia, true},
    MediaType{".txt", "text/plain; charset=utf-8", true},
    MediaType{".svg", "image/svg+xml", true},
    MediaType{".wasm", "application/wasm", true},
    MediaType{".png", "image/png", false},
    MediaType{".jpg", "image/jpeg", false},
    MediaType{".ico", "image/x-icon", false},
    MediaType{".woff2", "font/woff2", false},
    MediaType{".glb", kGlbMedia, true},
};

const MediaType& media_type_of(const fs::path& file) {
  const std::string ending = file.extension().string();
  const auto* const found = std::find_if(kMediaTypes.begin(), kMediaTypes.end(),
                                         [&](const MediaType& t) { return t.ending == ending; });
  return found == kMediaTypes.end() ? kAnyBytes : *found;
}

/// No parent folder (path traversal), no hidden name, only common characters.
bool is_plain(std::string_view path) {
  constexpr std::string_view kOthers = "._-/";
  const bool has_odd_character = std::any_of(path.begin(), path.end(), [&](char c) {
    const bool is_common =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return !is_common && kOthers.find(c) == std::string_view::npos;
  });
  return path.starts_with('/') && !has_odd_character && path.find("/.") == std::string_view::npos &&
         path.find("//") == std::string_view::npos && path.size() < 256;
}

bool is_inside(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

}  // namespace

PageFiles::PageFiles(fs::path folder) : folder_(std::move(folder)) {
  std::error_code ignored;
  folder_ = fs::weakly_canonical(folder_, ignored);
}

Expected<std::shared_ptr<const Content>> PageFiles::find(std::string_view path) const {
  const std::shared_ptr<const Content> nothing;
  const std::string name = path == "/" ? "/index.html" : std::string(path);
  if (!is_plain(name)) return nothing;
  std::error_code fault;
  const fs::path file = fs::canonical(folder_ / name.substr(1), fault);
  if (fault || !is_inside(file, folder_) || !fs::is_regular_file(file, fault)) return nothing;
  const auto changed = fs::last_write_time(file, fault);
  const std::lock_guard lock(mutex_);
  const auto cached = cache_.find(name);
  if (cached != cache_.end() && cached->second.changed == changed) return cached->second.content;
  Expected<std::string> bytes = read_file(file);
  if (!bytes) return bytes.error();
  const MediaType& type = media_type_of(file);
  auto shared =
      std::make_shared<const Content>(type.is_text ? make_content(type.name, std::move(*bytes))
                                                   : Content{type.name, std::move(*bytes), false});
  cache_[name] = {changed, shared};
  return shared;
}

}  // namespace pcavr
