// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Fuses the same frames with pcavr and with Open3D's ScalableTSDFVolume, one thread each, same
// voxel and truncation, and prints CPU time, memory and accuracy of both. The poses are the
// recording's true ones, so that only fusion differs.
//
//   against_open3d RECORDING [TRUTH]      TRUTH: folder with camera.txt and scene.ply,
//                                         by default RECORDING/truth
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <malloc.h>
#include <open3d/geometry/Image.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>

#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/reconstruction/depth_filter.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/results/evaluation/surface_errors.hpp"

#include "arguments.hpp"

namespace {

using pcavr::bench::fail;
using pcavr::bench::value_or_exit;

namespace fs = std::filesystem;

constexpr pcavr::Parallelism kOneThread{1};
constexpr double kTruncationVoxels = 4.0;
/// pcavr's mesh excludes vertices measured in fewer frames.
constexpr double kMinWeight = 3.0;

struct Input {
  pcavr::CameraModel camera;
  pcavr::DepthNoise noise;
  std::vector<pcavr::RgbdFrame> frames;
  std::vector<pcavr::Pose> T_base_camera;
  pcavr::TriangleMesh truth_base;
};

struct Outcome {
  double ms_per_frame = 0.0;
  double us_per_triangle = 0.0;
  double megabytes = 0.0;
  std::size_t triangles = 0;
  pcavr::MeshErrors errors;
};

double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

double heap_megabytes() {
  const struct mallinfo2 heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd) / 1e6;
}

void append(pcavr::TriangleMesh& mesh, const pcavr::TriangleMesh& part) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& t : part.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

/// The true surfaces: the static scene, and each object at its first pose. Only valid for
/// recordings in which nothing moves.
pcavr::TriangleMesh read_truth(const pcavr::Recording& recording, const fs::path& truth) {
  pcavr::TriangleMesh mesh = value_or_exit(pcavr::read_mesh(truth / "scene.ply"));
  mesh.normals.clear();
  mesh.colors.clear();
  for (const pcavr::ObjectEntry& object : recording.manifest.objects) {
    const fs::path poses = truth / "objects" / (object.name + ".txt");
    if (object.mesh.empty() || !fs::exists(poses)) continue;
    const pcavr::Trajectory trajectory = value_or_exit(pcavr::read_trajectory(poses));
    const auto cad = value_or_exit(pcavr::read_mesh(recording.folder / object.mesh));
    append(mesh, pcavr::transformed(trajectory.poses().front().pose, cad));
  }
  return mesh;
}

Input read_input(const fs::path& folder, const fs::path& truth) {
  const pcavr::Recording recording = value_or_exit(pcavr::read_recording(folder));
  if (!recording.manifest.camera) fail(folder.string() + ": the recording has no images");
  const auto trajectory = value_or_exit(pcavr::read_trajectory(truth / "camera.txt"));
  Input input;
  input.camera = *recording.manifest.camera;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    pcavr::RgbdFrame frame = value_or_exit(pcavr::decode_frame(recording, i));
    const std::optional<pcavr::Pose> pose = trajectory.at(frame.depth_stamp);
    if (!pose) continue;
    input.frames.push_back(std::move(frame));
    input.T_base_camera.push_back(*pose);
  }
  if (input.frames.empty()) fail((truth / "camera.txt").string() + ": covers no frame");
  input.truth_base = read_truth(recording, truth);
  return input;
}

pcavr::MeshErrors errors_of(const Input& input, const pcavr::TriangleMesh& mesh) {
  pcavr::Views views;
  views.camera = input.camera;
  for (std::size_t i = 0; i < input.T_base_camera.size(); i += 4) {
    views.T_base_camera.push_back(input.T_base_camera[i]);
  }
  pcavr::SurfaceErrorOptions options;
  options.sample_spacing = 0.008;
  return pcavr::mesh_errors(input.truth_base, mesh, views, options, pcavr::Parallelism::max());
}

Outcome run_pcavr(const Input& input, double voxel_size) {
  Outcome outcome;
  const double heap = heap_megabytes();
  pcavr::TsdfOptions options(voxel_size);
  options.truncation_voxels = kTruncationVoxels;
  options.depth_noise = input.noise;
  pcavr::TsdfVolume volume(options);
  double start = cpu_ms();
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    const pcavr::DepthImage depth =
        pcavr::filter_depth(input.frames[i].depth, input.camera, input.noise, kOneThread);
    volume.integrate(depth, input.frames[i].color, {}, input.camera, input.T_base_camera[i],
                     kOneThread);
  }
  outcome.ms_per_frame = (cpu_ms() - start) / static_cast<double>(input.frames.size());
  outcome.megabytes = heap_megabytes() - heap;
  start = cpu_ms();
  const pcavr::TriangleMesh mesh = volume.extract_mesh(kMinWeight, kOneThread);
  outcome.triangles = mesh.triangles.size();
  outcome.us_per_triangle = (cpu_ms() - start) * 1e3 / static_cast<double>(mesh.triangles.size());
  outcome.errors = errors_of(input, mesh);
  return outcome;
}

