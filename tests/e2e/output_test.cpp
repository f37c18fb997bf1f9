// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Outputs of the command: no user file is lost, whatever -o names.
#include <algorithm>
#include <fstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "pipeline/small_replay.hpp"
#include "support/command.hpp"
#include "support/file_tree.hpp"
#include "support/forked.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr char kCamera[] =
    "camera: {width: 160, height: 120, fx: 130, fy: 130, cx: 79.5, cy: 59.5}\n";

class Outputs : public testing::Test {
 protected:
  void SetUp() override {
    write_small_replay(folder_.path() / "home");
    write_small_recording(path_of("home/bare"), false);
    // The same frames as a TUM RGB-D folder.
    fs::copy(path_of("home/recording"), path_of("home/tum"), fs::copy_options::recursive);
    fs::remove(path_of("home/tum/recording.yaml"));
    write_tree(path_of("home"), {{"thesis.tex", "years"},
                                 {"camera.yaml", kCamera},
                                 {"p.yaml", "box: {mass: 2}\n"},
                                 {"run/run.yaml", "format: pcavr-run/1\nrecording: nowhere\n"},
                                 {"truth/parameters.yaml", "box: {mass: 2}\n"}});
    fs::create_symlink("home", path_of("link"));
  }

  [[nodiscard]] std::string path_of(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  /// Each argument that begins with '@' is a path in the folder.
  [[nodiscard]] CommandOutcome run(std::vector<std::string> arguments,
                                   const std::string& prefix = {}) const {
    for (std::string& argument : arguments) {
      if (argument.substr(0, 1) == "@") argument = path_of(argument.substr(1));
    }
    return run_pcavr(arguments, prefix);
  }

  /// One error line that contains `text`, exit code 1, and no file changed.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& text) const {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const FileTree before = tree(folder_.path());
    const CommandOutcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(text), std::string::npos) << outcome.standard_error;
    EXPECT_TRUE(tree(folder_.path()) == before) << "files were changed";
  }

  TemporaryFolder folder_;
};

TEST_F(Outputs, AreNeverAnInput) {
  expect_refused({"build", "@home/bare", "-o", "@home/bare", "--force"}, "is the input");
  expect_refused({"build", "@home/bare", "-o", "@link/bare", "--force"}, "is the input");
  expect_refused({"build", "@home/bare", "--sensor", "@home/camera.yaml", "-o", "@home/camera.yaml",
                  "--force"},
                 "is the input");
  expect_refused({"replay", "@home/recording", "--scene", "@home/scene", "--tracked",
                  "@home/tracked", "-o", "@home/scene", "--force"},
                 "is the input");
  expect_refused({"replay", "@home/recording", "--scene", "@home/scene", "--tracked", "@home/run",
                  "-o", "@home/run", "--force"},
                 "is the input");
  expect_refused({"evaluate", "@home/run", "-o", "@home/run", "--force"}, "is the input");
  expect_refused({"evaluate", "@home/robot.mcap", "-o", "@home/log-report"}, "make a run of it");
  expect_refused(
      {"evaluate", "@home/run", "--reference", "@home/scene", "-o", "@home/scene", "--force"},
      "is the input");
  expect_refused(
      {"evaluate", "@home/p.yaml", "--truth", "@home/truth", "-o", "@home/truth", "--force"},
      "is the input");
  expect_refused({"import", "@home/tum", "--camera", "@home/camera.yaml", "--depth-scale", "1000",
                  "-o", "@home/tum", "--force"},
                 "is the input");
  expect_refused({"identify", "friction", "@home/recording", "--scene", "@home/scene",
                  "--parameters", "@home/p.yaml", "-o", "@home/p.yaml", "--force"},
                 "is the input");
  expect_refused({"identify", "friction", "@home/recording", "--scene", "@home/scene", "-o",
                  "@new.yaml", "--report", "@home/recording", "--force"},
                 "is the input");
}

TEST_F(Outputs, NeverContainAnInput) {
  expect_refused({"build", "@home/bare", "-o", "@home", "--force"}, "contains the input");
  expect_refused({"build", "@home/bare", "-o", "@link/", "--force"}, "contains the input");
  expect_refused({"replay", "@home/recording", "--scene", "@home/scene", "--tracked",
                  "@home/tracked", "-o", "@home", "--force"},
                 "contains the input");
  expect_refused({"evaluate", "@home/p.yaml", "--truth", "@home/truth", "-o", "@home", "--force"},
                 "contains the input");
  expect_refused({"import", "@home/tum", "--camera", "@home/camera.yaml", "-o", "@", "--force"},
                 "contains the input");
  expect_refused(
      {"identify", "contact", "@home/recording", "-o", "@new.yaml", "--report", "@home", "--force"},
      "contains the input");
}

