// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/geometry/depth_grid.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "simulation/arm_case.hpp"
#include "simulation/camera_path.hpp"
#include "simulation/color_sensor.hpp"
#include "simulation/depth_sensor.hpp"
#include "simulation/hashed_noise.hpp"
#include "simulation/layout.hpp"
#include "simulation/recording_files.hpp"
#include "simulation/renderer.hpp"

namespace pcavr {
namespace {

using namespace simulation;

constexpr double kExposureTime = 1.0 / 60.0;  ///< [s]
constexpr double kDepthScale = 5000.0;        ///< image units in one metre, as in TUM RGB-D

void check(const SimulationCase& simulation) {
  PCAVR_REQUIRE(simulation.duration > 0.0 && simulation.frame_rate > 0.0, simulation.duration,
                simulation.frame_rate);
  const CameraModel camera = simulated_camera(simulation);
  PCAVR_REQUIRE(camera.width >= 8 && camera.height >= 8, camera.width, camera.height);
  PCAVR_REQUIRE(simulation.movable_boxes >= 0 && simulation.clutter >= 0, simulation.movable_boxes,
                simulation.clutter);
  PCAVR_REQUIRE(simulation.push_duration >= 0.0, simulation.push_duration);
  // Depth on the colour image's grid, or on one that is coarser by the same factor in x and y.
  PCAVR_REQUIRE(simulation.depth_width <= camera.width &&
                    std::int64_t{simulation.depth_width} * camera.height ==
                        std::int64_t{simulation.depth_height} * camera.width,
                simulation.depth_width, simulation.depth_height);
  PCAVR_REQUIRE(simulation.base_tags >= 0 && simulation.base_tags <= 2, simulation.base_tags);
  PCAVR_REQUIRE(simulation.with_images || simulation.task != ToolTask::none);
  PCAVR_REQUIRE(!simulation.is_immovable || simulation.task == ToolTask::press ||
                simulation.task == ToolTask::impact);
}

CameraModel depth_camera_of(const SimulationCase& simulation) {
  const CameraModel color = simulated_camera(simulation);
  if (simulation.depth_width == 0) return color;
  return on_grid(color, simulation.depth_width, simulation.depth_height);
}

/// Stamps in whole microseconds, as in the image lists, so that truth is exact at the written
/// stamps.
std::vector<Stamp> frame_stamps(double duration, double frame_rate) {
  std::vector<Stamp> stamps;
  const auto count = std::max(1L, std::lround(duration * frame_rate));
  for (long i = 0; i < count; ++i) {
    const auto microseconds = std::llround(1e6 * static_cast<double>(i) / frame_rate);
    stamps.push_back({microseconds * 1000});
  }
  return stamps;
}

struct Frame {
  ColorImage color;
  DepthImage depth;
};

/// Renders in batches: while one batch is rendered, the previous one is encoded and written in
/// order (pipelining).
class FrameRenderer {
 public:
  FrameRenderer(const SimulationCase& simulation, std::uint64_t seed, const Truth& truth)
      : truth_(truth),
        seed_(seed),
        exposure_time_(simulation.is_wide ? kExposureTime : 0.0),
        camera_(simulated_camera(simulation)),
        depth_camera_(depth_camera_of(simulation)),
        bodies_(truth.world),
        renderer_(truth.world, bodies_, camera_),
        depth_renderer_(truth.world, bodies_, depth_camera_) {
    depth_sensor_.noise = simulation.depth_noise;
    color_sensor_.blur = simulation.corner_blur;
  }

  [[nodiscard]] Expected<void> write_all(RecordingWriter& writer, Parallelism parallelism,
                                         const Observer& observer) const {
    const std::size_t count = truth_.frames.size();
    const std::size_t batch = 4 * static_cast<std::size_t>(parallelism.threads);
    std::vector<Frame> previous;
    Expected<void> written;
    for (std::size_t first = 0; first < count + batch && written; first += batch) {
      std::vector<Frame> current(first < count ? std::min(batch, count - first) : 0);
      parallel_for(parallelism, current.size() + 1, 1, [&](std::size_t item, std::size_t) {
        if (item > 0) {
          current[item - 1] = make(first + item - 1);
          return;
        }
        for (std::size_t i = 0; i < previous.size() && written; ++i) {
          const Stamp stamp = truth_.frames[first - batch + i];
          written = writer.add_frame(stamp, previous[i].color, stamp, previous[i].depth);
        }
      });
      previous = std::move(current);
      observer.on_progress("rendering", std::min(first, count), count);
    }
    return written;
  }

