// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/live_sessions.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "serve/a_world.hpp"
#include "serve/server_message_reader.hpp"

namespace pcavr {
namespace {

using PageId = LiveSessions::PageId;

class LiveSessionsTest : public testing::Test {
 protected:
  /// A page that has sent hello, and requested the tool if `takes_tool`.
  PageId page(bool takes_tool = false) {
    const PageId id = sessions_.join();
    EXPECT_TRUE(send(id, LiveHello{kLiveProtocolVersion, "test"}));
    if (takes_tool) {
      EXPECT_TRUE(send(id, LiveCommand::take_tool));
    }
    return id;
  }
  template <typename Content>
  bool send(PageId id, Content content) {
    return send_as(id, ++last_sent_[id], std::move(content));
  }
  template <typename Content>
  bool send_as(PageId id, std::uint32_t sequence, Content content) {
    return sessions_.on_message(id, encode(PageMessage{{sequence, clock_}, std::move(content)}),
                                clock_);
  }
  LiveState state(PageId id) {
    std::vector<std::uint8_t> bytes;
    sessions_.write_state(id, clock_, 0.0, bytes);
    return std::get<LiveState>(decode_server_message(bytes)->content);
  }
  template <typename Content>
  const Content* last(PageId id) {
    if (received_[id].empty()) return nullptr;
    return std::get_if<Content>(&received_[id].back().content);
  }
  static LiveTool engaged() { return {.is_engaged = true}; }

