// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

struct McapWriterOptions {
  std::string profile = {};          ///< "ros1", "ros2" or empty
  std::size_t max_chunk = 1U << 20;  ///< [bytes] a chunk is written when it has as many
  /// Wall time that a message may wait in memory [s]; see flush_if_due(). 0: each message is a
  /// chunk.
  double flush_interval = 0.1;
  bool replace = false;  ///< replaces an existing file; otherwise that is an Error
};

/// Writes an MCAP file [mcap.dev/spec] under its final name, append-only: after a crash of the
/// process all chunks written up to then are readable, that is all messages up to flush_interval
/// before. Chunks are not compressed and have CRCs and message indexes; close() appends the summary
/// with statistics and chunk indexes, and the footer. Not thread-safe; use one per file. Memory: a
/// chunk, and 100 bytes for each chunk written.
class McapWriter {
 public:
  using Metadata = std::vector<std::pair<std::string, std::string>>;

  [[nodiscard]] static Expected<McapWriter> create(const std::filesystem::path& file,
                                                   const McapWriterOptions& options = {});
  McapWriter(McapWriter&&) noexcept;
  McapWriter& operator=(McapWriter&&) noexcept;
  /// Closes; an Error of that is lost: call close() to get it.
  ~McapWriter();

  /// `encoding` is "jsonschema", "ros1msg", "ros2msg" or another of the MCAP registry. Returns the
  /// schema's id, from 1; throws ContractError after 65535 of them.
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  /// A topic; schema 0: none. `message_encoding` is "json", "ros1", "cdr" or another of the MCAP
  /// registry. Returns the channel's id, from 0; throws ContractError after 65536 of them, and
  /// where the schema was not added.
  std::uint16_t add_channel(std::string_view topic, std::string_view message_encoding,
                            std::uint16_t schema, const Metadata& metadata = {});

  /// Stamps must not be negative and the channel must have been added (otherwise a ContractError).
  /// Messages need not be in the order of time. publish_time: log_time where not given. sequence:
  /// the number of the channel's messages before it where not given.
  [[nodiscard]] Expected<void> write(std::uint16_t channel, Stamp log_time,
                                     std::span<const std::uint8_t> payload,
                                     std::optional<Stamp> publish_time = {},
                                     std::optional<std::uint32_t> sequence = {});
  [[nodiscard]] Expected<void> write(std::uint16_t channel, Stamp log_time,
                                     std::string_view payload,
                                     std::optional<Stamp> publish_time = {});
  /// Writes a metadata record: entries about the file under a name. It may be written at any time,
  /// and again under the same name; what readers make of that is theirs. Flushes.
  [[nodiscard]] Expected<void> write_metadata(std::string_view name, const Metadata& entries);
  /// Writes the metadata by which McapReader, and so every command that reads the file, names the
  /// messages that a recorder dropped: number by topic. The last one written counts.
  [[nodiscard]] Expected<void> write_dropped(const std::map<std::string, std::uint64_t>& dropped);
  /// Writes the messages still in memory as a chunk.
  [[nodiscard]] Expected<void> flush();
  /// The same, if the first of them has waited for flush_interval. write() calls it; call it
  /// regularly where messages pause.
  [[nodiscard]] Expected<void> flush_if_due();
  /// Appends the summary. The writer can't be used afterwards; a second call does nothing.
  [[nodiscard]] Expected<void> close();

  [[nodiscard]] std::uint64_t message_count() const;
  [[nodiscard]] std::uint64_t bytes_written() const;

 private:
  struct State;
  explicit McapWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
