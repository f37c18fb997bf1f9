// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Fuses depth images to a surface (TSDF), with the camera poses in the recording's groundtruth.txt,
// and prints the size of the mesh.
//   03_fuse_frames RECORDING
#include <cstdio>

#include <pcavr/perception/reconstruction/depth_filter.hpp>
#include <pcavr/perception/reconstruction/tsdf_volume.hpp>
#include <pcavr/recordings/recording/frame_reader.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s RECORDING\n", argv[0]), 2;
  const auto recording = pcavr::read_recording(argv[1]);
  if (!recording || !recording->manifest.camera || recording->groundtruth.empty()) {
    std::fprintf(stderr, "needs a recording with images and groundtruth.txt\n");
    return 1;
  }
  const pcavr::CameraModel& camera = *recording->manifest.camera;
  const pcavr::Parallelism threads = pcavr::Parallelism::max();
  pcavr::TsdfVolume volume(pcavr::TsdfOptions(0.01));

  pcavr::FrameReader reader(*recording);
  while (true) {
    const auto frame = reader.next();
    if (!frame) return std::fprintf(stderr, "%s\n", frame.error().to_string().c_str()), 1;
    if (!*frame) break;
    const auto T_base_camera = recording->groundtruth.at((*frame)->depth_stamp);
    if (!T_base_camera) continue;
    const pcavr::DepthImage depth =
        pcavr::filter_depth((*frame)->depth, camera, volume.options().depth_noise, threads);
    volume.integrate(depth, (*frame)->color, {}, camera, *T_base_camera, threads);
  }
  const pcavr::TriangleMesh mesh_base = volume.extract_mesh(2.0, threads);
  std::printf("%zu triangles, %.2f m^2, from %zu blocks in %zu kB\n", mesh_base.triangles.size(),
              pcavr::surface_area(mesh_base), volume.block_count(), volume.memory_bytes() / 1024);
}
