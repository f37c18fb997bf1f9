// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp
class SiteLog;

/// After an object's frame: the frame of its predicted pose.
inline constexpr char kPredictedFrame[] = "_predicted";

/// The objects' names in the characters of topics and frames: "box 1" is in /tracked/box_1. Names
/// that would have the same topic or frame get a number, except the first: "box_1_2".
[[nodiscard]] std::vector<std::string> topic_parts_of(const std::vector<std::string>& names);

struct BlackBoxOptions {
  BlackBoxOptions();
  double flush_interval;  ///< [s] of a crash that are lost
  double display_rate;    ///< [Hz] of predictions and of the transforms
  int queue_size;         ///< [MiB] between the site's thread and the file
};
[[nodiscard]] OptionSection section_of(BlackBoxOptions& options);

/// Records what a site sends, receives and measures in an MCAP file; docs/link.md lists the topics.
/// After the end of the process, however it ends, the file is readable up to the last
/// `flush_interval`.
///
/// The site's thread copies bytes into a queue of fixed size: it takes no lock, allocates nothing
/// and accesses no file. A thread of this object decodes them and writes the file. Records that do
/// not fit into the queue are dropped, counted, and stated in the file and in the result.
class BlackBox {
 public:
  /// An Error if the file exists or can't be written.
  [[nodiscard]] static Expected<std::unique_ptr<BlackBox>> create(
      const std::filesystem::path& file, const SiteScene& scene,
      const BlackBoxOptions& options = {});
  /// Closes.
  ~BlackBox();
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  /// The log for one site's loop, whose thread calls it.
  [[nodiscard]] SiteLog& log();

  struct Summary {
    std::uint64_t messages = 0;  ///< in the file
    std::uint64_t bytes = 0;
    std::uint64_t dropped = 0;  ///< records that the queue had no space for
  };
  /// Writes the rest and the file's index, after the site has ended. An Error if anything could not
  /// be written.
  [[nodiscard]] Expected<Summary> close();

 private:
  struct Content;
  explicit BlackBox(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
