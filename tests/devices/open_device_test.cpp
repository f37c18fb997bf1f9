// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/open_device.hpp"

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "devices/fake_spacenavd.hpp"
#include "support/temporary_folder.hpp"

/// Suppression for the leak sanitizer: libspnav 1.0 leaks a few bytes if its open fails.
extern "C" const char* __lsan_default_suppressions();   // NOLINT(bugprone-reserved-identifier)
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:spnav_open";
}

namespace pcavr {
namespace {

std::string error_text(const std::string& description) {
  const auto device = open_device(description);
  return device ? "it opened" : device.error().to_string();
}

TEST(OpenDevice, OpensDevicesWithoutHardware) {
  const TemporaryFolder folder;
  const std::string trace = (folder.path() / "trace.csv").string();
  ASSERT_TRUE(write_file(trace, "t,x,y,z\n0,0,0,0\n1,0.1,0,0\n"));
  for (const std::string& description :
       {std::string("simulated"), "trace:" + trace,
        "plugin:" + std::string(PCAVR_FAULTY_PLUGINS) + "answers.so",
        "plugin:" + std::string(PCAVR_FAULTY_PLUGINS) + "answers.so,nan"}) {
    const auto device = open_device(description);
    ASSERT_TRUE(device) << device.error().to_string();
    EXPECT_FALSE((*device)->name().empty());
    EXPECT_TRUE((*device)->exchange(0.0, 0.001, {}).is_present) << description;
  }
}

TEST(OpenDevice, OpensASpaceMouse) {
  const test::FakeSpacenavd daemon;
  const auto device = open_device("spacemouse");
  ASSERT_TRUE(device) << device.error().to_string();
  EXPECT_EQ((*device)->name(), "SpaceMouse (FakeNavigator)");
}

TEST(OpenDevice, ListsTheChoicesForAnUnknownType) {
  for (const char* description : {"", "mouse", "spacemouse:1", "gamepad:", "simulated:x", "trace",
                                  "trace:", "plugin", "plugin:", ":"}) {
    const std::string line = error_text(description);
    EXPECT_NE(line.find("unknown device '" + std::string(description) + "'; choose " +
                        std::string(kDeviceChoices)),
              std::string::npos)
        << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(OpenDevice, ReportsTheErrorOfAFile) {
  EXPECT_NE(error_text("trace:/nowhere.csv").find("/nowhere.csv"), std::string::npos);
  EXPECT_NE(error_text("plugin:/nowhere.so,x").find("/nowhere.so: does not exist"),
            std::string::npos);
  EXPECT_NE(error_text("plugin:" + std::string(PCAVR_FAULTY_PLUGINS) + "answers.so,unplugged")
                .find("no device on the bus"),
            std::string::npos);
}

TEST(OpenDevice, HintsHowToInstallTheSpaceMouseDaemon) {
  const TemporaryFolder folder;
  setenv("SPNAV_SOCKET", (folder.path() / "none").c_str(), 1);
  const auto device = open_device("spacemouse");
  unsetenv("SPNAV_SOCKET");
  if (device) GTEST_SKIP() << "a real SpaceMouse is plugged in";
  EXPECT_NE(device.error().to_string().find("apt-get install spacenavd"), std::string::npos)
      << device.error().to_string();
}

}  // namespace
}  // namespace pcavr
