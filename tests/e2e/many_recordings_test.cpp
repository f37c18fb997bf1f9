// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr plan, run and status with the real command: the same bytes as single commands, and no
// part of a result after a kill.
#include <csignal>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/json_command.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class ManyRecordings : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    for (const char* seconds : {"6", "7"}) {
      run_json({"simulate", "push", "--no-images", "--seed", "12", "--duration", seconds, "-o",
                path("lab/" + std::string(seconds))});
    }
    run_json({"plan", path("lab"), "--chain", "build,identify", "-o", path("plan.json")});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }

 private:
  static TemporaryFolder* folder_;
};
TemporaryFolder* ManyRecordings::folder_ = nullptr;

/// Starts `pcavr run PLAN` and kills it after some time [us].
void kill_run(const std::string& plan, unsigned int time) {
  const pid_t process = ::fork();
  if (process == 0) {
    ::execl(PCAVR_COMMAND, PCAVR_COMMAND, "run", plan.c_str(), "--jobs", "2", nullptr);
    ::_exit(1);
  }
  ::usleep(time);
  ::kill(process, SIGKILL);
  ::waitpid(process, nullptr, 0);
}

TEST_F(ManyRecordings, GiveTheBytesOfSingleCommandsAlsoAfterKills) {
  for (const unsigned int time : {100'000U, 400'000U}) kill_run(path("plan.json"), time);
  run_json({"run", path("plan.json"), "--jobs", "2"});
  const auto status = run_json({"status", path("plan.json")});
  EXPECT_EQ(status["done"], 4);
  const auto again = run_json({"run", path("plan.json")});
  EXPECT_EQ(again["ran"], 0);
  EXPECT_EQ(again["were_done"], 4);

  const std::string results = path("plan/lab/7");
  const auto planned = contents(results + "/scene");
  run_json({"build", path("lab/7"), "-o", path("single")});
  EXPECT_EQ(contents(path("single")), planned);
  run_json({"identify", "friction", path("lab/7"), "--scene", results + "/scene", "-o",
            path("single.yaml")});
  EXPECT_EQ(read_file(path("single.yaml")).value(),
            read_file(results + "/parameters.yaml").value());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("plan")))
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
}

TEST_F(ManyRecordings, AreRefusedInOneLine) {
  const CommandOutcome twice =
      run_pcavr({"plan", path("lab/6"), path("lab/6"), "-o", path("twice.json")});
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_NE(twice.standard_error.find("is the same recording as"), std::string::npos)
      << twice.standard_error;
  const CommandOutcome missing = run_pcavr({"plan", path("none"), "-o", path("none.json")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(path("none.json")));
}

}  // namespace
}  // namespace pcavr
