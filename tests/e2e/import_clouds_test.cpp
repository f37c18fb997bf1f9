// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// `pcavr import` of point clouds: small scans of a corner, and everything that can be wrong with
// them. A wrong input gives one line, exit code 1 and no output.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "pcavr/recordings/cloud/cloud_file.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/json_command.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr CameraModel kCamera{
    .width = 160, .height = 120, .fx = 130.0, .fy = 130.0, .cx = 79.5, .cy = 59.5};
constexpr int kClouds = 6;

/// The camera in base, which moves along a corner of three planes.
Pose camera_pose(int frame) {
  Vector6d twist;
  twist << 0.06 * frame, 0.07 * frame, 0.03 * frame, 0.01, 0.03 * frame, 0.05 * frame;
  return Pose::exp(twist);
}

/// Distance along a ray from `origin` to the corner of the planes x = 1, y = 0.8, z = 2.5, where
/// the first two have waves for the alignment to hold on to.
double range_along(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  double range = 0.3;
  // Steps along the ray, until it is behind one of the surfaces.
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d p = origin + range * ray;
    const double wave = 0.1 * std::sin(9.0 * p.z()) * std::sin(7.0 * (p.x() + p.y()));
    const double clearance = std::min({1.0 + wave - p.x(), 0.8 + wave - p.y(), 2.5 + wave - p.z()});
    if (clearance < 1e-5) break;
    range += 0.4 * clearance / ray.norm();
  }
  return range;
}

PointCloud organised_cloud(int frame) {
  const Pose T_base_camera = camera_pose(frame);
  PointCloud cloud;
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d ray = kCamera.unproject({double(u), double(v)}, 1.0);
      const double z = range_along(T_base_camera.translation(), T_base_camera.rotation() * ray);
      Eigen::Vector3f point = (z * ray).cast<float>();
      if (u < 3) point.setConstant(std::nanf(""));
      cloud.points.push_back(point);
      cloud.colors.push_back({static_cast<std::uint8_t>(u), static_cast<std::uint8_t>(v), 90});
    }
  }
  return cloud;
}

/// The clouds once, for all tests.
const std::vector<PointCloud>& organised_clouds() {
  static const std::vector<PointCloud> clouds = [] {
    std::vector<PointCloud> made;
    for (int i = 0; i < kClouds; ++i) made.push_back(organised_cloud(i));
    return made;
  }();
  return clouds;
}

