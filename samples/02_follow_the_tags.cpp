// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Tracks tagged objects: prints each object's position in the camera frame, frame by frame, with
// its standard deviation.
//   02_follow_the_tags RECORDING
#include <cmath>
#include <cstdio>
#include <set>

#include <pcavr/perception/marker/body_pose.hpp>
#include <pcavr/recordings/recording/frame_reader.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s RECORDING\n", argv[0]), 2;
  const auto recording = pcavr::read_recording(argv[1]);
  if (!recording || !recording->manifest.camera) {
    std::fprintf(stderr, "no recording with images\n");
    return 1;
  }
  std::set<std::string> families;
  for (const auto& marker : recording->manifest.markers) families.insert(marker.id.family);
  auto detector = pcavr::TagDetector::create({families.begin(), families.end()});
  if (!detector) return std::fprintf(stderr, "%s\n", detector.error().message.c_str()), 1;

  pcavr::FrameReader reader(*recording);
  while (true) {
    const auto frame = reader.next();
    if (!frame) return std::fprintf(stderr, "%s\n", frame.error().to_string().c_str()), 1;
    if (!*frame) return 0;
    const auto tags = detector->detect(pcavr::to_gray((*frame)->color));
    for (const auto& object : recording->manifest.objects) {
      const pcavr::BodyPose body =
          pcavr::solve_body_pose(pcavr::object_placements(recording->manifest, object.name), tags,
                                 *recording->manifest.camera, {.depth = &(*frame)->depth});
      if (body.status != pcavr::BodyPoseStatus::solved) continue;
      const Eigen::Vector3d& p = body.pose.T_camera_body.translation();
      std::printf("%s  %s at %.4f %.4f %.4f m, +-%.2f mm, by %d tags\n",
                  pcavr::format_stamp((*frame)->color_stamp).c_str(), object.name.c_str(), p.x(),
                  p.y(), p.z(), 1e3 * std::sqrt(body.covariance.topLeftCorner<3, 3>().trace()),
                  body.tags_used);
    }
  }
}