  std::unique_ptr<LiveWorld> world_ = test::a_live_world();
  std::map<PageId, std::vector<ServerMessage>> received_;
  std::map<PageId, std::uint32_t> last_sent_;
  LiveSessions sessions_{*world_,
                         {.version = "1.2.3", .objects = world_->names()},
                         [this](PageId id, std::vector<std::uint8_t> bytes) {
                           received_[id].push_back(decode_server_message(bytes).value());
                         },
                         0.5,
                         10.0};
  double clock_ = 100.0;
};

TEST_F(LiveSessionsTest, AHelloGetsAWelcome) {
  const PageId id = sessions_.join();
  EXPECT_FALSE(sessions_.has_sent_hello(id));
  EXPECT_TRUE(send(id, LiveHello{}));
  EXPECT_TRUE(sessions_.has_sent_hello(id));
  ASSERT_NE(last<LiveWelcome>(id), nullptr);
  EXPECT_EQ(last<LiveWelcome>(id)->objects, world_->names());
}

TEST_F(LiveSessionsTest, APageOfAnotherProtocolGetsAnErrorAndIsClosed) {
  const PageId id = sessions_.join();
  EXPECT_FALSE(send(id, LiveHello{7, "9.9"}));
  ASSERT_NE(last<LiveNotice>(id), nullptr);
  EXPECT_NE(last<LiveNotice>(id)->text.find("protocol 7"), std::string::npos);
  EXPECT_NE(last<LiveNotice>(id)->text.find("1.2.3"), std::string::npos);
}

TEST_F(LiveSessionsTest, APageWithoutHelloIsClosed) {
  const PageId id = sessions_.join();
  EXPECT_FALSE(send(id, LiveCommand::take_tool));
  EXPECT_FALSE(sessions_.has_sent_hello(id));
}

TEST_F(LiveSessionsTest, AnInvalidMessageGetsAnErrorAndClosesThePage) {
  const PageId id = page();
  EXPECT_FALSE(sessions_.on_message(id, std::vector<std::uint8_t>{1, 2, 3}, clock_));
  ASSERT_NE(last<LiveNotice>(id), nullptr);
  EXPECT_EQ(last<LiveNotice>(id)->level, LiveLevel::error);
}

TEST_F(LiveSessionsTest, TheFirstPageToAskGetsTheTool) {
  const PageId first = page(true);
  const PageId second = page(true);
  EXPECT_TRUE(state(first).has_tool);
  EXPECT_FALSE(state(second).has_tool);
  EXPECT_TRUE(state(second).tool_taken);
  ASSERT_NE(last<LiveNotice>(second), nullptr);
  send(first, LiveCommand::release_tool);
  EXPECT_FALSE(state(second).tool_taken);
  send(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(second).has_tool);
}

TEST_F(LiveSessionsTest, APageThatLeavesReleasesTheTool) {
  const PageId first = page(true);
  const PageId second = page();
  sessions_.leave(first);
  EXPECT_FALSE(state(second).tool_taken);
}

TEST_F(LiveSessionsTest, AnEngagedPageThatIsSilentLosesTheTool) {
  const PageId id = page(true);
  send(id, engaged());
  clock_ += 0.49;
  sessions_.check_timeouts(clock_);
  EXPECT_TRUE(state(id).has_tool);
  clock_ += 0.02;
  sessions_.check_timeouts(clock_);
  EXPECT_FALSE(state(id).has_tool);
  EXPECT_NE(last<LiveNotice>(id), nullptr);
}

TEST_F(LiveSessionsTest, ADisengagedPageMayBeSilent) {
  const PageId id = page(true);
  send(id, LiveTool{});
  clock_ += 60.0;
  sessions_.check_timeouts(clock_);
  EXPECT_TRUE(state(id).has_tool);
}

TEST_F(LiveSessionsTest, AnIdleToolGoesToAPageThatRequestsIt) {
  const PageId first = page(true);
  const PageId second = page();
  send(first, engaged());
  clock_ += 0.1;
  send(first, LiveTool{});
  clock_ += 9.9;
  EXPECT_TRUE(state(second).tool_taken);
  send(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(first).has_tool);
  clock_ += 0.2;
  EXPECT_TRUE(state(first).has_tool);
  EXPECT_FALSE(state(second).tool_taken);
  send(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(second).has_tool);
  EXPECT_FALSE(state(first).has_tool);
  EXPECT_TRUE(state(first).tool_taken);
  ASSERT_NE(last<LiveNotice>(first), nullptr);
  EXPECT_EQ(last<LiveNotice>(first)->level, LiveLevel::info);
}

TEST_F(LiveSessionsTest, APageThatAsksIsHandedTheToolWhileItIsUsed) {
  const PageId first = page(true);
  const PageId second = page();
  const PageId third = page();
  send(first, engaged());
  send(first, LiveCommand::hand_over_tool);
  EXPECT_TRUE(state(first).has_tool) << "nobody asks";
  send(second, LiveCommand::take_tool);
  EXPECT_NE(last<LiveNotice>(second)->text.find("10 s with its clutch open"), std::string::npos);
  send(third, LiveCommand::take_tool);
  EXPECT_TRUE(state(first).is_tool_wanted);
  EXPECT_FALSE(state(second).is_tool_wanted);
  EXPECT_TRUE(state(second).has_asked);
  send(second, LiveCommand::hand_over_tool);
  EXPECT_TRUE(state(first).has_tool) << "only the page that has it";
  send(first, LiveCommand::hand_over_tool);
  EXPECT_TRUE(state(second).has_tool) << "in the order of asking";
  EXPECT_TRUE(state(second).is_tool_wanted);
  EXPECT_FALSE(state(second).has_asked);
  EXPECT_EQ(last<LiveNotice>(second)->text, "this page now has the tool");
  EXPECT_FALSE(state(first).has_tool);
  EXPECT_TRUE(state(third).has_asked);
}

TEST_F(LiveSessionsTest, ARefusedPageIsToldAndMayAskAgainLater) {
  const PageId first = page(true);
  const PageId second = page();
  send(first, engaged());
  send(second, LiveCommand::take_tool);
  send(first, LiveCommand::keep_tool);
  EXPECT_NE(last<LiveNotice>(second)->text.find("keeps it"), std::string::npos);
  EXPECT_FALSE(state(first).is_tool_wanted);
  EXPECT_FALSE(state(second).has_asked);
  send(second, LiveCommand::take_tool);
  EXPECT_NE(last<LiveNotice>(second)->text.find("refused"), std::string::npos);
  EXPECT_FALSE(state(first).is_tool_wanted);
  clock_ += 10.1;
  send(first, engaged());
  send(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(first).is_tool_wanted);
}

TEST_F(LiveSessionsTest, TheToolFallsToTheAskerAfterTenSecondsWithTheClutchOpen) {
  const PageId first = page(true);
  const PageId second = page();
  send(first, engaged());
  send(second, LiveCommand::take_tool);
  const auto wait_with_clutch = [&](bool is_engaged, double seconds) {
    for (double t = 0.0; t < seconds; t += 0.1) {
      clock_ += 0.1;
      send(first, LiveTool{.is_engaged = is_engaged});
      sessions_.check_timeouts(clock_);
    }
  };
  wait_with_clutch(true, 20.0);
  EXPECT_TRUE(state(first).has_tool) << "it is used";
  wait_with_clutch(false, 9.5);
  EXPECT_TRUE(state(first).has_tool);
  wait_with_clutch(false, 1.0);
  EXPECT_TRUE(state(second).has_tool);
  EXPECT_EQ(last<LiveNotice>(second)->text, "this page now has the tool");
  EXPECT_NE(last<LiveNotice>(first)->text.find("not used for 10 s"), std::string::npos);
}

TEST_F(LiveSessionsTest, AReleasedToolGoesToTheFirstAskerThatStillWantsIt) {
  const PageId first = page(true);
  const PageId second = page();
  const PageId third = page();
  const PageId fourth = page();
  for (const PageId asker : {second, third, fourth}) send(asker, LiveCommand::take_tool);
  send(second, LiveCommand::release_tool);  // withdrawn
  EXPECT_FALSE(state(second).has_asked);
  send(first, LiveCommand::release_tool);
  sessions_.check_timeouts(clock_);
  EXPECT_TRUE(state(third).has_tool);
  sessions_.leave(third);
  sessions_.check_timeouts(clock_);
  EXPECT_TRUE(state(fourth).has_tool);
  sessions_.leave(fourth);
  sessions_.check_timeouts(clock_);
  EXPECT_FALSE(state(first).tool_taken);
}

TEST_F(LiveSessionsTest, AToolInUseIsNotIdleHoweverLong) {
  const PageId first = page(true);
  const PageId second = page();
  for (int i = 0; i < 300; ++i) {
    send(first, engaged());
    clock_ += 0.1;
  }
  send(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(first).has_tool);
}

TEST_F(LiveSessionsTest, DropsDuplicatesAndOutdatedMessages) {
  const PageId id = page(true);
  const std::uint32_t newest = last_sent_[id] += 10;
  EXPECT_TRUE(send_as(id, newest, LiveCommand::release_tool));
  EXPECT_TRUE(send_as(id, newest, LiveCommand::take_tool));
  EXPECT_TRUE(send_as(id, newest - 1, LiveCommand::take_tool));
  EXPECT_FALSE(state(id).has_tool);
  EXPECT_TRUE(send_as(id, newest + 1, LiveCommand::take_tool));
  EXPECT_TRUE(state(id).has_tool);
}

TEST_F(LiveSessionsTest, IgnoresToolSamplesOfOtherPages) {
  const PageId first = page(true);
  const PageId second = page();
  for (int i = 0; i < 50; ++i) {
    clock_ += 0.014;
    send(second, engaged());
  }
  // It does not have the tool, and the device has none of its samples.
  EXPECT_TRUE(std::isnan(world_->newest().page.sender_clock));
  send(second, LiveCommand::reset);
  ASSERT_NE(last<LiveNotice>(second), nullptr);
  EXPECT_TRUE(state(first).has_tool);
}

TEST_F(LiveSessionsTest, APongHasThePingsClock) {
  const PageId id = page();
  send(id, LivePing{});
  ASSERT_NE(last<LivePong>(id), nullptr);
  EXPECT_EQ(last<LivePong>(id)->clock, 100.0);
}

TEST_F(LiveSessionsTest, SequenceNumbersCountUpInEachDirection) {
  const PageId id = page();
  send(id, LivePing{});
  std::vector<std::uint8_t> bytes;
  sessions_.write_state(id, clock_, 0.0, bytes);
  EXPECT_EQ(received_[id][0].header.sequence, 1U);
  EXPECT_EQ(received_[id][1].header.sequence, 2U);
  EXPECT_EQ(decode_server_message(bytes)->header.sequence, 3U);
}

TEST(LiveSessions, NoPageGetsTheToolOfAnotherDevice) {
  class StationaryDevice final : public Device {
   public:
    [[nodiscard]] std::string_view name() const noexcept override { return "stylus"; }
    [[nodiscard]] DeviceSample exchange(double, double, const DeviceFeedback&) noexcept override {
      return {};
    }
  };
  LiveWorld world(test::a_box_on_a_table(), std::make_unique<StationaryDevice>(),
                  test::options_with_tool_start());
  std::string text;
  LiveSessions sessions(
      world, {},
      [&](PageId, std::vector<std::uint8_t> bytes) {
        const auto message = decode_server_message(bytes).value();
        if (const auto* notice = std::get_if<LiveNotice>(&message.content)) text = notice->text;
      },
      0.5, 10.0);
  const PageId id = sessions.join();
  EXPECT_TRUE(sessions.on_message(id, encode(PageMessage{{1, 0.0}, LiveHello{}}), 0.0));
  EXPECT_TRUE(sessions.on_message(id, encode(PageMessage{{2, 0.0}, LiveCommand::take_tool}), 0.0));
  EXPECT_NE(text.find("stylus"), std::string::npos);
  std::vector<std::uint8_t> bytes;
  sessions.write_state(id, 0.0, 0.0, bytes);
  const auto state = std::get<LiveState>(decode_server_message(bytes)->content);
  EXPECT_TRUE(state.tool_taken);
  EXPECT_FALSE(state.has_tool);
}

}  // namespace
}  // namespace pcavr
