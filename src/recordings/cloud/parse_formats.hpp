// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/recordings/cloud/cloud_file.hpp"

namespace pcavr {

/// Largest number of points, more than any sensor's frame; keeps counts and products of sizes in
/// range.
inline constexpr std::size_t kMaxCloudPoints = 100'000'000;

[[nodiscard]] Expected<RecordedCloud> parse_pcd(std::string_view bytes, const std::string& file);
[[nodiscard]] Expected<RecordedCloud> parse_ply(std::string_view bytes, const std::string& file);

/// Decompresses LZF [Lehmann, liblzf], the compression of binary_compressed PCD files; nullopt
/// unless it yields exactly `size` bytes.
[[nodiscard]] std::optional<std::string> decompress_lzf(std::string_view compressed,
                                                        std::size_t size);

/// A whole number of points or bytes up to 2^63; nullopt for other texts.
[[nodiscard]] std::optional<std::size_t> parse_count(std::string_view text);

/// The fields of a header's line.
[[nodiscard]] std::vector<std::string> split_fields(std::string_view line);

/// The pose from a header's numbers; nullopt where they are no rigid transformation.
[[nodiscard]] std::optional<Pose> header_pose(const Eigen::Vector3d& position,
                                              const Eigen::Quaterniond& rotation);

/// Errors of both formats.
[[nodiscard]] Error cloud_error(const std::string& file, int line, std::string message,
                                std::string hint);
[[nodiscard]] Error truncated_error(const std::string& file, std::size_t points,
                                    std::size_t bytes_needed, std::size_t bytes_there);

}  // namespace pcavr