TEST_F(Outputs, NeverLieInAnInput) {
  expect_refused({"build", "@home/bare", "-o", "@home/bare/scene"}, "lies in the input");
  expect_refused({"replay", "@home/recording", "--scene", "@home/scene", "--tracked",
                  "@home/tracked", "-o", "@run", "--video", "@home/scene/out.mp4"},
                 "lies in the input");
  expect_refused({"evaluate", "@home/run", "-o", "@link/run/report"}, "lies in the input");
  expect_refused({"identify", "contact", "@home/recording", "-o", "@home/recording/new.yaml"},
                 "lies in the input");
}

TEST_F(Outputs, DoNotOverlap) {
  expect_refused(
      {"identify", "contact", "@home/recording", "-o", "@out/new.yaml", "--report", "@out"},
      "contains the other output");
  expect_refused({"identify", "contact", "@home/recording", "-o", "@out", "--report", "@out"},
                 "is the other output");
  expect_refused({"replay", "@home/recording", "--scene", "@home/scene", "--tracked",
                  "@home/tracked", "-o", "@run", "--video", "@run/out.mp4"},
                 "lies in the other output");
}

TEST_F(Outputs, ReplaceOnlyTheirOwnKind) {
  write_tree(path_of("unrelated"), {{"photo.jpg", "once"}});
  write_tree(path_of("mixed"), {{"scene.yaml", "format: pcavr-scene/1\n"}, {"photo.jpg", "once"}});
  expect_refused({"build", "@home/bare", "-o", "@unrelated", "--force"}, "--force does not");
  expect_refused({"build", "@home/bare", "-o", "@mixed", "--force"}, "photo.jpg");
  expect_refused({"build", "@home/bare", "-o", "@home/recording", "--force"},
                 "contains a recording");
  expect_refused({"simulate", "push", "--no-images", "-o", "@unrelated", "--force"}, "--force");
  expect_refused(
      {"import", "@home/tum", "--camera", "@home/camera.yaml", "-o", "@unrelated", "--force"},
      "--force");
  expect_refused({"evaluate", "@home/run", "-o", "@home/scene", "--force"}, "contains a scene");
  expect_refused({"identify", "contact", "@home/recording", "-o", "@new.yaml", "--plan",
                  "@home/thesis.tex", "--force"},
                 "not a motion plan");
  expect_refused({"identify", "contact", "@home/recording", "-o", "@home/thesis.tex", "--force"},
                 "not a parameter file");
  write_tree(path_of("home"), {{"thesis.pdf", "%PDF-1.4 years"}});
  expect_refused({"tags", "--ids", "0", "-o", "@home/thesis.pdf", "--force"}, "not a sheet");
  expect_refused({"identify", "contact", "@home/recording", "-o", "@home/scene", "--force"},
                 "is a folder");
}

TEST_F(Outputs, AreReplacedWhereTheyAreOfTheSameKind) {
  const std::vector<std::vector<std::string>> commands{
      {"build", "@home/bare", "-o", "@out/scene"},
      {"simulate", "push", "--no-images", "-o", "@out/recording"},
      {"import", "@home/tum", "--camera", "@home/camera.yaml", "--depth-scale", "1000", "-o",
       "@out/import"},
      {"replay", "@home/recording", "--scene", "@home/scene", "--tracked", "@home/tracked", "-o",
       "@out/run", "--video", "@out/out.mp4"},
      {"evaluate", "@home/p.yaml", "--truth", "@home/truth", "-o", "@out/report"},
      {"evaluate", "@home/scene", "--reference", "@home/scene", "-o", "@out/errors"},
      {"tags", "--ids", "0-5", "-o", "@out/sheet.svg"}};
  for (std::vector<std::string> arguments : commands) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const CommandOutcome first = run(arguments);
    ASSERT_EQ(first.exit_code, 0) << first.standard_error;
    expect_refused(arguments, "already exists");
    const FileTree before = tree(folder_.path());
    arguments.emplace_back("--force");
    const CommandOutcome second = run(arguments);
    EXPECT_EQ(second.exit_code, 0) << second.standard_error;
    EXPECT_TRUE(tree(folder_.path()) == before) << "same input, different bytes";
  }
}

