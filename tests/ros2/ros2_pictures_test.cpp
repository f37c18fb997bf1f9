// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Pictures of a robot's camera that come from the other implementation of DDS.
#include <atomic>
#include <chrono>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/ros2/ros2_robot.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "ros2/ros2_peer.hpp"
#include "support/forked.hpp"
#include "support/ros_encoder.hpp"
#include "support/temporary_folder.hpp"

#ifndef PCAVR_FAST_DDS_PEER
#define PCAVR_FAST_DDS_PEER ""
#endif

namespace pcavr {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kWidth = 320, kHeight = 240;
constexpr char kImageType[] = "sensor_msgs/msg/Image";
constexpr char kInfoType[] = "sensor_msgs/msg/CameraInfo";
constexpr char kPoseType[] = "geometry_msgs/msg/PoseStamped";

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }
double local_now() { return read_clock(CLOCK_BOOTTIME); }

/// Red grows to the right, green downwards.
std::string colour_ramp() {
  std::string pixels;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      pixels += {static_cast<char>(x % 256), static_cast<char>(y), '\x40'};
    }
  }
  return pixels;
}

Ros2Setup setup_with_camera(const std::filesystem::path& tags, const DdsOptions& dds) {
  const Ros2Qos reliable{.is_reliable = true, .depth = 10};
  Ros2Setup setup;
  setup.dds = dds;
  setup.start_timeout = 20.0;
  setup.tool = {"/pose", kPoseType, reliable};
  // The peer echoes to this topic.
  setup.camera =
      Ros2Camera{{"/tool", kImageType, reliable}, {"/info", kInfoType, reliable}, "", tags};
  return setup;
}

TEST(Ros2Pictures, ShowWhatFastDdsPublishes) {
  if (std::string(PCAVR_FAST_DDS_PEER).empty()) GTEST_SKIP() << "built without libfastrtps-dev";
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "tags.yaml") << R"(
format: pcavr-recording/1
markers:
  - {family: tag36h11, id: 5, size: 0.08, role: object, object: box, pose: {t: [0, 0, 0], q: [0, 0, 0, 1]}}
objects:
  - {name: box}
)";
  DdsOptions dds = loopback_options();
  dds.domain += 30;  // not that of other tests
  const std::string domain = std::to_string(dds.domain), type = dds_type_name(kImageType);
  const ForkedProcess peer([&] {
    ForkedProcess::report_ready();
    ::execl(PCAVR_FAST_DDS_PEER, PCAVR_FAST_DDS_PEER, domain.c_str(), type.c_str(), nullptr);
  });
  const Ros2Qos reliable{.is_reliable = true, .depth = 10};
  auto publisher = open_dds({},
                            {{"/command", kImageType, reliable},
                             {"/info", kInfoType, reliable},
                             {"/pose", kPoseType, reliable}},
                            dds);
  if (!publisher) GTEST_SKIP() << publisher.error().to_string();
  const auto stamp = [] { return Stamp::from_seconds(local_now()); };
  const auto encoder = [] { return RosEncoder(RosEncoder::Format::cdr); };
  const Bytes image =
      bytes_of(encoder().image(stamp(), "camera", kWidth, kHeight, "rgb8", colour_ramp()).bytes());
  const Bytes info =
      bytes_of(encoder().camera_info(stamp(), "camera", kWidth, kHeight, 300, 160, 120).bytes());
  std::atomic<bool> is_over = false;
  std::thread robot_driver([&] {
    while (!is_over) {
      (void)(*publisher)->publish(2, cdr::pose_stamped(stamp(), Pose(), "base_link"));
      (void)(*publisher)->publish(1, info);
      (void)(*publisher)->publish(0, image);
      std::this_thread::sleep_for(50ms);
    }
  });
  TeleopInput world;
  world.objects.resize(1);
  world.objects[0].name = "box";
  auto robot = make_ros2_robot(setup_with_camera(folder.path() / "tags.yaml", dds), world);
  std::optional<CameraPicture> picture;
  const double start = local_now();
  while (robot && !picture && local_now() < start + 20.0) {
    RobotSamples samples;
    (*robot)->advance(local_now() - start, samples);
    if (auto newest = (*robot)->pictures()->newest(local_now() - start))
      picture = std::move(*newest);
    std::this_thread::sleep_for(1ms);
  }
  is_over = true;
  robot_driver.join();
  ASSERT_TRUE(robot) << robot.error().to_string();
  ASSERT_TRUE(picture);
  ASSERT_EQ(picture->image.width(), static_cast<int>(kWidth));
  ASSERT_EQ(picture->image.height(), static_cast<int>(kHeight));
  const Rgb8 pixel = picture->image(100, 200);
  EXPECT_EQ(pixel.r, 100);
  EXPECT_EQ(pixel.g, 200);
  EXPECT_EQ(pixel.b, 0x40);
}

}  // namespace
}  // namespace pcavr
