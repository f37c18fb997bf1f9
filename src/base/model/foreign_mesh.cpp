// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <fstream>
#include <mutex>
#include <string>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/base/core/raw_bytes.hpp"

#include "base/model/assimp_scene.hpp"
#include "base/model/mesh_fault.hpp"
#include "base/model/mesh_readers.hpp"

/// A sanitizer's shadow memory exceeds any limit of the address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCAVR_MODEL_IS_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PCAVR_MODEL_IS_SANITIZED
#endif
#endif

// A child is forked and does not execute another program: the library is used by programs of which
// it knows no executable to start. In a process with threads, only the forking one goes on in the
// child, where a lock that another thread holds stays locked. The child uses nothing that other
// threads of this process lock: assimp is used in children only, and glibc makes its allocator and
// its streams usable after a fork. If a child waited for a lock nevertheless, its time would end
// it.

namespace pcavr::model {
namespace {

using Clock = std::chrono::steady_clock;

// A Collada file of 20 MB, larger than a robot's, takes assimp some 2 s and 300 MB.
constexpr rlim_t kMaxMemory = 1'000'000'000;  // [byte] beyond what the process has already
constexpr rlim_t kMaxComputing = 5;           // [s] of computing time
constexpr std::chrono::seconds kMaxWait(20);  // on a machine that has other work, too

constexpr char kMeshMark = 'm';   // before a mesh: counts, then its arrays
constexpr char kFaultMark = 'f';  // before the text of a fault

template <typename Element>
void append_array(std::string& bytes, const std::vector<Element>& elements) {
  bytes.append(reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(Element));
}

std::string encoded(const TriangleMesh& mesh) {
  std::string bytes(1, kMeshMark);
  for (const std::size_t count :
       {mesh.vertices.size(), mesh.normals.size(), mesh.colors.size(), mesh.triangles.size()}) {
    append_bytes(bytes, std::uint64_t{count});
  }
  append_array(bytes, mesh.vertices);
  append_array(bytes, mesh.normals);
  append_array(bytes, mesh.colors);
  append_array(bytes, mesh.triangles);
  return bytes;
}

/// Takes arrays from bytes that a crashing process may have written in part.
class Decoder {
 public:
  explicit Decoder(const std::string& bytes) : bytes_(bytes) {}

  template <typename Element>
  std::vector<Element> take(std::uint64_t count) {
    if (count > (bytes_.size() - at_) / sizeof(Element))
      throw MeshFault("its result is incomplete");
    std::vector<Element> elements(count);
    if (count > 0)
      std::memcpy(static_cast<void*>(elements.data()), bytes_.data() + at_,
                  count * sizeof(Element));
    at_ += count * sizeof(Element);
    return elements;
  }

 private:
  const std::string& bytes_;
  std::size_t at_ = 1;
};

TriangleMesh decoded(const std::string& bytes) {
  Decoder decoder(bytes);
  const auto counts = decoder.take<std::uint64_t>(4);
  TriangleMesh mesh;
  mesh.vertices = decoder.take<Eigen::Vector3f>(counts[0]);
  mesh.normals = decoder.take<Eigen::Vector3f>(counts[1]);
  mesh.colors = decoder.take<Rgb8>(counts[2]);
  mesh.triangles = decoder.take<std::array<std::uint32_t, 3>>(counts[3]);
  const auto is_bounded = [&](const auto& triangle) {
    return std::ranges::all_of(triangle, [&](std::uint32_t v) { return v < counts[0]; });
  };
  const bool are_complete =
      (counts[1] == 0 || counts[1] == counts[0]) && (counts[2] == 0 || counts[2] == counts[0]);
  if (!are_complete || !std::ranges::all_of(mesh.triangles, is_bounded)) {
    throw MeshFault("its result contradicts itself");
  }
  return mesh;
}

// ---- In the child.

void set_limit(__rlimit_resource resource, rlim_t value) {
  const rlimit limit{value, value};
  (void)::setrlimit(resource, &limit);
}

void limit_resources() {
#ifndef PCAVR_MODEL_IS_SANITIZED
  // The child has the memory of the process, to which the limit is added.
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  set_limit(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + kMaxMemory);
#endif
  set_limit(RLIMIT_CPU, kMaxComputing);
  set_limit(RLIMIT_CORE, 0);
}

/// Signals end the child as if it had no handlers, the process's end does, too, and what a library
/// prints is lost.
void become_silent_child() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int number :
       {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU}) {
    ::signal(number, SIG_DFL);
  }
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, stream);
}

std::string result_of(const std::filesystem::path& file) {
  std::string fault;
  try {
    return encoded(read_assimp_scene(file));
  } catch (const std::exception& failure) {
    fault = failure.what();
  }
  // assimp makes it a message of its own.
  if (fault.find("bad_alloc") != fault.npos) fault = "reading it takes more than 1 GB of memory";
  return kFaultMark + fault;
}

[[noreturn]] void run_child(const std::filesystem::path& file, int output) {
  become_silent_child();
  limit_resources();
  const std::string result = result_of(file);
  for (std::size_t sent = 0; sent < result.size();) {
    const ssize_t count = ::write(output, result.data() + sent, result.size() - sent);
    if (count < 0 && errno != EINTR) break;
    sent += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
  // _exit runs no destructors and handlers, which belong to the parent process.
  ::_exit(0);
}

// ---- In the process.

/// A child that reads a file, and the end of a pipe where its result comes out.
class ReadingChild {
 public:
  explicit ReadingChild(const std::filesystem::path& file) {
    // While both ends are open, no other child may be forked: it would keep the pipe open.
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw MeshFault("no pipe can be made to read it");
    id_ = ::fork();
    if (id_ == 0) run_child(file, ends[1]);
    ::close(ends[1]);
    output_ = ends[0];
    if (id_ < 0) {
      ::close(output_);
      throw MeshFault("no process can be started to read it");
    }
  }
  ~ReadingChild() {
    ::close(output_);
    if (id_ > 0) stop();
  }
  ReadingChild(const ReadingChild&) = delete;
  ReadingChild& operator=(const ReadingChild&) = delete;

  /// The text that the child writes until it ends. Throws MeshFault if its time ends before.
  std::string read() {
    std::string result;
    std::string chunk(1U << 16U, '\0');
    const Clock::time_point end = Clock::now() + kMaxWait;
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      pollfd ready{output_, POLLIN, 0};
      if (left.count() <= 0) throw MeshFault(slow_message());
      if (::poll(&ready, 1, static_cast<int>(left.count())) <= 0) continue;
      const ssize_t count = ::read(output_, chunk.data(), chunk.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return result;
      result.append(chunk, 0, static_cast<std::size_t>(count));
    }
  }

  /// Why the child ended without a result.
  std::string fault() {
    int status = 0;
    while (::waitpid(std::exchange(id_, -1), &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
      return slow_message();
    }
    return "the library that reads this type crashed on it";
  }

 private:
  static std::string slow_message() {
    return "reading it takes more than " + std::to_string(kMaxComputing) + " s";
  }
  void stop() const {
    ::kill(id_, SIGKILL);
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
  }

  pid_t id_ = -1;
  int output_ = -1;
};

}  // namespace

TriangleMesh read_foreign_mesh(const std::filesystem::path& file) {
  ReadingChild child(file);
  const std::string result = child.read();
  if (result.starts_with(kMeshMark)) return decoded(result);
  throw MeshFault(result.starts_with(kFaultMark) ? result.substr(1) : child.fault());
}

}  // namespace pcavr::model
