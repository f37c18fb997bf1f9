// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/recover_mcap.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

/// 40 messages on two channels, of which one has metadata and counts its messages from 100 by twos.
std::string write_log(const fs::path& file, std::size_t max_chunk) {
  Expected<McapWriter> writer = McapWriter::create(
      file, {.profile = "ros2", .max_chunk = max_chunk, .flush_interval = 1e9, .replace = true});
  EXPECT_TRUE(writer);
  const std::uint16_t schema = writer->add_schema("Sample", "jsonschema", "{\"type\":\"object\"}");
  const std::uint16_t a = writer->add_channel("/a", "json", schema, {{"unit", "m"}});
  const std::uint16_t b = writer->add_channel("/b", "json", 0);
  EXPECT_TRUE(writer->write_metadata("notes", {{"by", "a test"}}));
  for (std::uint32_t i = 0; i < 40; ++i) {
    const std::string payload = "{\"i\":" + std::to_string(i) + "}";
    const auto sequence = i % 2 == 0 ? std::optional<std::uint32_t>(100 + i) : std::nullopt;
    EXPECT_TRUE(writer->write(i % 2 == 0 ? a : b, {1000 + std::int64_t{i}}, test::bytes_of(payload),
                              Stamp{900 + std::int64_t{i}}, sequence));
  }
  EXPECT_TRUE(writer->write_dropped({{"/b", 3}}));
  EXPECT_TRUE(writer->close());
  return read_file(file).value();
}

class RecoverMcap : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }
  test::ReadBag read(const std::string& name) const { return test::read_all(open_bag(path(name))); }
  std::string error_of(const std::string& bytes) const {
    const Expected<McapRecovery> recovery =
        recover_mcap(write("bad.mcap", bytes), path("bad-out.mcap"));
    EXPECT_FALSE(fs::exists(path("bad-out.mcap")));
    return recovery ? "" : recovery.error().to_string();
  }

  TemporaryFolder folder_;
};

constexpr std::size_t kDataEnd = 13;  // the record of this size precedes the summary

TEST_F(RecoverMcap, AFileWithoutItsEndIsWhatItsWriterWouldHaveMade) {
  const std::string whole = write_log(path("whole.mcap"), 1U << 20U);
  // "/b" stands for the first time in the first chunk; the statistics are after the data.
  const std::size_t end = whole.find(std::string("\x0F\x04\0\0\0\0\0\0\0", 9));
  ASSERT_NE(end, std::string::npos);
  for (const std::size_t size : {end, end + 5, end + kDataEnd + 40, whole.size() - 1}) {
    const Expected<McapRecovery> recovery =
        recover_mcap(write("cut.mcap", whole.substr(0, size)), path("out.mcap"), {.replace = true});
    ASSERT_TRUE(recovery) << recovery.error().to_string();
    EXPECT_EQ(read_file(path("out.mcap")).value(), whole) << size;
    EXPECT_FALSE(recovery->is_whole);
    EXPECT_EQ(recovery->messages, 40U);
    EXPECT_EQ(recovery->topics, 2U);
    EXPECT_EQ(recovery->lost_messages, 0U);
    EXPECT_LE(recovery->lost_bytes, 5U);
  }
}

TEST_F(RecoverMcap, CutAnywhereKeepsEachWholeMessageAndCountsTheOneThatIsCut) {
  const std::string whole = write_log(path("whole.mcap"), 300);
  const test::ReadBag all = read("whole.mcap");
  std::size_t kept = 0;
  std::size_t with_cut_message = 0;
  for (std::size_t size = whole.find("{\"i\":0}") + 7; size < whole.size(); size += 23) {
    write("cut.mcap", whole.substr(0, size));
    const test::ReadBag cut = read("cut.mcap");
    const Expected<McapRecovery> recovery =
        recover_mcap(path("cut.mcap"), path("out.mcap"), {.replace = true});
    ASSERT_TRUE(recovery) << size << ": " << recovery.error().to_string();
    const test::ReadBag recovered = read("out.mcap");
    ASSERT_EQ(recovered.error, "");
    ASSERT_EQ(recovered.messages, cut.messages) << size;
    ASSERT_EQ(recovered.topics.size(), recovery->topics);
    ASSERT_GE(recovered.messages.size(), kept);
    kept = recovered.messages.size();
    ASSERT_EQ(recovery->messages, kept);
    ASSERT_LT(recovery->lost_bytes, 600U) << size;
    with_cut_message += recovery->lost_messages == 1U ? 1 : 0;
    const Expected<McapRecovery> again = recover_mcap(path("out.mcap"), path("none.mcap"));
    ASSERT_TRUE(again && again->is_whole) << size;
    ASSERT_FALSE(fs::exists(path("none.mcap")));
  }
  EXPECT_EQ(kept, all.messages.size());
  EXPECT_GT(with_cut_message, 15U);
}

