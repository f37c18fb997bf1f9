// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/live_room.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "serve/a_world.hpp"

namespace pcavr {
namespace {

using PageId = LiveRoom::PageId;

class LiveRoomTest : public testing::Test {
 protected:
  /// A page that has said hello, and asked for the tool where `takes_tool`.
  PageId page(bool takes_tool = false) {
    const PageId id = room_.join();
    EXPECT_TRUE(say(id, LiveHello{kLiveProtocol, "test"}));
    if (takes_tool) {
      EXPECT_TRUE(say(id, LiveCommand::take_tool));
    }
    return id;
  }
  template <typename Content>
  bool say(PageId id, Content content) {
    return say_as(id, ++said_[id], std::move(content));
  }
  template <typename Content>
  bool say_as(PageId id, std::uint32_t sequence, Content content) {
    return room_.hear(id, encode(PageMessage{{sequence, clock_}, std::move(content)}), clock_);
  }
  LiveState state(PageId id) {
    std::vector<std::uint8_t> bytes;
    room_.write_state(id, clock_, 0.0, bytes);
    return std::get<LiveState>(decode_server_message(bytes)->content);
  }
  template <typename Content>
  const Content* last(PageId id) {
    if (heard_[id].empty()) return nullptr;
    return std::get_if<Content>(&heard_[id].back().content);
  }
  static LiveTool engaged() { return {.is_engaged = true}; }

