// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recover_log.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "pcavr/recordings/rosbag/recover_mcap.hpp"

namespace pcavr::app {
namespace fs = std::filesystem;
namespace {

fs::path output_of(const fs::path& file, const OutputOption& output) {
  if (!output.folder.empty()) return output.folder;
  return file.parent_path() / (file.stem().string() + "-recovered.mcap");
}

std::string lost_text(const McapRecovery& recovery) {
  if (recovery.lost_bytes == 0) return "lost: nothing of what it has; its index was absent";
  std::string text = fmt::format("lost: {} bytes", recovery.lost_bytes);
  if (!recovery.lost_messages) return text + ", whose messages can't be counted";
  return text + (*recovery.lost_messages > 0 ? ", a message that is cut" : ", no message");
}

nlohmann::ordered_json json_of(const McapRecovery& recovery, const std::string& file,
                               const fs::path& output) {
  nlohmann::ordered_json json{{"file", file},
                              {"is_whole", recovery.is_whole},
                              {"messages", recovery.messages},
                              {"topics", recovery.topics},
                              {"bytes", recovery.bytes},
                              {"lost_bytes", recovery.lost_bytes}};
  json["lost_messages"] = nullptr;
  if (recovery.lost_messages) json["lost_messages"] = *recovery.lost_messages;
  json["output"] = nullptr;
  if (!recovery.is_whole) json["output"] = output.string();
  return json;
}

}  // namespace

Expected<CommandResult> recover_log(const std::string& file, const OutputOption& output,
                                    const Observer& observer) {
  const fs::path target = output_of(file, output);
  if (target.extension() != ".mcap") {
    return Error{.message = "is no name of an MCAP file",
                 .file = target.string(),
                 .place = "--output",
                 .hint = "let it end in .mcap"};
  }
  const Expected<McapRecovery> recovery = recover_mcap(file, target, {.replace = output.replace});
  if (!recovery) return recovery.error();
  if (!recovery->damage.empty()) observer.on_warning(file + ": " + recovery->damage);
  if (recovery->left_out_attachments > 0) {
    observer.on_warning(
        fmt::format("{}: {} attachments are left out", file, recovery->left_out_attachments));
  }
  CommandResult result;
  result.json = json_of(*recovery, file, target);
  const std::string has =
      fmt::format("{} messages on {} topics", recovery->messages, recovery->topics);
  if (recovery->is_whole) {
    result.summary = fmt::format("{} is whole: {}; nothing to recover\n", file, has);
    return result;
  }
  result.summary = fmt::format("{}: kept {}, {} of {} bytes; {}\nwritten: {}\n", file, has,
                               recovery->bytes - recovery->lost_bytes, recovery->bytes,
                               lost_text(*recovery), target.string());
  return result;
}

}  // namespace pcavr::app
