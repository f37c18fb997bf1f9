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
#include <fmt/format.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr char kProgram[] = "gltfpack";
constexpr char kGlbStart[] = "glTF";
constexpr auto kPollInterval = std::chrono::milliseconds(2);  // far below a mesh's second

Error gltfpack_error(const std::string& message) { return {.message = message, .file = kProgram}; }

/// A temporary folder that only this user can read; the destructor removes it.
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

  /// Empty if it could not be created.
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The exit status, or empty after `timeout` [s]: then the child is killed.
std::optional<int> wait_for(pid_t child, double timeout) {
  const auto start = std::chrono::steady_clock::now();
  int status = 0;
  while (true) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) return std::nullopt;
    if (std::chrono::steady_clock::now() - start > std::chrono::duration<double>(timeout)) break;
    std::this_thread::sleep_for(kPollInterval);
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  return std::nullopt;
}

/// Runs gltfpack, found on the PATH, with its output discarded.
Expected<void> run(const fs::path& input, const fs::path& output, double timeout) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  // Colours in 12 bits: they are linear, so that 8 bits would show banding in dark areas.
  std::vector<std::string> texts{kProgram, "-i",   input.string(), "-o",  output.string(),
                                 "-cc",    "-noq", "-kn",          "-vc", "12"};
  std::vector<char*> arguments;
  arguments.reserve(texts.size() + 1);
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failure =
      ::posix_spawnp(&child, kProgram, &actions, nullptr, arguments.data(), ::environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    Error error = gltfpack_error(std::string("can't be run: ") + std::strerror(failure));
    error.hint = "apt-get install gltfpack";
    return error;
  }
  const std::optional<int> status = wait_for(child, timeout);
  if (!status) return gltfpack_error(fmt::format("timed out after {} s", timeout));
  if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0) return gltfpack_error("failed on a mesh");
  return {};
}

}  // namespace

Expected<std::string> packed_mesh(const std::string& glb, double timeout) {
  const ScratchFolder folder;
  if (folder.path().empty()) return gltfpack_error("can't create a temporary folder");
  const fs::path input = folder.path() / "mesh.glb";
  const fs::path output = folder.path() / "packed.glb";
  if (const auto written = write_file(input, glb); !written) return written.error();
  if (const auto done = run(input, output, timeout); !done) return done.error();
  Expected<std::string> packed = read_file(output);
  if (packed && !packed->starts_with(kGlbStart))
    return gltfpack_error("its output is not binary glTF");
  return packed;
}

}  // namespace pcavr