  std::unique_ptr<LiveWorld> world_ = test::a_live_world();
  std::map<PageId, std::vector<ServerMessage>> heard_;
  std::map<PageId, std::uint32_t> said_;
  LiveRoom room_{*world_,
                 {.version = "1.2.3", .objects = world_->names()},
                 [this](PageId id, std::vector<std::uint8_t> bytes) {
                   heard_[id].push_back(decode_server_message(bytes).value());
                 }};
  double clock_ = 100.0;
};

TEST_F(LiveRoomTest, AHelloIsWelcomed) {
  const PageId id = room_.join();
  EXPECT_FALSE(room_.is_greeted(id));
  EXPECT_TRUE(say(id, LiveHello{}));
  EXPECT_TRUE(room_.is_greeted(id));
  ASSERT_NE(last<LiveWelcome>(id), nullptr);
  EXPECT_EQ(last<LiveWelcome>(id)->objects, world_->names());
}

TEST_F(LiveRoomTest, APageOfAnotherProtocolIsToldSoAndSentAway) {
  const PageId id = room_.join();
  EXPECT_FALSE(say(id, LiveHello{7, "9.9"}));
  ASSERT_NE(last<LiveNotice>(id), nullptr);
  EXPECT_NE(last<LiveNotice>(id)->text.find("protocol 7"), std::string::npos);
  EXPECT_NE(last<LiveNotice>(id)->text.find("1.2.3"), std::string::npos);
}

TEST_F(LiveRoomTest, WhoDoesNotSayHelloFirstIsSentAway) {
  const PageId id = room_.join();
  EXPECT_FALSE(say(id, LiveCommand::take_tool));
  EXPECT_FALSE(room_.is_greeted(id));
}

TEST_F(LiveRoomTest, WhatIsNotUnderstoodGetsAWordAndTheEnd) {
  const PageId id = page();
  EXPECT_FALSE(room_.hear(id, std::vector<std::uint8_t>{1, 2, 3}, clock_));
  ASSERT_NE(last<LiveNotice>(id), nullptr);
  EXPECT_EQ(last<LiveNotice>(id)->level, LiveLevel::error);
}

TEST_F(LiveRoomTest, TheToolBelongsToTheFirstWhoAsks) {
  const PageId first = page(true);
  const PageId second = page(true);
  EXPECT_TRUE(state(first).has_tool);
  EXPECT_FALSE(state(second).has_tool);
  EXPECT_TRUE(state(second).tool_taken);
  ASSERT_NE(last<LiveNotice>(second), nullptr);
  say(first, LiveCommand::give_tool_back);
  EXPECT_FALSE(state(second).tool_taken);
  say(second, LiveCommand::take_tool);
  EXPECT_TRUE(state(second).has_tool);
}

TEST_F(LiveRoomTest, APageThatLeavesLetsGo) {
  const PageId first = page(true);
  const PageId second = page();
  room_.leave(first);
  EXPECT_FALSE(state(second).tool_taken);
}

TEST_F(LiveRoomTest, APageThatHoldsTheClutchAndFallsSilentLosesTheTool) {
  const PageId id = page(true);
  say(id, engaged());
  clock_ += 0.49;
  room_.look_around(clock_);
  EXPECT_TRUE(state(id).has_tool);
  clock_ += 0.02;
  room_.look_around(clock_);
  EXPECT_FALSE(state(id).has_tool);
  EXPECT_NE(last<LiveNotice>(id), nullptr);
}

TEST_F(LiveRoomTest, APageWhoseClutchIsOpenMayBeSilent) {
  const PageId id = page(true);
  say(id, LiveTool{});
  clock_ += 60.0;
  room_.look_around(clock_);
  EXPECT_TRUE(state(id).has_tool);
}

TEST_F(LiveRoomTest, WhatIsSentTwiceOrOvertakenIsDropped) {
  const PageId id = page(true);
  const std::uint32_t newest = said_[id] += 10;
  EXPECT_TRUE(say_as(id, newest, LiveCommand::give_tool_back));
  EXPECT_TRUE(say_as(id, newest, LiveCommand::take_tool));
  EXPECT_TRUE(say_as(id, newest - 1, LiveCommand::take_tool));
  EXPECT_FALSE(state(id).has_tool);
  EXPECT_TRUE(say_as(id, newest + 1, LiveCommand::take_tool));
  EXPECT_TRUE(state(id).has_tool);
}

TEST_F(LiveRoomTest, WhatAnotherPageSendsMovesNothing) {
  const PageId first = page(true);
  const PageId second = page();
  for (int i = 0; i < 50; ++i) {
    clock_ += 0.014;
    say(second, engaged());
  }
  // It neither has the tool, nor does the device know of it.
  EXPECT_TRUE(std::isnan(world_->newest().page.sender_clock));
  say(second, LiveCommand::reset);
  ASSERT_NE(last<LiveNotice>(second), nullptr);
  EXPECT_TRUE(state(first).has_tool);
}

TEST_F(LiveRoomTest, APingComesBackWithItsClock) {
  const PageId id = page();
  say(id, LivePing{});
  ASSERT_NE(last<LivePong>(id), nullptr);
  EXPECT_EQ(last<LivePong>(id)->clock, 100.0);
}

TEST_F(LiveRoomTest, SequencesCountUpInEachDirection) {
  const PageId id = page();
  say(id, LivePing{});
  std::vector<std::uint8_t> bytes;
  room_.write_state(id, clock_, 0.0, bytes);
  EXPECT_EQ(heard_[id][0].head.sequence, 1U);
  EXPECT_EQ(heard_[id][1].head.sequence, 2U);
  EXPECT_EQ(decode_server_message(bytes)->head.sequence, 3U);
}

TEST(LiveRoom, WhereADeviceMovesTheToolNoPageGetsIt) {
  class Still final : public Device {
   public:
    [[nodiscard]] std::string_view name() const noexcept override { return "stylus"; }
    [[nodiscard]] DeviceSample exchange(double, double, const DeviceFeedback&) noexcept override {
      return {};
    }
  };
  LiveWorld world(test::a_box_on_a_table(), std::make_unique<Still>(), test::beside_the_box());
  std::string text;
  LiveRoom room(world, {}, [&](PageId, std::vector<std::uint8_t> bytes) {
    const auto message = decode_server_message(bytes).value();
    if (const auto* notice = std::get_if<LiveNotice>(&message.content)) text = notice->text;
  });
  const PageId id = room.join();
  EXPECT_TRUE(room.hear(id, encode(PageMessage{{1, 0.0}, LiveHello{}}), 0.0));
  EXPECT_TRUE(room.hear(id, encode(PageMessage{{2, 0.0}, LiveCommand::take_tool}), 0.0));
  EXPECT_NE(text.find("stylus"), std::string::npos);
  std::vector<std::uint8_t> bytes;
  room.write_state(id, 0.0, 0.0, bytes);
  const auto state = std::get<LiveState>(decode_server_message(bytes)->content);
  EXPECT_TRUE(state.tool_taken);
  EXPECT_FALSE(state.has_tool);
}

}  // namespace
}  // namespace pcavr
