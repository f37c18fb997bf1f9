// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "pcavr/serve/content.hpp"

namespace pcavr {

inline constexpr char kJsonMedia[] = "application/json";
inline constexpr char kBinaryMedia[] = "application/octet-stream";
inline constexpr char kJpegMedia[] = "image/jpeg";
inline constexpr char kGlbMedia[] = "model/gltf-binary";

/// Gzipped if that makes it smaller.
[[nodiscard]] Content make_content(std::string media_type, std::string body);

/// A name as one segment of a path: everything but letters, digits and -._~ as %XX [RFC 3986].
[[nodiscard]] std::string percent_encoded(std::string_view name);

/// The bytes that were encoded; a % without two digits stays.
[[nodiscard]] std::string percent_decoded(std::string_view text);

}  // namespace pcavr
