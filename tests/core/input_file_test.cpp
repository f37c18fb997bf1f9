// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/input_file.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

std::string error_of(const fs::path& path) {
  const Expected<std::string> content = read_file(path);
  EXPECT_EQ(regular_file_size(path).has_value(), content.has_value()) << path;
  return content ? "" : content.error().to_string();
}

void expect_refused(const fs::path& path, const std::string& reason) {
  const std::string line = error_of(path);
  EXPECT_NE(line.find(path.string()), line.npos) << line;
  EXPECT_NE(line.find(reason), line.npos) << line;
}

TEST(ReadFile, RefusesAPipeWithoutAWriterImmediately) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_refused(pipe, "is a named pipe, not a regular file");
}

TEST(ReadFile, RefusesAnEndlessDevice) { expect_refused("/dev/zero", "is a device"); }

TEST(ReadFile, RefusesASocketAndAFolder) {
  const TemporaryFolder folder;
  const fs::path address_path = folder.path() / "socket";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(address_path.string().size(), sizeof address.sun_path);
  address_path.string().copy(address.sun_path, sizeof address.sun_path - 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  expect_refused(address_path, "is a socket");
  ::close(socket);
  expect_refused(folder.path(), "is a folder");
}

TEST(ReadFile, ReportsALoopOfSymbolicLinks) {
  const TemporaryFolder folder;
  fs::create_symlink(folder.path() / "b", folder.path() / "a");
  fs::create_symlink(folder.path() / "a", folder.path() / "b");
  expect_refused(folder.path() / "a", "symbolic links");
  EXPECT_FALSE(is_present(folder.path() / "a").has_value());
}

TEST(ReadFile, RefusesASparseFileOfATerabyte) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "sparse";
  std::ofstream(file) << "x";
  std::error_code code;
  fs::resize_file(file, std::uintmax_t{1} << 40, code);
  if (code) GTEST_SKIP() << "this file system has no sparse files: " << code.message();
  const std::string line = read_file(file).error().to_string();
  EXPECT_NE(line.find("too large"), line.npos) << line;
}

TEST(ReadFile, ReadsAVirtualFileOfProc) {
  // The file system reports its size as 0.
  EXPECT_FALSE(read_file("/proc/self/status").value().empty());
}

TEST(ReadFile, ReadsAllBytesOfAFile) {
  const TemporaryFolder folder;
  std::string bytes;
  for (int i = 0; i < 100'000; ++i) bytes += static_cast<char>(i * 7);
  ASSERT_TRUE(write_file(folder.path() / "file", bytes));
  EXPECT_EQ(read_file(folder.path() / "file").value(), bytes);
  EXPECT_EQ(regular_file_size(folder.path() / "file").value(), bytes.size());
}

TEST(IsPresent, DistinguishesAnAbsentFileFromADanglingLink) {
  const TemporaryFolder folder;
  EXPECT_FALSE(is_present(folder.path() / "absent").value());
  EXPECT_TRUE(is_present(folder.path()).value());
  fs::create_symlink("nowhere", folder.path() / "link");
  const Expected<bool> link = is_present(folder.path() / "link");
  ASSERT_FALSE(link.has_value());
  EXPECT_NE(link.error().message.find("symbolic link"), std::string::npos);
}

TEST(IsPresent, ReportsAFolderThatMayNotBeRead) {
  const TemporaryFolder folder;
  fs::permissions(folder.path(), fs::perms::all);
  const fs::path inside = folder.path() / "closed";
  fs::create_directories(inside);
  fs::permissions(inside, fs::perms::none);
  // The superuser may read everything.
  constexpr uid_t kNobody = 65534;
  const uid_t user = ::geteuid();
  if (user == 0) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const Expected<bool> file = is_present(inside / "file");
  ASSERT_EQ(::seteuid(user), 0);
  fs::permissions(inside, fs::perms::owner_all);
  ASSERT_FALSE(file.has_value());
  EXPECT_NE(file.error().message.find("Permission denied"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
