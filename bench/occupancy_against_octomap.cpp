// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// Fuses the same depth images into pcavr's occupancy map and into OctoMap's own, on one thread,
// and prints the CPU time of each and the share of known cells on which both agree.
//
//   pcavr_bench_occupancy RECORDING TRAJECTORY [FRAMES] [RESOLUTION]
//
// RECORDING: a pcavr recording; TRAJECTORY: TUM poses of its camera in base.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/octomap_reference.hpp"

namespace {

double cpu_milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

int fail(const pcavr::Error& error) {
  std::fprintf(stderr, "%s\n", error.to_string().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s RECORDING TRAJECTORY [FRAMES] [RESOLUTION]\n", argv[0]);
    return 2;
  }
  const auto recording = pcavr::read_recording(argv[1]);
  if (!recording) return fail(recording.error());
  const auto trajectory = pcavr::read_trajectory(argv[2]);
  if (!trajectory) return fail(trajectory.error());
  const std::size_t frames = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 20;
  pcavr::OccupancyOptions options;
  if (argc > 4) options.resolution = std::strtod(argv[4], nullptr);

  pcavr::OccupancyMap ours(options);
  octomap::OcTree theirs = pcavr::octomap_with(options);
  double ours_ms = 0.0;
  double theirs_ms = 0.0;
  double points = 0.0;
  std::size_t used = 0;
  const std::size_t step = std::max<std::size_t>(1, recording->frames.size() / frames);
  for (std::size_t i = 0; i < recording->frames.size(); i += step) {
    const auto frame = pcavr::decode_frame(*recording, i);
    if (!frame) return fail(frame.error());
    const auto T_base_camera = trajectory->at(frame->depth_stamp);
    if (!T_base_camera) continue;
    const octomap::Pointcloud cloud =
        pcavr::cloud_base_of(frame->depth, *recording->manifest.camera, *T_base_camera);
    const double start = cpu_milliseconds();
    ours.integrate(frame->depth, {}, *recording->manifest.camera, *T_base_camera);
    const double between = cpu_milliseconds();
    pcavr::insert(cloud, *T_base_camera, options, theirs);
    ours_ms += between - start;
    theirs_ms += cpu_milliseconds() - between;
    points += static_cast<double>(cloud.size());
    ++used;
  }
  if (used == 0) return fail({.message = "no frame has a pose", .file = argv[2]});
  const double n = static_cast<double>(used);
  const pcavr::CellAgreement agreement = pcavr::compare(ours, theirs);
  std::printf("frames %zu, points per frame %.0f, cell %.3f m\n", used, points / n,
              options.resolution);
  std::printf("pcavr   %8.2f ms CPU per frame, %.1f MB\n", ours_ms / n,
              static_cast<double>(ours.memory_bytes()) * 1e-6);
  std::printf("OctoMap %8.2f ms CPU per frame, %.1f MB\n", theirs_ms / n,
              static_cast<double>(theirs.memoryUsage()) * 1e-6);
  std::printf("ratio   %8.4f\n", ours_ms / theirs_ms);
  std::printf("same cells %.5f of %zu known in either map\n", agreement.share(), agreement.known);
  return 0;
}
