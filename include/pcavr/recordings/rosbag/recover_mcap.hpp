// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

struct McapRecovery {
  bool is_whole = false;       ///< nothing was wrong, and nothing is written
  std::uint64_t messages = 0;  ///< kept, as all below; of a whole file all that it has
  std::size_t topics = 0;
  std::uint64_t bytes = 0;       ///< of the input
  std::uint64_t lost_bytes = 0;  ///< of the input, which are not kept
  /// Messages that the lost bytes begin with; nullopt where what follows can't be counted, as it is
  /// damaged. Those that never came into the file are not known.
  std::optional<std::uint64_t> lost_messages = 0;
  std::uint64_t left_out_attachments = 0;
  std::string damage = {};  ///< what ends the readable part, where that is not the file's end
};

struct McapRecoveryOptions {
  /// Replaces another MCAP file that exists, and the input where it is damaged before its end; an
  /// input that is cut is replaced always.
  bool replace = false;
};

/// Writes the channels, schemas, metadata (up to 1 MiB each) and messages of an MCAP file up to its
/// last whole record to `output`, with chunks, index and end: for files whose writer was killed.
/// Stamps, sequence numbers and payloads are as they were, ids of channels and schemas are new.
/// `output` is written under a temporary name and renamed; it may be `file`. An Error, and no file,
/// where the input is no MCAP file or has no whole message. Same input, same bytes. Safe for
/// untrusted files, as open_bag().
[[nodiscard]] Expected<McapRecovery> recover_mcap(const std::filesystem::path& file,
                                                  const std::filesystem::path& output,
                                                  const McapRecoveryOptions& options = {});

}  // namespace pcavr
