// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "../../apps/pcavr/startup_message.hpp"

#include <gtest/gtest.h>

namespace pcavr::app {
namespace {

StartupInfo on_all_interfaces() {
  return {.addresses = {"https://192.168.1.5:8443/"},
          .port = 8443,
          .scene = "kitchen",
          .mode = "live",
          .device = "page",
          .objects = {"box"},
          .code = "ABCDEF",
          .is_terminal = true,
          .is_local = false,
          .is_tls = true};
}

TEST(StartupMessage, AHeadsetIsToldTheAddressOfTheNetwork) {
  const std::string text = startup_message(on_all_interfaces());
  EXPECT_NE(text.find("network    open https://192.168.1.5:8443/ there"), std::string::npos);
  EXPECT_NE(text.find("\nscan "), std::string::npos);
}

TEST(StartupMessage, WithoutANetworkAHeadsetIsNotSentToItsOwnLocalhost) {
  StartupInfo info = on_all_interfaces();
  info.addresses = {"https://localhost:8443/"};
  info.has_network = false;
  const std::string text = startup_message(info);
  EXPECT_EQ(text.find("network    open"), std::string::npos);
  EXPECT_NE(text.find("this machine has no address"), std::string::npos);
  EXPECT_EQ(text.find("\nscan "), std::string::npos);  // the code would have localhost in it
}

TEST(StartupMessage, NoDeviceMovesTheToolOfARecording) {
  StartupInfo info = on_all_interfaces();
  EXPECT_NE(startup_message(info).find("moved by page"), std::string::npos);
  info.mode = "replay";
  EXPECT_EQ(startup_message(info).find("moved by"), std::string::npos);
}

}  // namespace
}  // namespace pcavr::app
