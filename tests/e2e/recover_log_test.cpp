// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pcavr inspect --recover on a log that is cut where a killed writer may leave it.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "bag_import/bag_twin.hpp"
#include "support/json_command.hpp"
#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

class RecoverCommand : public testing::Test {
 protected:
  RecoverCommand() {
    test::BagTwin::write_mcap(path("twin.mcap"), test::BagTwin::messages(RosEncoder::Format::cdr));
    whole_ = read_file(path("twin.mcap")).value();
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  TemporaryFolder folder_;
  std::string whole_;
};

TEST_F(RecoverCommand, WritesAWholeFileOfACutOne) {
  for (const double part : {0.5, 0.8, 0.97}) {
    const auto size = static_cast<std::size_t>(part * static_cast<double>(whole_.size()));
    const std::string cut = write("push.mcap", whole_.substr(0, size));
    const std::string out = path("push-recovered.mcap");
    fs::remove(out);
    const nlohmann::json found = run_json({"inspect", cut, "--recover"});
    EXPECT_EQ(found["output"], out);
    EXPECT_EQ(found["bytes"], size);
    EXPECT_LT(found["lost_bytes"], size);
    const test::ReadBag before = test::read_all(open_bag(cut));
    const test::ReadBag after = test::read_all(open_bag(out));
    EXPECT_EQ(after.error, "");
    EXPECT_TRUE(after.warnings.empty());
    EXPECT_EQ(after.messages, before.messages);
    EXPECT_EQ(after.topics, before.topics);
    EXPECT_EQ(found["messages"], after.messages.size());
    EXPECT_EQ(read_file(cut).value(), whole_.substr(0, size));
  }
  const CommandOutcome in_place =
      run_pcavr({"inspect", path("push.mcap"), "--recover", "-o", path("push.mcap")});
  EXPECT_EQ(in_place.exit_code, 0) << in_place.standard_error;
  EXPECT_NE(in_place.standard_output.find(": kept "), std::string::npos);
  EXPECT_EQ(read_file(path("push.mcap")).value(), read_file(path("push-recovered.mcap")).value());
}

TEST_F(RecoverCommand, SaysThatAWholeFileIsWhole) {
  const CommandOutcome outcome = run_pcavr({"inspect", path("twin.mcap"), "--recover"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.standard_output.find("twin.mcap is whole: "), std::string::npos)
      << outcome.standard_output;
  EXPECT_FALSE(fs::exists(path("twin-recovered.mcap")));
}

TEST_F(RecoverCommand, BadInputIsOneLineAndLeavesNoFile) {
  const std::string cut = write("cut.mcap", whole_.substr(0, whole_.size() / 2));
  write("there.mcap", whole_);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{write("empty.mcap", "")}, "is not an MCAP file"},
      {{write("notes.mcap", "my notes")}, "is not an MCAP file"},
      {{write("start.mcap", whole_.substr(0, 30))}, "has no whole message"},
      {{path("absent.mcap")}, "absent.mcap"},
      {{folder_.path().string()}, "is a folder"},
      {{cut, "-o", path("out.txt")}, "let it end in .mcap"},
      {{cut, "-o", path("there.mcap")}, "already exists"},
      {{cut, "-o", path("notes.mcap"), "--force"}, "is not a MCAP file"}};
  const std::size_t files = contents(folder_.path()).size();
  for (const auto& [arguments, text] : cases) {
    std::vector<std::string> all{"inspect", "--recover"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandOutcome outcome = run_pcavr(all);
    EXPECT_EQ(outcome.exit_code, 1) << text;
    EXPECT_EQ(outcome.error_lines(), 1U) << outcome.standard_error;
    EXPECT_NE(outcome.standard_error.find(text), std::string::npos) << outcome.standard_error;
    EXPECT_EQ(contents(folder_.path()).size(), files) << text;
  }
  EXPECT_EQ(read_file(path("there.mcap")).value(), whole_);
}

}  // namespace
}  // namespace pcavr
