// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_message.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

#include "link/every_message.hpp"

namespace pcavr {
namespace {

using test::every_message;

TEST(LinkMessage, IsUnchangedByEncodingAndDecoding) {
  for (const LinkMessage& message : every_message()) {
    const std::vector<std::uint8_t> bytes = encode(message);
    const Expected<LinkMessage> decoded = decode_link_message(bytes);
    ASSERT_TRUE(decoded) << decoded.error().to_string() << ", type " << message.content.index();
    EXPECT_EQ(decoded->content.index(), message.content.index());
    EXPECT_EQ(decoded->header.sequence, message.header.sequence);
    EXPECT_EQ(decoded->header.session, message.header.session);
    EXPECT_EQ(encode(*decoded), bytes) << message.content.index();
  }
}

TEST(LinkMessage, CarriesTheCameraOfAPicture) {
  const LinkPictureCamera camera{300.0F, 301.0F, 159.5F, 119.5F, LensModel::rational, {0.1F, 0.2F}};
  const Expected<LinkMessage> decoded =
      decode_link_message(encode({{1, 2, 3.0}, LinkPicture{3.0, 320, 240, {1, 2}, camera}}));
  ASSERT_TRUE(decoded) << decoded.error().to_string();
  EXPECT_EQ(std::get<LinkPicture>(decoded->content).camera, camera);
  const Expected<LinkMessage> unknown =
      decode_link_message(encode({{1, 2, 3.0}, LinkPicture{3.0, 320, 240, {1, 2}}}));
  ASSERT_TRUE(unknown) << unknown.error().to_string();
  EXPECT_FALSE(std::get<LinkPicture>(unknown->content).camera);
  LinkPictureCamera wrong = camera;
  wrong.fy = -1.0F;
  EXPECT_FALSE(
      decode_link_message(encode({{1, 2, 3.0}, LinkPicture{3.0, 320, 240, {1, 2}, wrong}})));
}

TEST(LinkMessage, CarriesEveryFieldOfACommand) {
  const Expected<LinkMessage> decoded = decode_link_message(encode(every_message()[5]));
  const auto& command = std::get<LinkCommand>(decoded->content);
  EXPECT_DOUBLE_EQ(command.t, 12.345);
  EXPECT_FLOAT_EQ(command.p_base_tip.y(), -0.5F);
  EXPECT_TRUE(command.is_engaged);
  EXPECT_EQ(command.acknowledged.up_to, 7U);
  EXPECT_EQ(command.acknowledged.later, 5U);
  EXPECT_FLOAT_EQ(command.correction_delay, 0.4375F);
  ASSERT_EQ(command.predictions.size(), 2U);
  EXPECT_EQ(command.predictions[1].phase, MotionPhase::sliding);
  EXPECT_EQ(command.predictions[1].received, 200);
}

// Cut anywhere, and with one byte more.
TEST(LinkMessage, OfAnotherLengthIsInvalid) {
  for (const LinkMessage& message : every_message()) {
    std::vector<std::uint8_t> bytes = encode(message);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_FALSE(decode_link_message(std::span(bytes).first(length))) << length;
    }
    bytes.push_back(0);
    EXPECT_FALSE(decode_link_message(bytes)) << message.content.index();
  }
}

// Whatever a bit of the content becomes, the result is invalid or another message that is encoded
// as it was received.
TEST(LinkMessage, WithAnyBitChangedIsInvalidOrCanonical) {
  for (const LinkMessage& message : every_message()) {
    const std::vector<std::uint8_t> bytes = encode(message);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      std::vector<std::uint8_t> changed = bytes;
      changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ (1U << bit % 8));
      const Expected<LinkMessage> decoded = decode_link_message(changed);
      if (decoded) {
        EXPECT_EQ(encode(*decoded), changed) << message.content.index() << " " << bit;
      }
    }
  }
}

TEST(LinkMessage, OfRandomBytesNeverThrows) {
  Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::uint8_t> bytes = encode(every_message()[static_cast<std::size_t>(i) % 12]);
    for (int k = 0; k < 4; ++k) {
      bytes[random.below(bytes.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    EXPECT_NO_THROW(static_cast<void>(decode_link_message(bytes)));
  }
}

TEST(LinkMessage, OfAnotherVersionIsRecognisedAsSuch) {
  std::vector<std::uint8_t> bytes = encode(every_message()[0]);
  bytes[4] = 9;
  EXPECT_EQ(link_version_of(bytes), 9);
  const Expected<LinkMessage> decoded = decode_link_message(bytes);
  ASSERT_FALSE(decoded);
  EXPECT_NE(decoded.error().message.find("version 9"), std::string::npos);
  bytes[0] = 'X';
  EXPECT_EQ(link_version_of(bytes), std::nullopt);
}

TEST(LinkMessage, WithANumberThatIsNotFiniteIsInvalid) {
  LinkCommand command;
  command.p_base_tip.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(decode_link_message(encode({{1, 1, 0.0}, command})));
  LinkPong pong{std::numeric_limits<double>::infinity(), 0.0};
  EXPECT_FALSE(decode_link_message(encode({{1, 1, 0.0}, pong})));
}

TEST(LinkMessage, BeyondItsSizeIsNeitherEncodedNorDecoded) {
  EXPECT_THROW(static_cast<void>(encode({{}, LinkHello{std::string(300, 'a'), {}}})),
               ContractError);
  LinkPicture picture;
  picture.jpeg.resize(kMaxLinkPictureBytes);
  EXPECT_THROW(static_cast<void>(encode({{}, picture})), ContractError);
  EXPECT_FALSE(decode_link_message(std::vector<std::uint8_t>(kMaxLinkPictureBytes + 1)));
}

}  // namespace
}  // namespace pcavr
