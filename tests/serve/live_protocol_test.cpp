// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/live_protocol.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "serve/server_message_reader.hpp"

namespace pcavr {
namespace {

float number(Random& random) { return static_cast<float>(random.uniform(-2.0, 2.0)); }
Eigen::Vector3f vector(Random& random) {
  const float x = number(random);
  const float y = number(random);
  return {x, y, number(random)};
}
Eigen::Quaternionf rotation(Random& random) {
  return Eigen::Quaternionf(number(random), number(random), number(random), 3.0F).normalized();
}

PageMessage a_tool(Random& random) {
  LiveTool tool;
  tool.p_base_tip = vector(random);
  tool.q_base_tool = rotation(random);
  tool.is_engaged = random.below(2) == 1;
  tool.device = static_cast<LiveInputDevice>(random.below(4));
  return {{static_cast<std::uint32_t>(1 + random.below(1000)), random.uniform(0.0, 1e6)}, tool};
}

LiveState a_state(Random& random, std::size_t objects) {
  LiveState state;
  state.t = random.uniform(0.0, 1e4);
  state.page_clock = random.uniform(0.0, 1e4);
  state.is_engaged = random.below(2) == 1;
  state.is_on_hold = random.below(2) == 1;
  state.touches_scan = random.below(2) == 1;
  state.has_tool = random.below(2) == 1;
  state.tool_taken = random.below(2) == 1;
  state.can_undo_reset = random.below(2) == 1;
  state.is_tool_wanted = random.below(2) == 1;
  state.has_asked = random.below(2) == 1;
  state.is_recording = random.below(2) == 1;
  if (random.below(5) > 0) state.touched_object = random.below(4);
  state.p_base_hip = vector(random);
  state.p_base_proxy = vector(random);
  state.force_base = vector(random);
  state.pulse = number(random);
  state.pulses = 7;
  state.cycles = 4'000'000'000U;
  state.late_cycles = 3;
  state.cycle_longest = 1e-4F;
  state.tool_age = 0.003F;
  state.state_age = 0.001F;
  state.queue_age = 0.002F;
  for (std::size_t i = 0; i < objects; ++i) {
    state.objects.push_back({vector(random), rotation(random), vector(random),
                             static_cast<MotionPhase>(random.below(4)), random.below(2) == 1,
                             random.below(2) == 1, random.below(2) == 1, number(random)});
  }
  return state;
}

std::vector<PageMessage> one_of_each(Random& random) {
  return {{{1, 0.5}, LiveHello{kLiveProtocolVersion, "0.1.0"}},
          a_tool(random),
          {{3, 0.5}, LiveCommand::take_tool},
          {{4, 0.5}, LivePing{}}};
}

TEST(LiveProtocol, PageMessagesSurviveARoundTrip) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const PageMessage message = a_tool(random);
    const auto& tool = std::get<LiveTool>(message.content);
    const auto read = decode_page_message(encode(message));
    ASSERT_TRUE(read) << read.error().to_string();
    const auto& same = std::get<LiveTool>(read->content);
    EXPECT_EQ(read->header.sequence, message.header.sequence);
    EXPECT_EQ(read->header.clock, message.header.clock);
    EXPECT_EQ(same.p_base_tip, tool.p_base_tip);
    EXPECT_EQ(same.q_base_tool.coeffs(), tool.q_base_tool.coeffs());
    EXPECT_EQ(same.is_engaged, tool.is_engaged);
    EXPECT_EQ(same.device, tool.device);
  }
  for (const auto command :
       {LiveCommand::hold, LiveCommand::resume, LiveCommand::reset, LiveCommand::take_tool,
        LiveCommand::release_tool, LiveCommand::slower, LiveCommand::faster,
        LiveCommand::undo_reset, LiveCommand::hand_over_tool, LiveCommand::keep_tool}) {
    const auto read = decode_page_message(encode(PageMessage{{9, 1.0}, command}));
    ASSERT_TRUE(read);
    EXPECT_EQ(std::get<LiveCommand>(read->content), command);
  }
}

TEST(LiveProtocol, AStateSurvivesARoundTrip) {
  Random random(2);
  for (const std::size_t objects : {0U, 1U, 3U, 200U}) {
    const LiveState state = a_state(random, objects);
    const auto bytes = encode(ServerMessage{{5, 2.0}, state});
    EXPECT_EQ(bytes.size(), 24 + 104 + 48 * objects);
    std::vector<std::uint8_t> again{1, 2, 3};
    encode_state({5, 2.0}, state, again);
    EXPECT_EQ(again, bytes);
    const auto read = decode_server_message(bytes);
    ASSERT_TRUE(read) << read.error().to_string();
    const auto& same = std::get<LiveState>(read->content);
    EXPECT_EQ(encode(*read), bytes);
    EXPECT_EQ(same.touched_object, state.touched_object);
    EXPECT_EQ(same.cycles, state.cycles);
    ASSERT_EQ(same.objects.size(), objects);
    if (objects > 0) {
      EXPECT_EQ(same.objects.back().position, state.objects.back().position);
      EXPECT_EQ(same.objects.back().is_blocked, state.objects.back().is_blocked);
      EXPECT_EQ(same.objects.back().is_saturated, state.objects.back().is_saturated);
    }
  }
}