 private:
  [[nodiscard]] Frame make(std::size_t index) const {
    const double t = truth_.frames[index].seconds();
    const std::uint64_t color_seed = hash(seed_, 100, index);
    const std::uint64_t depth_seed = hash(seed_, 101, index);
    IdealFrame ideal = render(renderer_, t);
    if (exposure_time_ > 0.0) blur(t, ideal.radiance);
    ColorImage color = expose(color_sensor_, ideal.radiance, color_seed);
    if (depth_camera_.width != camera_.width) ideal = render(depth_renderer_, t);
    return {.color = std::move(color),
            .depth = measure_depth(depth_sensor_, depth_camera_, ideal, depth_seed)};
  }

  [[nodiscard]] IdealFrame render(const Renderer& renderer, double t) const {
    return renderer.render(truth_.camera.T_base_camera(t),
                           body_poses(truth_.world, truth_.plant, truth_.run, t));
  }

  /// Averages the radiance over the exposure, of which `radiance` is the middle.
  void blur(double t, Image<Eigen::Vector3f>& radiance) const {
    constexpr int kInstants = 4;  // beside the middle: a tag at 60 mm/s moves by 0.2 px between two
    for (int i = 0; i < kInstants; ++i) {
      const double share = (i + 0.5) / kInstants - 0.5;
      const IdealFrame other = render(renderer_, std::max(0.0, t + share * exposure_time_));
      for (std::size_t p = 0; p < radiance.pixels().size(); ++p) {
        radiance.pixels()[p] += other.radiance.pixels()[p];
      }
    }
    for (Eigen::Vector3f& pixel : radiance.pixels()) pixel /= kInstants + 1;
  }

