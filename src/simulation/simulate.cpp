// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/recording/recording_writer.hpp"

#include "simulation/camera_path.hpp"
#include "simulation/color_sensor.hpp"
#include "simulation/depth_sensor.hpp"
#include "simulation/hashed_noise.hpp"
#include "simulation/layout.hpp"
#include "simulation/push.hpp"
#include "simulation/recording_files.hpp"
#include "simulation/renderer.hpp"

namespace pcavr {
namespace {

using namespace simulation;

constexpr double kDepthScale = 5000.0;  ///< image units in one metre, as TUM RGB-D has it

void check(const SimulationCase& simulation) {
  PCAVR_REQUIRE(simulation.duration > 0.0 && simulation.frame_rate > 0.0, simulation.duration,
                simulation.frame_rate);
  PCAVR_REQUIRE(simulation.width >= 8 && simulation.height >= 8, simulation.width,
                simulation.height);
  PCAVR_REQUIRE(simulation.movable_boxes >= 0 && simulation.clutter >= 0, simulation.movable_boxes,
                simulation.clutter);
  PCAVR_REQUIRE(simulation.base_tags >= 0 && simulation.base_tags <= 2, simulation.base_tags);
  PCAVR_REQUIRE(!simulation.with_moving_tool ||
                    (simulation.movable_boxes >= 1 && simulation.movable_boxes <= 2 &&
                     simulation.duration >= 3.0 * simulation.movable_boxes),
                simulation.movable_boxes, simulation.duration);
}

/// A camera as wide as the first Kinect's (62 degrees).
CameraModel camera_of(const SimulationCase& simulation) {
  const double focal_length = 525.0 * simulation.width / 640.0;
  return {.width = simulation.width,
          .height = simulation.height,
          .fx = focal_length,
          .fy = focal_length,
          .cx = 0.5 * (simulation.width - 1),
          .cy = 0.5 * (simulation.height - 1),
          .distortion = simulation.distortion};
}

/// At whole microseconds, as the lists have them, so that truth is exact at the stamps written.
std::vector<Stamp> frame_stamps(const SimulationCase& simulation) {
  std::vector<Stamp> stamps;
  const auto count = std::max(1L, std::lround(simulation.duration * simulation.frame_rate));
  for (long i = 0; i < count; ++i) {
    const auto microseconds = std::llround(1e6 * static_cast<double>(i) / simulation.frame_rate);
    stamps.push_back({microseconds * 1000});
  }
  return stamps;
}

struct Frame {
  ColorImage color;
  DepthImage depth;
};

/// Renders in batches: while one batch is cast, the one before is encoded and written, in order.
class FrameMaker {
 public:
  FrameMaker(const SimulationCase& simulation, std::uint64_t seed, const Truth& truth)
      : truth_(truth),
        seed_(seed),
        camera_(camera_of(simulation)),
        bodies_(truth.world),
        renderer_(truth.world, bodies_, camera_) {
    depth_sensor_.noise = simulation.depth_noise;
    color_sensor_.blur = simulation.corner_blur;
  }

  [[nodiscard]] Expected<void> write_all(RecordingWriter& writer, Parallelism parallelism,
                                         const Observer& observer) const {
    const std::size_t count = truth_.frames.size();
    const std::size_t batch = 4 * static_cast<std::size_t>(parallelism.threads);
    std::vector<Frame> finished;
    Expected<void> written;
    for (std::size_t first = 0; first < count + batch && written; first += batch) {
      std::vector<Frame> coming(first < count ? std::min(batch, count - first) : 0);
      parallel_for(parallelism, coming.size() + 1, 1, [&](std::size_t item, std::size_t) {
        if (item > 0) {
          coming[item - 1] = make(first + item - 1);
          return;
        }
        for (std::size_t i = 0; i < finished.size() && written; ++i) {
          const Stamp stamp = truth_.frames[first - batch + i];
          written = writer.add_frame(stamp, finished[i].color, stamp, finished[i].depth);
        }
      });
      finished = std::move(coming);
      observer.on_progress("rendering", std::min(first, count), count);
    }
    return written;
  }

 private:
  [[nodiscard]] Frame make(std::size_t index) const {
    const double t = truth_.frames[index].seconds();
    const std::vector<Pose> poses = body_poses(truth_.world, truth_.push, t);
    const IdealFrame ideal = renderer_.render(truth_.camera.T_base_camera(t), poses);
    return {.color = expose(color_sensor_, ideal.radiance, hash(seed_, 100, index)),
            .depth = measure_depth(depth_sensor_, camera_, ideal, hash(seed_, 101, index))};
  }

  const Truth& truth_;
  std::uint64_t seed_;
  CameraModel camera_;
  RayBodies bodies_;
  Renderer renderer_;
  DepthSensor depth_sensor_;
  ColorSensor color_sensor_;
};

}  // namespace

const std::vector<SimulationCase>& simulation_cases() {
  static const std::vector<SimulationCase> cases = [] {
    SimulationCase tabletop;
    tabletop.name = "tabletop";
    tabletop.description = "a hand-held camera around a table with clutter and a tagged box";
    tabletop.duration = 3.0;
    SimulationCase push;
    push.name = "push";
    push.description = "a fixed camera; a tool pushes two tagged boxes until they slide and stop";
    push.is_camera_fixed = true;
    push.duration = 8.0;
    push.frame_rate = 15.0;
    push.movable_boxes = 2;
    push.clutter = 5;
    push.with_moving_tool = true;
    SimulationCase room;
    room.name = "room";
    room.description = "a hand-held camera in a corner of a room; two base tags, nothing movable";
    room.movable_boxes = 0;
    room.base_tags = 2;
    room.clutter = 10;
    return std::vector<SimulationCase>{tabletop, push, room};
  }();
  return cases;
}

Expected<void> simulate(const SimulationCase& simulation, std::uint64_t seed,
                        const std::filesystem::path& folder, Parallelism parallelism,
                        const Observer& observer) {
  check(simulation);
  const auto world = make_world(simulation, seed, observer);
  if (!world) return world.error();
  const CameraPath camera(simulation, seed);
  const PushRun push = simulate_push(*world, simulation.duration, seed);
  const Truth truth{.world = *world,
                    .camera = camera,
                    .push = push,
                    .frames = frame_stamps(simulation),
                    .duration = simulation.duration};
  Manifest manifest = manifest_of(*world);
  manifest.camera = camera_of(simulation);
  manifest.depth_scale = kDepthScale;
  auto written = write_truth(folder, truth);
  if (!written) return written;
  RecordingWriter writer(folder, manifest);
  for (std::size_t i = 0; i < world->boxes.size() && written; ++i) {
    written = writer.write_object_mesh(manifest.objects[i].mesh, world->bodies[1 + i].surface.mesh);
  }
  if (written) written = write_tool_streams(writer, truth, seed);
  if (written) {
    written = FrameMaker(simulation, seed, truth).write_all(writer, parallelism, observer);
  }
  if (!written) return written;
  return writer.finish();
}

}  // namespace pcavr