TEST(LiveProtocol, AnArmSurvivesARoundTrip) {
  Random random(3);
  LiveState state = a_state(random, 2);
  using Nearest = LiveArmState::Nearest;
  for (const std::optional<Nearest>& nearest :
       {std::optional<Nearest>(), std::optional(Nearest{0.02F, 3, {}, {}}),
        std::optional(Nearest{0.02F, 3, 1U, {}}), std::optional(Nearest{-0.01F, 3, {}, 0U})}) {
    state.arm = LiveArmState{{0.5F, -1.0F, 2.0F}, true, false, nearest};
    const auto bytes = encode(ServerMessage{{5, 2.0}, state});
    EXPECT_EQ(bytes.size(), 24U + 104U + 2U * 48U + 20U + 3U * 4U);
    const auto read = decode_server_message(bytes);
    ASSERT_TRUE(read) << read.error().to_string();
    const auto& same = std::get<LiveState>(read->content);
    ASSERT_TRUE(same.arm.has_value());
    EXPECT_EQ(same.arm->position, state.arm->position);
    EXPECT_TRUE(same.arm->is_stopped);
    ASSERT_EQ(same.arm->nearest.has_value(), nearest.has_value());
    if (!nearest) continue;
    EXPECT_EQ(same.arm->nearest->distance, nearest->distance);
    EXPECT_EQ(same.arm->nearest->link, 3U);
    EXPECT_EQ(same.arm->nearest->other_link, nearest->other_link);
    EXPECT_EQ(same.arm->nearest->object, nearest->object);
  }
}

TEST(LiveProtocol, FieldsAreAtTheirDocumentedOffsets) {
  LiveState state;
  state.t = 1.0;
  state.page_clock = 2.0;
  state.is_on_hold = true;
  state.tool_taken = true;
  state.force_base = {3.0F, 0.0F, 0.0F};
  state.pulses = 0x01020304;
  state.objects.resize(1);
  state.objects[0].phase = MotionPhase::sliding;
  state.objects[0].speed = 1.0F;
  const auto bytes = encode(ServerMessage{{0x0a0b0c0d, 1.0}, state});
  const std::vector<std::uint8_t> header(bytes.begin(), bytes.begin() + 24);
  EXPECT_EQ(header,
            (std::vector<std::uint8_t>{'P', 'C', 'V', 'R', 1, 2, 0, 0, 0x0d, 0x0c, 0x0b, 0x0a,
                                       152, 0,   0,   0,   0, 0, 0, 0, 0,    0,    0xf0, 0x3f}));
  const std::uint8_t* body = bytes.data() + 24;
  EXPECT_EQ(body[6], 0xf0);
  EXPECT_EQ(body[15], 0x40);
  EXPECT_EQ(body[16], 2 + 16);
  EXPECT_EQ(body[20], 0xff);
  EXPECT_EQ(body[50], 0x40);
  EXPECT_EQ(body[64], 0x04);
  EXPECT_EQ(body[67], 0x01);
  EXPECT_EQ(body[100], 1);
  EXPECT_EQ(body[104 + 40], 3);
  EXPECT_EQ(body[104 + 47], 0x3f);
}

TEST(LiveProtocol, TextsSurviveARoundTrip) {
  const LiveWelcome welcome{kLiveProtocolVersion, "0.1.0", true, "tisch \xc3\xbc\xf0\x9f",
                            {"box", "can"},       0.01,    72.0, "page"};
  const auto read = decode_server_message(encode(ServerMessage{{1, 0.0}, welcome}));
  ASSERT_TRUE(read) << read.error().to_string();
  const auto& same = std::get<LiveWelcome>(read->content);
  EXPECT_TRUE(same.is_replay);
  EXPECT_EQ(same.objects, welcome.objects);
  EXPECT_EQ(same.scene.substr(0, 8), "tisch \xc3\xbc");
  const LiveNotice notice{LiveLevel::warning, "a \"text\"\n"};
  const auto decoded = decode_server_message(encode(ServerMessage{{2, 0.0}, notice}));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(std::get<LiveNotice>(decoded->content).text, notice.text);
  EXPECT_EQ(std::get<LiveNotice>(decoded->content).level, LiveLevel::warning);
  const auto pong = decode_server_message(encode(ServerMessage{{3, 0.0}, LivePong{4.5}}));
  ASSERT_TRUE(pong);
  EXPECT_EQ(std::get<LivePong>(pong->content).clock, 4.5);
}

