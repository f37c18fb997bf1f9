// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "packed_mesh.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <optional>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/core/output.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr char kProgram[] = "gltfpack";
constexpr char kGlbStart[] = "glTF";
/// A million triangles take about a second.
constexpr auto kLongest = std::chrono::seconds(30);
constexpr auto kBetweenLooks = std::chrono::milliseconds(2);

Error not_packed(const std::string& why) { return {.message = why, .file = kProgram}; }

/// A folder that only this user sees, gone with its content at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code code;
    std::string name = (fs::temp_directory_path(code) / "pcavr-XXXXXX").string();
    if (!code && ::mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  /// Empty where it could not be made.
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The exit status, or nothing after kLongest: then the child is ended.
std::optional<int> wait_for(pid_t child) {
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  while (true) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return std::nullopt;
    if (std::chrono::steady_clock::now() - start > kLongest) break;
    std::this_thread::sleep_for(kBetweenLooks);
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  return std::nullopt;
}

/// Runs gltfpack, found on the PATH, with its words thrown away.
Expected<void> run(const fs::path& input, const fs::path& output) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  // Colours in 12 bits: they are linear, where 8 would show as bands in the dark.
  std::vector<std::string> words{kProgram, "-i",   input.string(), "-o",  output.string(),
                                 "-cc",    "-noq", "-kn",          "-vc", "12"};
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failure =
      ::posix_spawnp(&child, kProgram, &actions, nullptr, arguments.data(), ::environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    Error error = not_packed(std::string("can't be run: ") + std::strerror(failure));
    error.hint = "apt-get install gltfpack";
    return error;
  }
  const std::optional<int> status = wait_for(child);
  if (!status) return not_packed("did not end in time");
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0) return not_packed("failed on a mesh");
  return {};
}

}  // namespace

Expected<std::string> packed_mesh(const std::string& glb) {
  const ScratchFolder folder;
  if (folder.path().empty()) return not_packed("found no folder for its temporary files");
  const fs::path input = folder.path() / "mesh.glb";
  const fs::path output = folder.path() / "packed.glb";
  if (const auto written = write_file(input, glb); !written) return written.error();
  if (const auto done = run(input, output); !done) return done.error();
  Expected<std::string> packed = read_file(output);
  if (packed && !packed->starts_with(kGlbStart)) return not_packed("wrote no binary glTF");
  return packed;
}

}  // namespace pcavr