class ImportClouds : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(clouds());
    write([](PointCloud&) {});
    write_poses([](const Pose& pose) { return pose; }, kClouds);
  }
  [[nodiscard]] fs::path clouds() const { return folder_.path() / "clouds"; }
  [[nodiscard]] fs::path poses() const { return folder_.path() / "poses.txt"; }
  [[nodiscard]] fs::path target() const { return folder_.path() / "recording"; }
  [[nodiscard]] fs::path cloud_file(int i) const {
    return clouds() / ("cloud_10" + std::to_string(i) + ".500.pcd");
  }

  void write(const std::function<void(PointCloud&)>& change, bool is_organised = true) const {
    for (int i = 0; i < kClouds; ++i) {
      PointCloud cloud = organised_clouds()[static_cast<std::size_t>(i)];
      change(cloud);
      if (!is_organised) remove_unmeasured(cloud);
      ASSERT_TRUE(write_file(cloud_file(i), format_pcd(cloud, is_organised ? kCamera.width : 0)));
    }
  }
  static void remove_unmeasured(PointCloud& cloud) {
    PointCloud kept;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (std::isnan(cloud.points[i].x())) continue;
      kept.points.push_back(cloud.points[i]);
      kept.colors.push_back(cloud.colors[i]);
    }
    cloud = kept;
  }
  void write_poses(const std::function<Pose(const Pose&)>& change, int count) const {
    Trajectory trajectory;
    for (int i = 0; i < count; ++i) {
      trajectory.append(Stamp{(100 + i) * 1'000'000'000LL + 500'000'000}, change(camera_pose(i)));
    }
    ASSERT_TRUE(write_file(poses(), format_trajectory(trajectory)));
  }

  [[nodiscard]] json import(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {"import", clouds().string(), "-o", target().string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_json(arguments);
  }
  void expect_refused(const std::vector<std::string>& options, const std::string& text) const {
    std::vector<std::string> arguments = {"import", clouds().string(), "-o", target().string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandOutcome outcome = run_pcavr(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << outcome.standard_error;
    const std::size_t at = outcome.standard_error.find("pcavr: ");
    ASSERT_NE(at, std::string::npos) << outcome.standard_error;
    const std::string line = outcome.standard_error.substr(at);
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    EXPECT_NE(line.find(text), std::string::npos) << line;
    EXPECT_EQ(outcome.standard_error.find("[pcl::"), std::string::npos) << outcome.standard_error;
    EXPECT_FALSE(fs::exists(target()));
  }
  [[nodiscard]] Recording recording() const { return read_recording(target()).value(); }

  TemporaryFolder folder_;
};

TEST_F(ImportClouds, OrganisedWithPosesInBase) {
  const json report = import({"--poses", poses().string()});
  EXPECT_EQ(report["frames"], kClouds);
  EXPECT_EQ(report["is_organised"], true);
  EXPECT_LT(report["pinhole_residual_px"].get<double>(), 0.01);
  const Recording read = recording();
  EXPECT_NEAR(read.manifest.camera->fx, kCamera.fx, 0.01);
  EXPECT_NEAR(read.manifest.camera->cy, kCamera.cy, 0.01);
  ASSERT_EQ(read.frames.size(), static_cast<std::size_t>(kClouds));
  EXPECT_EQ(read.frames[1].depth_stamp.nanoseconds, 101'500'000'000);
  EXPECT_LT(translation_distance(read.groundtruth.poses()[5].pose, camera_pose(5)), 1e-9);
}

TEST_F(ImportClouds, UnorganisedByTheirRays) {
  write([](PointCloud&) {}, false);
  const json report = import({"--poses", poses().string()});
  EXPECT_EQ(report["frames"], kClouds);
  EXPECT_EQ(report["is_organised"], false);
  EXPECT_LT(report["points_left_out"].get<double>(), 0.01 * report["points"].get<double>());
  // The grid of the depth camera is found again.
  EXPECT_NEAR(report["camera"][0].get<double>(), kCamera.fx, 0.01);
}

TEST_F(ImportClouds, AlignedWithEachOther) {
  const json report = import({"--T-base-world", "0", "0", "0", "0", "0", "0", "1"});
  EXPECT_EQ(report["poses"], "aligned");
  const Trajectory found = recording().groundtruth;
  const Pose T_base_world = camera_pose(0);
  for (int i = 0; i < kClouds; ++i) {
    const Pose T_base_camera = T_base_world * found.poses()[static_cast<std::size_t>(i)].pose;
    EXPECT_LT(translation_distance(T_base_camera, camera_pose(i)), 0.02) << i;
    EXPECT_LT(rotation_distance(T_base_camera, camera_pose(i)), 0.01) << i;
  }
}

TEST_F(ImportClouds, MillimetresAreDetectedAndReported) {
  write([](PointCloud& cloud) {
    for (Eigen::Vector3f& p : cloud.points) p *= 1000.0F;
  });
  const CommandOutcome outcome = run_pcavr(
      {"import", clouds().string(), "--poses", poses().string(), "-o", target().string()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.standard_error.find("millimetres"), std::string::npos);
  EXPECT_NEAR(recording().manifest.camera->fx, kCamera.fx, 0.01);
}

TEST_F(ImportClouds, ThreadsDoNotChangeTheResult) {
  write([](PointCloud&) {}, false);
  std::map<std::string, std::string> first;
  for (const char* threads : {"1", "3"}) {
    (void)import({"--poses", poses().string(), "--threads", threads, "--force"});
    if (first.empty()) first = contents(target());
    EXPECT_EQ(contents(target()), first);
  }
}

TEST_F(ImportClouds, TruncatedFile) {
  fs::resize_file(cloud_file(3), 1000);
  expect_refused({"--poses", poses().string()}, "cloud_103.500.pcd: is truncated");
}

TEST_F(ImportClouds, PlyOfATrillionPoints) {
  std::ofstream(clouds() / "cloud_107.5.ply")
      << "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\n"
         "property float y\nproperty float z\nend_header\n";
  expect_refused({}, "cloud_107.5.ply:3: 1000000000000 points are more than");
}

TEST_F(ImportClouds, PosesOfAnotherNumber) {
  write_poses([](const Pose& pose) { return pose; }, kClouds - 1);
  expect_refused({"--poses", poses().string()}, "5 poses for 6 clouds");
}

TEST_F(ImportClouds, EmptyCloud) {
  ASSERT_TRUE(write_file(cloud_file(2), format_pcd(PointCloud{})));
  expect_refused({"--poses", poses().string()}, "cloud_102.500.pcd: has no measured point");
  std::ofstream(cloud_file(2)) << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 0\n"
                                  "HEIGHT 0\nPOINTS 0\nDATA ascii\n";
  expect_refused({"--poses", poses().string()}, "cloud_102.500.pcd: has no measured point");
}

TEST_F(ImportClouds, MirroredCloud) {
  write([](PointCloud& cloud) {
    for (Eigen::Vector3f& p : cloud.points) p.x() = -p.x();
  });
  expect_refused({"--poses", poses().string()}, "is mirrored");
}

TEST_F(ImportClouds, PosesOfALeftHandedFrame) {
  write_poses(
      [](const Pose& pose) {
        Eigen::Matrix4d S = Eigen::Matrix4d::Identity();
        S(1, 1) = -1.0;
        return Pose::from_matrix(S * Pose(pose).matrix() * S);
      },
      kClouds);
  expect_refused({"--poses", poses().string()},
                 "left-handed frame; they fit with their axes read as (x, -y, z)");
}

TEST_F(ImportClouds, PosesWithMirroredOrSwappedPositions) {
  const auto write_positions = [&](const Eigen::Matrix3d& S) {
    write_poses([&](const Pose& pose) { return Pose(pose.rotation(), S * pose.translation()); },
                kClouds);
  };
  const Eigen::Vector3d signs(1.0, -1.0, 1.0);
  write_positions(signs.asDiagonal());
  expect_refused({"--poses", poses().string()},
                 "the axes of their positions, which fit with their axes read as (x, -y, z)");
  Eigen::Matrix3d swapped = Eigen::Matrix3d::Zero();
  swapped(0, 0) = swapped(1, 2) = swapped(2, 1) = 1.0;
  write_positions(swapped);
  expect_refused({"--poses", poses().string()},
                 "the axes of their positions, which fit with their axes read as (x, z, y)");
}

TEST_F(ImportClouds, PosesWithInvertedRotations) {
  write_poses(
      [](const Pose& pose) { return Pose(pose.rotation().conjugate(), pose.translation()); },
      kClouds);
  expect_refused({"--poses", poses().string()}, "the poses are inverted in their rotations");
}

TEST_F(ImportClouds, OptionsOfAnArmsLog) {
  expect_refused({"--skip-bad"}, "--skip-bad is for CSV files and the log of an arm");
}

TEST_F(ImportClouds, StampsOfPosesMayBeRounded) {
  Trajectory trajectory;
  for (int i = 0; i < kClouds; ++i) {
    trajectory.append(Stamp{(100 + i) * 1'000'000'000LL + 499'999'000}, camera_pose(i));
  }
  ASSERT_TRUE(write_file(poses(), format_trajectory(trajectory)));
  EXPECT_EQ(import({"--poses", poses().string()})["frames"], kClouds);
}

TEST_F(ImportClouds, PosesThatNothingExplainsAreDoubted) {
  // Each cloud faces another way.
  int turn = 0;
  write_poses(
      [&](const Pose& pose) {
        return pose * Pose(Eigen::Quaterniond(Eigen::AngleAxisd(turn++, Eigen::Vector3d::UnitY())),
                           Eigen::Vector3d::Zero());
      },
      kClouds);
  const CommandOutcome outcome = run_pcavr(
      {"import", clouds().string(), "--poses", poses().string(), "-o", target().string()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.standard_error;
  EXPECT_NE(outcome.standard_error.find("check the poses"), std::string::npos)
      << outcome.standard_error;
}

TEST_F(ImportClouds, TagsAndAGivenWorldExcludeEachOther) {
  const CommandOutcome outcome =
      run_pcavr({"import", clouds().string(), "--poses", poses().string(), "--T-base-world", "0",
                 "0", "0", "0", "0", "0", "1", "--anchor-tags", "-o", target().string()});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_FALSE(fs::exists(target()));
}

/// Unorganised clouds in the sensor's frame: VIEWPOINT is the cloud's pose, as of PCL's viewer.
TEST_F(ImportClouds, UnorganisedInTheSensorsFrameWithViewpoints) {
  for (int i = 0; i < kClouds; ++i) {
    PointCloud cloud = organised_clouds()[static_cast<std::size_t>(i)];
    remove_unmeasured(cloud);
    std::string text = format_pcd(cloud);
    const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
    const std::size_t at = text.find(none);
    ASSERT_NE(at, std::string::npos);
    const Eigen::Vector3d t = camera_pose(i).translation();
    const Eigen::Quaterniond q(camera_pose(i).rotation());
    text.replace(at, none.size(),
                 fmt::format("VIEWPOINT {} {} {} {} {} {} {}", t.x(), t.y(), t.z(), q.w(), q.x(),
                             q.y(), q.z()));
    ASSERT_TRUE(write_file(cloud_file(i), text));
  }
  const json report = import({});
  EXPECT_EQ(report["poses"], "viewpoints");
  EXPECT_EQ(report["frames"], kClouds);
  EXPECT_EQ(report["points_left_out"], 0);
  const Recording made = recording();
  for (int i = 0; i < kClouds; ++i) {
    const Pose& pose = made.groundtruth.poses()[static_cast<std::size_t>(i)].pose;
    EXPECT_LT(translation_distance(pose, camera_pose(i)), 1e-5) << i;
    EXPECT_LT(rotation_distance(pose, camera_pose(i)), 1e-5) << i;
  }
}

/// A grabber writes one viewpoint wherever its camera is: half a turn of PCL's OpenNI grabber, or a
/// mounting.
TEST_F(ImportClouds, OneViewpointForAllIsNoPose) {
  for (const char* viewpoint : {"0 0 0 0 1 0 0", "0.1 -0.2 1.5 0.5 -0.5 0.5 -0.5"}) {
    for (int i = 0; i < kClouds; ++i) {
      std::string text = format_pcd(organised_clouds()[static_cast<std::size_t>(i)], kCamera.width);
      const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
      const std::size_t at = text.find(none);
      ASSERT_NE(at, std::string::npos);
      text.replace(at, none.size(), std::string("VIEWPOINT ") + viewpoint);
      ASSERT_TRUE(write_file(cloud_file(i), text));
    }
    const json report = import({"--force"});
    EXPECT_EQ(report["poses"], "aligned") << viewpoint;
    const Recording made = recording();
    const std::vector<TimedPose>& poses = made.groundtruth.poses();
    for (int i = 1; i < kClouds; ++i) {
      const Pose moved = poses[0].pose.inverse() * poses[static_cast<std::size_t>(i)].pose;
      EXPECT_LT(translation_distance(moved, camera_pose(0).inverse() * camera_pose(i)), 0.02) << i;
    }
  }
}

/// Neighbouring faces of a cube both see the points on their edge.
TEST_F(ImportClouds, AllAroundNoMorePointsAreLeftOutThanThereAre) {
  PointCloud sphere;
  for (int i = 0; i < 40000; ++i) {
    // A spiral of nearly equal distances.
    const double z = 1.0 - (2.0 * i + 1.0) / 40000.0;
    const double angle = 2.399963 * i;
    const double r = std::sqrt(1.0 - z * z);
    sphere.points.emplace_back(static_cast<float>(2.0 * r * std::cos(angle)),
                               static_cast<float>(2.0 * r * std::sin(angle)),
                               static_cast<float>(2.0 * z));
    sphere.colors.push_back({});
  }
  for (int i = 0; i < kClouds; ++i) {
    ASSERT_TRUE(write_file(cloud_file(i), format_pcd(sphere)));
  }
  write_poses([](const Pose&) { return Pose(); }, kClouds);
  const json report = import({"--poses", poses().string()});
  EXPECT_EQ(report["frames"], 6 * kClouds);
  EXPECT_LE(report["points_left_out"].get<std::size_t>(), report["points"].get<std::size_t>());
}

TEST_F(ImportClouds, NoPinholeProjection) {
  write([](PointCloud& cloud) {
    for (Eigen::Vector3f& p : cloud.points) p.x() += 0.3F * p.x() * std::abs(p.x());
  });
  expect_refused({"--poses", poses().string()}, "no pinhole projection");
}

TEST_F(ImportClouds, CloudsWithoutOverlap) {
  // A few points in a plane far from all others.
  PointCloud other;
  for (int i = 0; i < 400; ++i) {
    other.points.emplace_back(0.01F * static_cast<float>(i % 20),
                              0.05F * static_cast<float>(i / 20), 0.5F);
    other.colors.push_back({});
  }
  for (int i = 0; i < kClouds; ++i) {
    PointCloud cloud = organised_clouds()[static_cast<std::size_t>(i)];
    remove_unmeasured(cloud);
    ASSERT_TRUE(write_file(cloud_file(i), format_pcd(i == 4 ? other : cloud)));
  }
  expect_refused({}, "does not overlap");
}

TEST_F(ImportClouds, OptionsOfCloudsForImagesAreRefused) {
  fs::remove_all(clouds());
  fs::create_directories(clouds());
  std::ofstream(clouds() / "rgb.txt") << "";
  std::ofstream(clouds() / "depth.txt") << "";
  expect_refused({"--unit", "mm"}, "--unit is for point clouds");
}

}  // namespace
}  // namespace pcavr
