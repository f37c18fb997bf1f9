// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// The stages of reconstruction on an ideal scene: a sphere in front of a wall, 640 x 480. Measures
// frames in which nothing new comes into view; for whole recordings see against_open3d.
#include <benchmark/benchmark.h>

#include "pcavr/base/model/mesh_simplification.hpp"
#include "pcavr/perception/reconstruction/depth_filter.hpp"
#include "pcavr/perception/reconstruction/mesh_cleanup.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

#include "reconstruction/depth_scenes.hpp"

namespace {

using pcavr::Parallelism;

struct Scene {
  pcavr::CameraModel camera;
  pcavr::DepthImage depth;
  pcavr::ColorImage color;

  Scene() {
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 525.0;
    camera.cx = 319.5;
    camera.cy = 239.5;
    const auto surface = pcavr::test::nearest_of(
        pcavr::test::sphere({0.0, 0.0, 1.2}, 0.3),
        pcavr::test::plane(Eigen::Vector3d(0.3, 0.2, 1.0).normalized(), 1.6));
    depth = pcavr::test::depth_of(surface, camera, pcavr::Pose());
    color = pcavr::ColorImage(640, 480, pcavr::Rgb8{180, 160, 140});
  }
};

const Scene& scene() {
  static const Scene the_scene;
  return the_scene;
}

double voxel_size(const benchmark::State& state) {
  return static_cast<double>(state.range(0)) * 0.001;
}

void FilterDepth(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        pcavr::filter_depth(scene().depth, scene().camera, {}, Parallelism{1}));
  }
}
BENCHMARK(FilterDepth)->Unit(benchmark::kMillisecond);

pcavr::TsdfVolume fused(double voxel_size, int frames) {
  pcavr::TsdfOptions options;
  options.voxel_size = voxel_size;
  pcavr::TsdfVolume volume(options);
  for (int i = 0; i < frames; ++i) {
    volume.integrate(scene().depth, scene().color, {}, scene().camera, pcavr::Pose(), {1});
  }
  return volume;
}

void Integrate(benchmark::State& state) {
  pcavr::TsdfVolume volume = fused(voxel_size(state), 1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(volume.integrate(scene().depth, scene().color, {}, scene().camera,
                                              pcavr::Pose(), Parallelism{1}));
  }
}
BENCHMARK(Integrate)->Arg(10)->Arg(5)->Unit(benchmark::kMillisecond);

void ExtractMesh(benchmark::State& state) {
  const pcavr::TsdfVolume volume = fused(voxel_size(state), 3);
  std::size_t triangles = 0;
  for (auto _ : state) {
    triangles += volume.extract_mesh(1.0, Parallelism{1}).triangles.size();
  }
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(triangles), benchmark::Counter::kIsRate);
}
BENCHMARK(ExtractMesh)->Arg(10)->Arg(5)->Unit(benchmark::kMillisecond);

void SimplifyToATenth(benchmark::State& state) {
  const pcavr::TriangleMesh mesh = fused(voxel_size(state), 3).extract_mesh(1.0, Parallelism{1});
  for (auto _ : state) {
    benchmark::DoNotOptimize(pcavr::simplified(mesh, mesh.triangles.size() / 10, 0.01));
  }
}
BENCHMARK(SimplifyToATenth)->Arg(10)->Arg(5)->Unit(benchmark::kMillisecond);

}  // namespace