TEST_F(Outputs, NeedAValidFileName) {
  fs::create_symlink("loop", path_of("loop"));
  const std::string long_name = "@" + std::string(300, 'n');
  for (const std::string name : {"", "@loop", "@loop/x", "@home/thesis.tex/x"}) {
    const std::string text = name.find("loop") != name.npos ? "symbolic links"
                             : name.empty()                 ? "empty"
                                                            : "ot a directory";
    expect_refused({"build", "@home/bare", "-o", name}, text);
    expect_refused({"identify", "contact", "@home/recording", "-o", name}, text);
  }
  expect_refused({"build", "@home/bare", "-o", long_name}, "too long");
  expect_refused({"identify", "contact", "@home/recording", "-o", long_name}, "too long");
  expect_refused({"tags", "--ids", "0", "-o", long_name}, "too long");
  expect_refused({"tags", "--ids", "0", "-o", ""}, "empty");
  EXPECT_EQ(run({"build", "@home/bare", "-o", "@" + std::string(255, 'n')}).exit_code, 0);
}

TEST_F(Outputs, AreWrittenWithinAMountPoint) {
  // The mount ends with its script: its content is copied before.
  write_tree(folder_.path(), {{"mounted.sh",
                               "mount -t tmpfs none \"$OUT\" || exit 77\n"
                               "mkdir \"$OUT/lost+found\"\n"
                               "\"$@\" && \"$@\" --force\n"
                               "code=$?\ncp -a \"$OUT/.\" \"$OUT-copy\"\nexit $code\n"}});
  fs::create_directory(path_of("volume"));
  const CommandOutcome outcome =
      run({"build", "@home/bare", "-o", "@volume"},
          "OUT='" + path_of("volume") + "' unshare -m sh '" + path_of("mounted.sh") + "' ");
  if (!fs::exists(path_of("volume-copy"))) GTEST_SKIP() << "not permitted to mount";
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_EQ(run({"build", "@home/bare", "-o", "@scene"}).exit_code, 0);
  EXPECT_TRUE(tree(path_of("volume-copy")) == tree(path_of("scene")));
}

TEST_F(Outputs, OfTagsAppearAllOrNone) {
  // The first page is below the limit, the sheet of all pages is not.
  const std::vector<std::string> arguments{"tags", "--ids", "0-40", "-o", "@sheets/a.svg"};
  fs::create_directory(path_of("sheets"));
  const CommandOutcome full = run(arguments, "ulimit -f 60; ");
  EXPECT_EQ(full.exit_code, 1) << full.standard_error;
  EXPECT_TRUE(fs::is_empty(path_of("sheets"))) << testing::PrintToString(tree(path_of("sheets")));
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_GT(tree(path_of("sheets")).size(), 2U);
  // A user's own drawing of that name is kept, and then no other page is replaced.
  write_tree(path_of("sheets"), {{"a-2.svg", "<?xml version=\"1.0\"?><svg>mine</svg>"}});
  const FileTree before = tree(path_of("sheets"));
  std::vector<std::string> forced = arguments;
  forced.insert(forced.end(), {"--size", "0.07", "--force"});
  EXPECT_EQ(run(forced).exit_code, 1);
  EXPECT_TRUE(tree(path_of("sheets")) == before);
}

TEST_F(Outputs, AreRemovedOnASignalOrByTheNextRun) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    ForkedProcess command([&] {
      const int nothing = ::open("/dev/null", O_WRONLY);
      ::dup2(nothing, STDERR_FILENO);
      ForkedProcess::report_ready();
      // A recording with a long simulation time.
      ::execl(PCAVR_COMMAND, "pcavr", "simulate", "paper", "-o", path_of("sim").c_str(), nullptr);
    });
    const auto has_started = [&] {
      return std::any_of(
          fs::directory_iterator(folder_.path()), fs::directory_iterator(), [](const auto& entry) {
            return entry.path().filename().string().find("partial") != std::string::npos;
          });
    };
    while (!has_started()) ::usleep(1000);
    ::usleep(300'000);  // while it writes frames
    const int status = command.kill(signal);
    if (signal == SIGKILL) {
      EXPECT_TRUE(has_started());
      EXPECT_EQ(run({"simulate", "push", "--no-images", "-o", "@sim"}).exit_code, 0);
      EXPECT_FALSE(has_started()) << "the next run of that name removes it";
      return;
    }
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 128 + signal);
    EXPECT_FALSE(has_started());
    EXPECT_FALSE(fs::exists(path_of("sim")));
  }
}

}  // namespace
}  // namespace pcavr