open3d::geometry::RGBDImage to_open3d(const Input& input, const pcavr::RgbdFrame& frame) {
  open3d::geometry::Image color;
  color.Prepare(input.camera.width, input.camera.height, 3, 1);
  std::memcpy(color.data_.data(), frame.color.pixels().data(), color.data_.size());
  open3d::geometry::Image depth;
  depth.Prepare(input.camera.width, input.camera.height, 1, 4);
  auto* to = reinterpret_cast<float*>(depth.data_.data());
  const std::span<const float> from = frame.depth.pixels();
  const auto max_depth = static_cast<float>(input.noise.max_depth);
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = from[i] <= max_depth ? from[i] : 0.0F;
  return {color, depth};
}

pcavr::TriangleMesh from_open3d(const open3d::geometry::TriangleMesh& mesh) {
  pcavr::TriangleMesh result;
  for (const Eigen::Vector3d& p : mesh.vertices_) result.vertices.push_back(p.cast<float>());
  for (const Eigen::Vector3i& t : mesh.triangles_) {
    result.triangles.push_back({static_cast<std::uint32_t>(t.x()),
                                static_cast<std::uint32_t>(t.y()),
                                static_cast<std::uint32_t>(t.z())});
  }
  return result;
}

Outcome run_open3d(const Input& input, double voxel_size) {
  Outcome outcome;
  const open3d::camera::PinholeCameraIntrinsic intrinsic(input.camera.width, input.camera.height,
                                                         input.camera.fx, input.camera.fy,
                                                         input.camera.cx, input.camera.cy);
  const double heap = heap_megabytes();
  open3d::pipelines::integration::ScalableTSDFVolume volume(
      voxel_size, kTruncationVoxels * voxel_size,
      open3d::pipelines::integration::TSDFVolumeColorType::RGB8);
  double total = 0.0;
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    const auto image = to_open3d(input, input.frames[i]);  // conversion, not timed
    const double start = cpu_ms();
    volume.Integrate(image, intrinsic, input.T_base_camera[i].inverse().matrix());
    total += cpu_ms() - start;
  }
  outcome.ms_per_frame = total / static_cast<double>(input.frames.size());
  outcome.megabytes = heap_megabytes() - heap;
  const double start = cpu_ms();
  const auto mesh = volume.ExtractTriangleMesh();
  outcome.triangles = mesh->triangles_.size();
  outcome.us_per_triangle = (cpu_ms() - start) * 1e3 / static_cast<double>(outcome.triangles);
  outcome.errors = errors_of(input, from_open3d(*mesh));
  return outcome;
}

void print_row(const char* what, double ours, double theirs) {
  std::printf("  %-34s %12.4g %12.4g %10.3f\n", what, ours, theirs, ours / theirs);
}

void compare(const Input& input, double voxel_size) {
  const Outcome ours = run_pcavr(input, voxel_size);
  const Outcome theirs = run_open3d(input, voxel_size);
  std::printf("\nvoxel %g mm, truncation %g voxels\n", voxel_size * 1e3, kTruncationVoxels);
  std::printf("  %-34s %12s %12s %10s\n", "", "pcavr", "Open3D", "ratio");
  print_row("fusion, CPU ms per frame", ours.ms_per_frame, theirs.ms_per_frame);
  print_row("mesh, CPU us per triangle", ours.us_per_triangle, theirs.us_per_triangle);
  print_row("mesh, 1000 triangles", static_cast<double>(ours.triangles) / 1e3,
            static_cast<double>(theirs.triangles) / 1e3);
  print_row("map, MB", ours.megabytes, theirs.megabytes);
  const auto accuracy = [&](const char* what, double pcavr::ErrorStatistics::*member) {
    print_row(what, ours.errors.accuracy.*member * 1e3, theirs.errors.accuracy.*member * 1e3);
  };
  accuracy("mesh to truth, mean, mm", &pcavr::ErrorStatistics::mean);
  accuracy("mesh to truth, median, mm", &pcavr::ErrorStatistics::median);
  accuracy("mesh to truth, p95, mm", &pcavr::ErrorStatistics::p95);
  print_row("truth seen, share within 5 mm", ours.errors.completeness_5mm,
            theirs.errors.completeness_5mm);
  print_row("truth seen, share within 10 mm", ours.errors.completeness_10mm,
            theirs.errors.completeness_10mm);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) fail("usage: against_open3d RECORDING [TRUTH]");
  const fs::path folder = argv[1];
  const Input input = read_input(folder, argc == 3 ? fs::path(argv[2]) : folder / "truth");
  std::printf("%s: %zu frames, one thread\n", folder.string().c_str(), input.frames.size());
  for (const double voxel_size : {0.010, 0.005}) compare(input, voxel_size);
  return 0;
}
