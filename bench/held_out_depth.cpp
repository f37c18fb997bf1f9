// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Distances of held-out depth images from the mesh that the other frames are fused into, where
// there is no true surface: real sensors. With Open3D, also of ScalableTSDFVolume's mesh of the
// same frames, poses, voxels and truncation.
//
//   pcavr_bench_held_out RECORDING POSES [EVERY [open3d] [SECTION.KEY=VALUE ...] [-- ...]]
//
// "--" separates sets of options that are compared; "open3d" adds Open3D to one of them.
// POSES: groundtruth.txt, or camera_trajectory.txt of a scene that was built from all frames. Every
// EVERY-th frame (default 5) is held out. All measurements within the sensor's range count, also
// those that no mesh is near: the share within 10 mm is of all of them. Where the recording has a
// true surface (truth/scene.ply; nothing moves), the errors against it follow.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/reconstruction/depth_filter.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"
#include "pcavr/pipeline/build_scene.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"
#include "pcavr/results/evaluation/surface_errors.hpp"

#include "arguments.hpp"

#ifdef PCAVR_HAS_OPEN3D
#include <cstring>

#include <open3d/geometry/Image.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>
#endif

namespace {

using pcavr::bench::fail;
using pcavr::bench::set_option;
using pcavr::bench::value_or_exit;

constexpr int kPixelStride = 4;
constexpr float kMaxDistance = 0.1F;  ///< [m]; points farther away count as that far

struct Frame {
  pcavr::RgbdFrame images;
  pcavr::Pose T_base_camera;
};

struct Input {
  pcavr::CameraModel camera;  ///< of the depth images
  std::vector<Frame> fused;
  std::vector<Frame> held_out;
  std::optional<pcavr::TriangleMesh> truth_base;
};

/// The static scene, and each object at its first pose.
std::optional<pcavr::TriangleMesh> read_truth(const pcavr::Recording& recording) {
  const std::filesystem::path truth = recording.folder / "truth";
  if (!std::filesystem::exists(truth / "scene.ply")) return std::nullopt;
  pcavr::TriangleMesh mesh = value_or_exit(pcavr::read_mesh(truth / "scene.ply"));
  mesh.normals.clear();
  mesh.colors.clear();
  for (const pcavr::ObjectEntry& object : recording.manifest.objects) {
    const auto poses =
        value_or_exit(pcavr::read_trajectory(truth / "objects" / (object.name + ".txt")));
    const pcavr::TriangleMesh part =
        pcavr::transformed(poses.poses().front().pose,
                           value_or_exit(pcavr::read_mesh(recording.folder / object.mesh)));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& t : part.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mesh;
}

void print_errors(const Input& input, const pcavr::TriangleMesh& mesh) {
  if (!input.truth_base) return;
  pcavr::Views views;
  views.camera = input.camera;
  for (std::size_t i = 0; i < input.fused.size(); i += 8)
    views.T_base_camera.push_back(input.fused[i].T_base_camera);
  pcavr::SurfaceErrorOptions options;
  options.sample_spacing = 0.008;
  const auto errors =
      pcavr::mesh_errors(*input.truth_base, mesh, views, options, pcavr::Parallelism::max());
  std::printf("         to the truth: mean %.3f mm, 95 %% %.3f mm, complete within 5 mm %.2f %%\n",
              1e3 * errors.accuracy.mean, 1e3 * errors.accuracy.p95,
              100.0 * errors.completeness_5mm);
}

Input read_input(const std::string& folder, const std::string& poses, std::size_t every) {
  const pcavr::Recording recording = value_or_exit(pcavr::read_recording(folder));
  const pcavr::Trajectory trajectory = value_or_exit(pcavr::read_trajectory(poses));
  Input input;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    Frame frame{value_or_exit(pcavr::decode_frame(recording, i)), {}};
    const auto pose = trajectory.at(frame.images.depth_stamp);
    if (!pose) continue;
    frame.T_base_camera = *pose;
    const int width = frame.images.depth.width();
    const int height = frame.images.depth.height();
    input.camera = pcavr::on_grid(*recording.manifest.camera, width, height);
    if (frame.images.color.width() != width)
      frame.images.color = pcavr::color_on_grid(frame.images.color, width, height);
    (i % every == every / 2 ? input.held_out : input.fused).push_back(std::move(frame));
  }
  input.truth_base = read_truth(recording);
  return input;
}

pcavr::TriangleMesh fuse(const Input& input, const pcavr::BuildOptions& options) {
  pcavr::TsdfOptions fusion = options.fusion;
  fusion.depth_noise = options.perception.depth_noise;
  pcavr::TsdfVolume volume(fusion);
  for (const Frame& frame : input.fused) {
    const pcavr::DepthImage depth = pcavr::filter_depth(frame.images.depth, input.camera,
                                                        fusion.depth_noise, options.parallelism);
    volume.integrate(depth, frame.images.color, {}, input.camera, frame.T_base_camera,
                     options.parallelism);
  }
  pcavr::TriangleMesh mesh = volume.extract_mesh(
      pcavr::surface_evidence(options, input.fused.size()), options.parallelism);
  pcavr::remove_small_components(mesh, options.min_island);
  return mesh;
}

#ifdef PCAVR_HAS_OPEN3D
pcavr::TriangleMesh fuse_by_open3d(const Input& input, const pcavr::BuildOptions& options) {
  const pcavr::CameraModel& camera = input.camera;
  const open3d::camera::PinholeCameraIntrinsic intrinsic(camera.width, camera.height, camera.fx,
                                                         camera.fy, camera.cx, camera.cy);
  open3d::pipelines::integration::ScalableTSDFVolume volume(
      options.fusion.voxel_size, options.fusion.truncation_voxels * options.fusion.voxel_size,
      open3d::pipelines::integration::TSDFVolumeColorType::RGB8);
  const auto max_depth = static_cast<float>(options.perception.depth_noise.max_depth);
  for (const Frame& frame : input.fused) {
    open3d::geometry::Image color;
    color.Prepare(camera.width, camera.height, 3, 1);
    std::memcpy(color.data_.data(), frame.images.color.pixels().data(), color.data_.size());
    open3d::geometry::Image depth;
    depth.Prepare(camera.width, camera.height, 1, 4);
    auto* to = reinterpret_cast<float*>(depth.data_.data());
    for (const float z : frame.images.depth.pixels()) *to++ = z <= max_depth ? z : 0.0F;
    volume.Integrate({color, depth}, intrinsic, frame.T_base_camera.inverse().matrix());
  }
  const auto found = volume.ExtractTriangleMesh();
  pcavr::TriangleMesh mesh;
  for (const Eigen::Vector3d& p : found->vertices_) mesh.vertices.push_back(p.cast<float>());
  for (const Eigen::Vector3i& t : found->triangles_) {
    mesh.triangles.push_back({static_cast<std::uint32_t>(t.x()), static_cast<std::uint32_t>(t.y()),
                              static_cast<std::uint32_t>(t.z())});
  }
  return mesh;
}
#endif

void print_distances(const char* what, const Input& input, const pcavr::DepthNoise& noise,
                     const pcavr::TriangleMesh& mesh) {
  const pcavr::SurfaceQuery surface(mesh);
  std::vector<double> distances;
  for (const Frame& frame : input.held_out) {
    for (int y = 0; y < input.camera.height; y += kPixelStride) {
      for (int x = 0; x < input.camera.width; x += kPixelStride) {
        const auto z = static_cast<double>(frame.images.depth(x, y));
        if (!(z >= noise.min_depth && z <= noise.max_depth)) continue;
        const Eigen::Vector3f p_base =
            (frame.T_base_camera * input.camera.unproject(Eigen::Vector2d(x, y), z)).cast<float>();
        const auto nearest = surface.closest(p_base, kMaxDistance);
        distances.push_back(
            static_cast<double>(nearest ? (p_base - nearest->point).norm() : kMaxDistance));
      }
    }
  }
  if (distances.empty()) fail("the held-out frames have no depth");
  std::sort(distances.begin(), distances.end());
  const auto share = [&](double limit) {
    const auto end = std::lower_bound(distances.begin(), distances.end(), limit);
    return 100.0 * static_cast<double>(end - distances.begin()) /
           static_cast<double>(distances.size());
  };
  std::printf(
      "%-8s %8zu triangles, median %.2f mm, within 5 mm %.1f %%, 10 mm %.1f %%, 20 mm %.1f %%, "
      "none in 100 mm %.1f %%\n",
      what, mesh.triangles.size(), 1e3 * distances[distances.size() / 2], share(0.005),
      share(0.010), share(0.020), 100.0 - share(0.0999));
}

/// The mesh rendered from the held-out poses against what was measured there: along the ray, so
/// that several surfaces behind one another count as the one in front.
void print_rendered(const Input& input, const pcavr::DepthNoise& noise,
                    const pcavr::TriangleMesh& mesh) {
  std::vector<double> errors;
  std::size_t measured_count = 0;
  const pcavr::SurfaceQuery surface(mesh);
  for (const Frame& frame : input.held_out) {
    const pcavr::DepthImage rendered =
        pcavr::render_depth(surface, input.camera, frame.T_base_camera, pcavr::Parallelism::max());
    for (int y = 0; y < input.camera.height; y += kPixelStride) {
      for (int x = 0; x < input.camera.width; x += kPixelStride) {
        const float measured = frame.images.depth(x, y);
        const auto z = static_cast<double>(measured);
        if (!(z >= noise.min_depth && z <= noise.max_depth)) continue;
        ++measured_count;
        if (rendered(x, y) > 0.0F)
          errors.push_back(std::abs(z - static_cast<double>(rendered(x, y))));
      }
    }
  }
  if (errors.empty()) fail("the mesh is in no held-out frame");
  std::sort(errors.begin(), errors.end());
  const auto share = [&](double limit) {
    const auto end = std::lower_bound(errors.begin(), errors.end(), limit);
    return 100.0 * static_cast<double>(end - errors.begin()) / static_cast<double>(measured_count);
  };
  std::printf(
      "         along the rays: median %.2f mm, within 5 mm %.1f %%, 10 mm %.1f %%, "
      "20 mm %.1f %%, 50 mm %.1f %%\n",
      1e3 * errors[errors.size() / 2], share(0.005), share(0.010), share(0.020), share(0.050));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fail(
        "usage: pcavr_bench_held_out RECORDING POSES "
        "[EVERY [open3d] [SECTION.KEY=VALUE ...] [-- ...]]");
  }
  const Input input = read_input(argv[1], argv[2], argc > 3 ? std::stoul(argv[3]) : 5);
  std::printf("%zu frames fused, %zu held out\n", input.fused.size(), input.held_out.size());
  for (int i = 4; i <= argc; ++i) {
    pcavr::BuildOptions options;
    [[maybe_unused]] bool with_open3d = false;
    std::string set;
    for (; i < argc && std::string(argv[i]) != "--"; ++i) {
      set += std::string(" ") + argv[i];
      if (std::string(argv[i]) == "open3d") {
        with_open3d = true;
      } else {
        std::vector<pcavr::OptionSection> sections = sections_of(options);
        sections.push_back(section_of(options.perception.depth_noise));
        set_option(sections, argv[i]);
      }
    }
    std::printf("options:%s\n", set.c_str());
    const pcavr::DepthNoise& noise = options.perception.depth_noise;
    const pcavr::TriangleMesh mesh = fuse(input, options);
    print_distances("pcavr", input, noise, mesh);
    print_rendered(input, noise, mesh);
    print_errors(input, mesh);
    std::fflush(stdout);
#ifdef PCAVR_HAS_OPEN3D
    if (with_open3d) {
      const pcavr::TriangleMesh theirs = fuse_by_open3d(input, options);
      print_distances("Open3D", input, noise, theirs);
      print_rendered(input, noise, theirs);
    }
#endif
    std::fflush(stdout);
  }
}