  const Truth& truth_;
  std::uint64_t seed_;
  double exposure_time_;  ///< [s]; 0: an instant
  CameraModel camera_;
  CameraModel depth_camera_;
  RayBodies bodies_;
  Renderer renderer_;
  Renderer depth_renderer_;
  DepthSensor depth_sensor_;
  ColorSensor color_sensor_;
};

SimulationCase with_tool(const std::string& name, ToolTask task, const std::string& description) {
  SimulationCase simulation;
  simulation.name = name;
  simulation.description = description;
  simulation.task = task;
  simulation.is_camera_fixed = true;
  simulation.frame_rate = 12.0;
  simulation.movable_boxes = 0;
  simulation.clutter = 4;
  return simulation;
}

SimulationCase with_arm(SimulationCase simulation) {
  simulation.has_arm = true;
  return simulation;
}

PushOptions push_options(const SimulationCase& simulation) {
  PushOptions push;
  if (simulation.task != ToolTask::push) return push;
  if (simulation.movable_boxes > 0) push.boxes = simulation.movable_boxes;
  push.duration = simulation.push_duration;
  return push;
}

Manifest manifest_for(const SimulationCase& simulation, const World& world,
                      const PlantCase& plant) {
  Manifest manifest = manifest_of(world);
  if (plant.tool.arm) {
    manifest.robot = RobotEntry{
        .urdf = "robot.urdf", .T_base_robot = plant.tool.arm->T_base_robot, .tip = kArmTip};
  }
  if (simulation.with_images) {
    manifest.camera = simulated_camera(simulation);
    manifest.depth_scale = kDepthScale;
  } else {
    manifest.markers.clear();
  }
  for (std::size_t i = 0; i < manifest.objects.size(); ++i) {
    // A body that does not move is not tracked.
    if (!simulation.with_images || !world.boxes[i].is_movable) {
      manifest.objects[i].T_base_object = world.boxes[i].T_base_object;
    }
    if (!simulation.with_mass) manifest.objects[i].mass.reset();
  }
  return manifest;
}

/// The tool's poses, and the arm that they are computed from.
Expected<void> write_motion(RecordingWriter& writer, const PlantCase& plant, const PlantRun& run,
                            std::uint64_t seed) {
  if (!plant.tool.arm) return writer.write_tool(measured_tool(run, seed));
  const JointLog log = measured_joints(run, *plant.tool.arm, seed);
  Expected<void> written = writer.write_robot(arm_description(plant.tool.radius));
  if (written) written = writer.write_joints(log);
  if (written) written = writer.write_tool(measured_tool(log, *plant.tool.arm));
  return written;
}

}  // namespace

CameraModel simulated_camera(const SimulationCase& simulation) {
  if (simulation.camera) return *simulation.camera;
  const double focal_length = 525.0 * simulation.width / 640.0;
  return {.width = simulation.width,
          .height = simulation.height,
          .fx = focal_length,
          .fy = focal_length,
          .cx = 0.5 * (simulation.width - 1),
          .cy = 0.5 * (simulation.height - 1)};
}

const std::vector<SimulationCase>& simulation_cases() {
  static const std::vector<SimulationCase> cases = [] {
    SimulationCase tabletop;
    tabletop.name = "tabletop";
    tabletop.description = "a hand-held camera around a table with clutter and a tagged box";
    tabletop.duration = 3.0;
    SimulationCase room;
    room.name = "room";
    room.description =
        "a hand-held camera in a corner of a room; two base tags, no movable objects";
    room.movable_boxes = 0;
    room.base_tags = 2;
    room.clutter = 10;
    SimulationCase paper = with_tool(
        "paper", ToolTask::paper, "a foam-faced and a rubber-faced box: each probed, then pushed");
    paper.frame_rate = 10.0;
    return std::vector<SimulationCase>{
        tabletop,
        room,
        with_tool("push", ToolTask::push,
                  "a tool pushes two tagged boxes in turn until they slide and stop"),
        with_tool("probe", ToolTask::probe,
                  "presses, ten pushes to breakaway and a modulated slide, for identification"),
        with_tool("press", ToolTask::press,
                  "presses along z at seven speeds, on each of two boxes"),
        with_tool("slot", ToolTask::slot, "along both walls of the slot in a block"),
        with_tool("hole", ToolTask::hole,
                  "presses and pushes of a block, then along z into its oblique hole"),
        with_tool("turn", ToolTask::turn, "off-centre pushes, which turn two boxes"),
        paper,
        with_tool("soft", ToolTask::soft,
                  "presses along z at five speeds, 15 mm deep, on each of two soft boxes"),
        with_tool("corner", ToolTask::corner,
                  "pushes close to the corners of two boxes that are softer than the tip is large"),
        with_tool("impact", ToolTask::impact,
                  "slow presses, then impacts of 2 to 80 ms, on each of two boxes"),
        with_arm(with_tool("arm-press", ToolTask::press,
                           "as press, by a six-axis arm with its own dynamics; with joints.csv")),
        with_arm(with_tool("arm-slot", ToolTask::slot, "as slot, by the arm")),
        with_arm(with_tool("arm-ball", ToolTask::soft, "as soft, by the arm"))};
  }();
  return cases;
}

Expected<void> simulate(const SimulationCase& simulation, std::uint64_t seed,
                        const std::filesystem::path& folder, Parallelism parallelism,
                        const Observer& observer) {
  check(simulation);
  const PushOptions push = push_options(simulation);
  const PlantVariety variety = simulation.is_wide ? PlantVariety::wide : PlantVariety::plain;
  PlantCase plant = make_plant_case(simulation.task, seed, push, variety);
  const SensorFaults faults =
      simulation.is_wide ? with_workshop_faults(simulation.faults, seed) : simulation.faults;
  if (simulation.is_immovable) {
    for (PlantBody& body : plant.bodies) body.is_movable = false;
  }
  const bool has_task = simulation.task != ToolTask::none;
  if (simulation.has_arm) add_arm(plant, seed);
  PlantOptions plant_options{.substeps = plant.substeps};
  if (push.duration > 0.0) plant_options.max_duration = push.duration;
  const PlantRun run =
      has_task ? run_plant(plant.bodies, plant.tool, plant.moves, plant_options) : PlantRun();
  const auto world = make_world(simulation, plant, seed, observer);
  if (!world) return world.error();
  const CameraPath camera(simulation, seed);
  Truth truth{.world = *world, .camera = camera, .plant = plant, .run = run, .frames = {}};
  if (simulation.with_images) {
    truth.frames =
        frame_stamps(has_task ? run.duration() : simulation.duration, simulation.frame_rate);
  }
  const Manifest manifest = manifest_for(simulation, *world, plant);
  auto written = write_truth(folder, truth);
  if (!written) return written;
  RecordingWriter writer(folder, manifest);
  for (std::size_t i = 0; i < world->boxes.size() && written; ++i) {
    written = writer.write_object_mesh(manifest.objects[i].mesh, world->bodies[1 + i].surface.mesh);
  }
  if (written && has_task) written = write_motion(writer, plant, run, seed);
  if (written && has_task) {
    written = writer.write_wrench(measured_wrench(run, seed, faults));
  }
  if (written && simulation.with_images) {
    written = FrameRenderer(simulation, seed, truth).write_all(writer, parallelism, observer);
  }
  if (written && !simulation.with_images) {
    written = write_tracking(folder, truth, seed, faults);
  }
  if (!written) return written;
  return writer.finish();
}

}  // namespace pcavr
