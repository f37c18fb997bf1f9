// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace pcavr::mcap {

// The MCAP file format, version 0 [https://mcap.dev/spec].

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

/// Opcode and length of a record.
inline constexpr std::size_t kRecordHead = 9;
/// The footer's content: two offsets and the summary's CRC.
inline constexpr std::size_t kFooterSize = 20;

/// Name of the metadata with the messages that a recorder dropped: number by topic. The last one of
/// a file counts.
inline constexpr std::string_view kDropsMetadata = "pcavr.dropped";

}  // namespace pcavr::mcap
