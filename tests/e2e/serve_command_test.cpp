// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/command.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// A scene without images, and an empty page.
class ServeCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const std::string recording = (folder_->path() / "recording").string();
    ASSERT_EQ(run_pcavr({"simulate", "push", "--no-images", "-o", recording}).exit_code, 0);
    ASSERT_EQ(run_pcavr({"build", recording, "-o", scene()}).exit_code, 0);
    fs::create_directory(page());
    ASSERT_TRUE(pcavr::write_file(page() + "/index.html", "<title>pcavr</title>"));
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string scene() { return (folder_->path() / "scene").string(); }
  static std::string page() { return (folder_->path() / "page").string(); }
  /// Expects one error line that contains `about`, and exit code 1.
  static void expect_refused(const std::vector<std::string>& arguments, const std::string& about) {
    std::vector<std::string> all{"serve"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandOutcome outcome = run_pcavr(all);
    EXPECT_EQ(outcome.exit_code, 1) << about;
    EXPECT_NE(outcome.standard_error.find(about), std::string::npos) << outcome.standard_error;
    EXPECT_EQ(outcome.standard_output, "");
  }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(ServeCommand, PrintsItsPortAsJsonAndShutsDownGracefullyOnASignal) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const std::string scene_folder = scene();
  const std::string page_folder = page();
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(pipe[1], STDOUT_FILENO);
    ::execl(PCAVR_COMMAND, "pcavr", "serve", scene_folder.c_str(), "--page", page_folder.c_str(),
            "--port", "0", "--json", nullptr);
    ::_exit(127);
  }
  ::close(pipe[1]);
  FILE* child_output = ::fdopen(pipe[0], "r");
  std::array<char, 4096> line{};
  ASSERT_NE(std::fgets(line.data(), line.size(), child_output), nullptr);
  const auto json = nlohmann::json::parse(line.data(), nullptr, false);
  ASSERT_TRUE(json.is_object()) << line.data();
  EXPECT_GT(json["port"].get<int>(), 0);
  EXPECT_EQ(json["mode"], "live");
  EXPECT_EQ(json["code"], "");
  ::kill(child, SIGINT);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::fclose(child_output);
}

TEST_F(ServeCommand, APortInUseIsOneErrorLine) {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in endpoint{};
  endpoint.sin_family = AF_INET;
  endpoint.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof endpoint;
  auto* const address = reinterpret_cast<sockaddr*>(&endpoint);
  ASSERT_EQ(::bind(listener, address, length), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ASSERT_EQ(::getsockname(listener, address, &length), 0);
  expect_refused({scene(), "--page", page(), "--port", std::to_string(ntohs(endpoint.sin_port))},
                 "in use");
  ::close(listener);
}

TEST_F(ServeCommand, ANonLocalAddressNeedsTls) {
  expect_refused({scene(), "--page", page(), "--port", "0", "--host", "0.0.0.0"}, "--tls");
}

TEST_F(ServeCommand, ASceneWithAMissingFileIsOneErrorLine) {
  const TemporaryFolder folder;
  const fs::path copy = folder.path() / "scene";
  fs::copy(scene(), copy, fs::copy_options::recursive);
  fs::remove_all(copy / "objects");
  expect_refused({copy.string(), "--page", page(), "--port", "0"}, "objects");
  fs::remove(copy / "scene.yaml");
  expect_refused({copy.string(), "--page", page(), "--port", "0"}, "scene.yaml");
}

TEST_F(ServeCommand, APageThatWasNotBuiltIsOneErrorLine) {
  expect_refused({scene(), "--page", scene(), "--port", "0"}, "index.html");
}

}  // namespace