TEST_F(RecoverMcap, DamageEndsWhatIsKept) {
  std::string bytes = write_log(path("whole.mcap"), 300);
  bytes[bytes.find("{\"i\":20}") + 5] = '9';
  const Expected<McapRecovery> recovery =
      recover_mcap(write("damaged.mcap", bytes), path("out.mcap"));
  ASSERT_TRUE(recovery);
  EXPECT_NE(recovery->damage.find("chunk whose CRC differs"), std::string::npos);
  EXPECT_EQ(recovery->lost_messages, std::nullopt);
  EXPECT_GT(recovery->lost_bytes, 1000U);
  const test::ReadBag recovered = read("out.mcap");
  EXPECT_EQ(recovered.error, "");
  EXPECT_EQ(recovered.messages.size(), recovery->messages);
  EXPECT_GE(recovered.messages.size(), 12U);
  EXPECT_LT(recovered.messages.size(), 21U);
}

TEST_F(RecoverMcap, ReplacesItsInputOnlyWhenThatIsTheOutput) {
  const std::string whole = write_log(path("whole.mcap"), 1U << 20U);
  const std::string cut = whole.substr(0, whole.size() - 100);
  write("a.mcap", cut);
  write("b.mcap", cut);
  EXPECT_FALSE(recover_mcap(path("a.mcap"), path("b.mcap")));
  ASSERT_TRUE(recover_mcap(path("a.mcap"), path("b.mcap"), {.replace = true}));
  EXPECT_EQ(read_file(path("a.mcap")).value(), cut);
  EXPECT_EQ(read_file(path("b.mcap")).value(), whole);
  fs::create_symlink("a.mcap", path("link.mcap"));
  ASSERT_TRUE(recover_mcap(path("a.mcap"), path("link.mcap")));
  EXPECT_EQ(read_file(path("a.mcap")).value(), whole);
  EXPECT_TRUE(fs::is_symlink(path("link.mcap")));
  write("notes.mcap", "my notes");
  EXPECT_FALSE(recover_mcap(path("b.mcap"), path("notes.mcap"), {.replace = true}));
  EXPECT_EQ(read_file(path("notes.mcap")).value(), "my notes");
}

TEST_F(RecoverMcap, BadInputsAreOneLineAndLeaveNoFile) {
  const std::string whole = write_log(path("whole.mcap"), 300);
  EXPECT_NE(error_of("").find("is not an MCAP file"), std::string::npos);
  EXPECT_NE(error_of("#ROSBAG V2.0\n").find("is not an MCAP file"), std::string::npos);
  EXPECT_NE(error_of(whole.substr(0, 8)).find("has no whole message"), std::string::npos);
  EXPECT_NE(error_of(whole.substr(0, 20)).find("has no whole message"), std::string::npos);
  const std::string zeros = whole.substr(0, 8) + std::string(100, '\0');
  EXPECT_NE(error_of(zeros).find("opcode 0"), std::string::npos);
  EXPECT_FALSE(recover_mcap(path("absent.mcap"), path("out.mcap")));
  EXPECT_FALSE(recover_mcap(folder_.path(), path("out.mcap")));
  EXPECT_FALSE(recover_mcap(path("whole.mcap"), path("absent/out.mcap")));
}

}  // namespace
}  // namespace pcavr