TEST(LiveProtocol, RejectsEveryTruncationAndTrailingBytes) {
  Random random(3);
  for (const PageMessage& message : one_of_each(random)) {
    auto bytes = encode(message);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_FALSE(decode_page_message(std::span(bytes.data(), length)));
    }
    bytes.push_back(0);
    EXPECT_FALSE(decode_page_message(bytes));
  }
  auto state = encode(ServerMessage{{1, 0.0}, a_state(random, 2)});
  for (std::size_t length = 0; length < state.size(); ++length) {
    EXPECT_FALSE(decode_server_message(std::span(state.data(), length)));
  }
}

TEST(LiveProtocol, RejectsAStateWithTooLargeAnObjectCount) {
  Random random(4);
  auto bytes = encode(ServerMessage{{1, 0.0}, a_state(random, 2)});
  for (std::size_t i = 0; i < 4; ++i) bytes[24 + 100 + i] = 0xff;
  EXPECT_FALSE(decode_server_message(bytes));
}

TEST(LiveProtocol, RejectsNumbersOutOfRange) {
  const auto is_rejected = [](LiveTool tool, LiveHeader header = {1, 0.0}) {
    return !decode_page_message(encode(PageMessage{header, tool}));
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_rejected({}));
  EXPECT_TRUE(is_rejected({.p_base_tip = {0.0F, nan, 0.0F}}));
  EXPECT_TRUE(is_rejected({.q_base_tool = {nan, 0.0F, 0.0F, 0.0F}}));
  EXPECT_TRUE(is_rejected({.q_base_tool = {0.0F, 0.0F, 0.0F, 0.0F}}));
  EXPECT_TRUE(is_rejected({.q_base_tool = {2.0F, 0.0F, 0.0F, 0.0F}}));
  EXPECT_TRUE(is_rejected({.device = static_cast<LiveInputDevice>(4)}));
  EXPECT_TRUE(is_rejected({}, {0, 0.0}));
  EXPECT_TRUE(is_rejected({}, {1, std::numeric_limits<double>::infinity()}));
  for (const std::uint32_t command : {0U, 15U, 0xffffffffU}) {
    EXPECT_FALSE(
        decode_page_message(encode(PageMessage{{1, 0.0}, static_cast<LiveCommand>(command)})));
  }
}

TEST(LiveProtocol, TheErrorNamesAnotherVersion) {
  auto bytes = encode(PageMessage{{1, 0.0}, LivePing{}});
  bytes[4] = 7;
  const auto read = decode_page_message(bytes);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("protocol 7"), std::string::npos);
}

TEST(LiveProtocol, DecodesAHelloOfAnotherProtocol) {
  const auto read = decode_page_message(encode(PageMessage{{1, 0.0}, LiveHello{2, "9.9"}}));
  ASSERT_TRUE(read);
  EXPECT_EQ(std::get<LiveHello>(read->content).protocol, 2);
}

TEST(LiveProtocol, RejectsInvalidProtocolVersionsInHelloAndWelcome) {
  for (const int invalid : {-1, 2'000'000, std::numeric_limits<int>::max()}) {
    EXPECT_FALSE(decode_page_message(encode(PageMessage{{1, 0.0}, LiveHello{invalid, "9.9"}})));
    EXPECT_FALSE(decode_server_message(encode(ServerMessage{{1, 0.0}, LiveWelcome{invalid}})));
  }
}

TEST(LiveProtocol, PageAndServerMessagesAreDistinct) {
  Random random(5);
  EXPECT_FALSE(decode_page_message(encode(ServerMessage{{1, 0.0}, a_state(random, 1)})));
  EXPECT_FALSE(decode_server_message(encode(PageMessage{{1, 0.0}, LivePing{}})));
}

TEST(LiveProtocol, SurvivesRandomBytes) {
  Random random(6);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 20'000; ++i) {
    bytes = encode(a_tool(random));
    const std::size_t changes = 1 + random.below(4);
    for (std::size_t k = 0; k < changes; ++k) {
      bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    const auto read = decode_page_message(bytes);
    if (!read) continue;
    // An accepted message survives a round trip.
    EXPECT_TRUE(decode_page_message(encode(*read)));
  }
}

TEST(LiveProtocol, RejectsMessagesLongerThan64KiB) {
  std::vector<std::uint8_t> bytes = encode(PageMessage{{1, 0.0}, LivePing{}});
  bytes.resize(kMaxLiveMessageBytes + 1);
  const auto read = decode_page_message(bytes);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("64 KiB"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
