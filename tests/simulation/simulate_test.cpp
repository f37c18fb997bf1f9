// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/recordings/recording/frame_reader.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

SimulationCase case_named(const std::string& name) {
  for (const SimulationCase& known : simulation_cases()) {
    if (known.name == name) return known;
  }
  throw std::runtime_error("no case " + name);
}

double duration_of(const SimulationCase& simulation) {
  if (simulation.task == ToolTask::none) return simulation.duration;
  const PlantCase plant = make_plant_case(simulation.task, 1);
  return run_plant(plant.bodies, plant.tool, plant.moves).duration();
}

/// A few small frames of a case.
SimulationCase tiny(const std::string& name) {
  SimulationCase simulation = case_named(name);
  simulation.width = 96;
  simulation.height = 72;
  simulation.frame_rate = 6.0 / duration_of(simulation);
  return simulation;
}

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[fs::relative(entry.path(), folder).string()] = read_file(entry.path()).value();
  }
  return files;
}

Recording simulated(const SimulationCase& simulation, std::uint64_t seed, const fs::path& folder) {
  EXPECT_TRUE(simulate(simulation, seed, folder, {2}));
  return read_recording(folder).value();
}

TEST(Simulate, GivesTheSameBytesAtAnyNumberOfThreads) {
  for (const char* name : {"tabletop", "push"}) {
    const TemporaryFolder one;
    ASSERT_TRUE(simulate(tiny(name), 3, one.path(), {1}));
    const auto expected = files_in(one.path());
    EXPECT_GE(expected.size(), 17U);  // 6 frames are 12 images
    for (const int threads : {2, 4}) {
      const TemporaryFolder other;
      ASSERT_TRUE(simulate(tiny(name), 3, other.path(), {threads}));
      EXPECT_EQ(files_in(other.path()), expected) << name << ", " << threads << " threads";
    }
  }
}

TEST(Simulate, AnotherSeedGivesAnotherRecording) {
  const TemporaryFolder a;
  const TemporaryFolder b;
  ASSERT_TRUE(simulate(tiny("tabletop"), 1, a.path(), {1}));
  ASSERT_TRUE(simulate(tiny("tabletop"), 2, b.path(), {1}));
  const auto files_a = files_in(a.path());
  const auto files_b = files_in(b.path());
  for (const char* file : {"truth/camera.txt", "truth/scene.ply", "truth/objects/box.txt",
                           "depth/0.500000.png", "rgb/0.500000.jpg"}) {
    ASSERT_TRUE(files_a.contains(file)) << file;
    EXPECT_NE(files_a.at(file), files_b.at(file)) << file;
  }
}

class SimulateCase : public testing::TestWithParam<SimulationCase> {};

TEST_P(SimulateCase, IsARecordingThatTheReaderAccepts) {
  const SimulationCase& known = GetParam();
  const TemporaryFolder folder;
  const Recording recording = simulated(tiny(known.name), 1, folder.path());
  EXPECT_EQ(recording.frames.size(), 6U);
  EXPECT_TRUE(recording.groundtruth.empty());
  const bool has_task = known.task != ToolTask::none;
  EXPECT_EQ(recording.tool.empty(), !has_task);
  EXPECT_EQ(recording.wrench.empty(), !has_task);
  EXPECT_EQ(base_placements(recording.manifest).size(), static_cast<std::size_t>(known.base_tags));
  const Trajectory camera = read_trajectory(folder.path() / "truth/camera.txt").value();
  ASSERT_EQ(camera.size(), 6U);
  for (const FrameFiles& frame : recording.frames) {
    EXPECT_TRUE(camera.at(frame.depth_stamp));
    for (const ObjectEntry& object : recording.manifest.objects) {
      const auto path = folder.path() / "truth/objects" / (object.name + ".txt");
      EXPECT_TRUE(read_trajectory(path).value().at(frame.depth_stamp)) << path;
    }
  }
}

/// Probing and turning take a minute each and write no other files: plant_case_test.cpp has them.
std::vector<SimulationCase> cases_of_seconds() {
  std::vector<SimulationCase> cases;
  for (const SimulationCase& known : simulation_cases()) {
    const bool is_long = known.task == ToolTask::probe || known.task == ToolTask::turn;
    // One of the arm's: the others write no other files.
    if (!is_long && (!known.has_arm || known.task == ToolTask::slot)) cases.push_back(known);
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Known, SimulateCase, testing::ValuesIn(cases_of_seconds()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Simulate, WithoutImagesTheManifestHasInitialPosesAndATrackerFollowsTheObjects) {
  SimulationCase simulation = case_named("push");
  simulation.with_images = false;
  simulation.with_mass = false;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 2, folder.path());
  EXPECT_FALSE(recording.manifest.camera);
  EXPECT_TRUE(recording.frames.empty());
  EXPECT_TRUE(recording.manifest.markers.empty());
  ASSERT_EQ(recording.manifest.objects.size(), 2U);
  for (const ObjectEntry& object : recording.manifest.objects) {
    ASSERT_TRUE(object.T_base_object) << object.name;
    EXPECT_FALSE(object.mass) << object.name;
    const Trajectory truth =
        read_trajectory(folder.path() / "truth/objects" / (object.name + ".txt")).value();
    EXPECT_LT(translation_distance(*object.T_base_object, truth.poses().front().pose), 1e-9);
    const fs::path tracked = folder.path() / "tracked/objects" / object.name;
    EXPECT_TRUE(fs::exists(tracked / "tracking.csv"));
    const Trajectory followed = read_trajectory(tracked / "tracked.txt").value();
    EXPECT_GT(followed.size(), 200U);
    for (const TimedPose& seen : followed.poses()) {
      const auto exact = truth.at(seen.stamp);
      ASSERT_TRUE(exact);
      // Outliers reach a millimetre and a little more.
      EXPECT_LT(translation_distance(*exact, seen.pose), 0.003);
    }
  }
  EXPECT_FALSE(fs::exists(folder.path() / "truth/camera.txt"));
}

TEST(Simulate, PushHasTheGivenDurationAndNumberOfBoxes) {
  SimulationCase simulation = case_named("push");
  simulation.with_images = false;
  simulation.movable_boxes = 20;
  simulation.push_duration = 12.0;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 2, folder.path());
  ASSERT_EQ(recording.manifest.objects.size(), 20U);
  EXPECT_NEAR(recording.tool.poses().back().stamp.seconds(), 12.0, 0.01);
  int pushed = 0;
  std::vector<Trajectory> truth;
  for (const ObjectEntry& object : recording.manifest.objects) {
    truth.push_back(
        read_trajectory(folder.path() / "truth/objects" / (object.name + ".txt")).value());
    const auto& poses = truth.back().poses();
    if (translation_distance(poses.front().pose, poses.back().pose) > 0.005) ++pushed;
    EXPECT_TRUE(fs::exists(folder.path() / "tracked/objects" / object.name / "tracked.txt"));
  }
  EXPECT_GE(pushed, 2);
  EXPECT_LE(pushed, 10);  // the others rest
}

/// Whether the footprints of two upright boxes overlap [separating axis theorem].
bool overlap(const Pose& T_base_a, const Eigen::Vector3d& half_a, const Pose& T_base_b,
             const Eigen::Vector3d& half_b) {
  const auto is_apart = [](const Pose& T_base_1, const Eigen::Vector3d& half_1,
                           const Pose& T_base_2, const Eigen::Vector3d& half_2) {
    const Pose T_1_2 = T_base_1.inverse() * T_base_2;
    const Eigen::Matrix3d R = T_1_2.rotation_matrix().cwiseAbs();
    const Eigen::Vector3d reach = half_1 + R * half_2;
    return std::abs(T_1_2.translation().x()) > reach.x() ||
           std::abs(T_1_2.translation().y()) > reach.y();
  };
  return !is_apart(T_base_a, half_a, T_base_b, half_b) &&
         !is_apart(T_base_b, half_b, T_base_a, half_a);
}

TEST(Simulate, ManyBoxesPushedBackAndForthNeverOverlap) {
  // Long enough for every box to be pushed and most to be pushed back.
  const PushOptions options{.boxes = 20, .duration = 150.0};
  const PlantCase plant = make_plant_case(ToolTask::push, 3, options);
  PlantOptions coarse_options;
  coarse_options.substeps = 8;  // coarser than recordings: positions matter here, not forces
  coarse_options.max_duration = options.duration;
  const PlantRun run = run_plant(plant.bodies, plant.tool, plant.moves, coarse_options);
  EXPECT_NEAR(run.duration(), 150.0, 1e-9);
  for (double t = 0.0; t <= 150.0; t += 1.0) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < plant.bodies.size(); ++i) {
      poses.push_back(T_base_object_at(run, plant.bodies[i], i, t));
    }
    for (std::size_t a = 0; a < poses.size(); ++a) {
      for (std::size_t b = a + 1; b < poses.size(); ++b) {
        EXPECT_FALSE(overlap(poses[a], plant.bodies[a].parts[0].half_extents, poses[b],
                             plant.bodies[b].parts[0].half_extents))
            << a << " and " << b << " at " << t;
      }
    }
  }
}

TEST(Simulate, ManyBoxesHaveUniqueTags) {
  SimulationCase simulation = tiny("tabletop");
  simulation.movable_boxes = 20;
  simulation.duration = 0.5;
  simulation.frame_rate = 8.0;
  const TemporaryFolder folder;
  const Recording recording = simulated(simulation, 1, folder.path());
  EXPECT_EQ(recording.frames.size(), 4U);
  EXPECT_EQ(recording.manifest.objects.size(), 20U);
  std::set<MarkerId> ids;
  for (const MarkerEntry& marker : recording.manifest.markers) ids.insert(marker.id);
  EXPECT_EQ(ids.size(), 41U);  // two on each box, one on the table
}

/// Mean magnitude of the differences of neighbours in a row, of the green channel.
double sharpness(const ColorImage& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 1; x < image.width(); ++x) sum += std::abs(image(x, y).g - image(x - 1, y).g);
  }
  return sum / (image.height() * (image.width() - 1));
}

TEST(Simulate, WideImagesBlurWhatMovesAndNothingElse) {
  double ratios[2];
  for (const int is_moving : {0, 1}) {
    SimulationCase simulation = tiny(is_moving ? "tabletop" : "push");
    simulation.width = 320;
    simulation.height = 240;
    const TemporaryFolder sharp, blurred;
    const Recording plain = simulated(simulation, 3, sharp.path());
    simulation.is_wide = true;
    const Recording wide = simulated(simulation, 3, blurred.path());
    // The first frame of a push shows a fixed camera's view of bodies and a tool at rest.
    const std::size_t frame = is_moving ? 3 : 0;
    const RgbdFrame before = decode_frame(plain, frame).value();
    const RgbdFrame after = decode_frame(wide, frame).value();
    EXPECT_TRUE(std::ranges::equal(before.depth.pixels(), after.depth.pixels()));
    ratios[is_moving] = sharpness(after.color) / sharpness(before.color);
  }
  EXPECT_NEAR(ratios[0], 1.0, 0.01);
  EXPECT_LT(ratios[1], 0.993);  // a slow hand: less than a pixel in the exposure
}

TEST(Simulate, DepthImagesMayBeSmallerThanColour) {
  SimulationCase simulation = tiny("tabletop");
  const TemporaryFolder same;
  const Recording full = simulated(simulation, 1, same.path());
  simulation.depth_width = 48;
  simulation.depth_height = 36;
  const TemporaryFolder smaller;
  const Recording recording = simulated(simulation, 1, smaller.path());
  EXPECT_EQ(recording.manifest.camera->width, 96);
  const RgbdFrame fine = decode_frame(full, 2).value();
  const RgbdFrame coarse = decode_frame(recording, 2).value();
  EXPECT_TRUE(std::ranges::equal(fine.color.pixels(), coarse.color.pixels()));
  ASSERT_EQ(coarse.depth.width(), 48);
  int compared = 0;
  int agreeing = 0;
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 48; ++x) {
      const float a = fine.depth(2 * x, 2 * y);
      const float b = fine.depth(2 * x + 1, 2 * y + 1);
      const float z = coarse.depth(x, y);
      if (a <= 0.0F || b <= 0.0F || z <= 0.0F || std::abs(a - b) > 0.02F) continue;
      ++compared;
      // Noise of some 3 mm in each, and steps of up to 10 mm.
      if (std::abs(z - 0.5F * (a + b)) < 0.04F) ++agreeing;
    }
  }
  EXPECT_GT(compared, 500);
  // Dropouts at edges, and outliers in one pixel of a thousand.
  EXPECT_GT(agreeing, 0.95 * compared);
}

TEST(Simulate, TruthOfATaskIsAParameterFile) {
  SimulationCase simulation = case_named("paper");
  simulation.with_images = false;
  const TemporaryFolder folder;
  ASSERT_TRUE(simulate(simulation, 1, folder.path(), {1}));
  const ParameterTable truth = read_parameters(folder.path() / "truth/parameters.yaml").value();
  EXPECT_EQ(truth.at("fp_box").mass->value, 3.0);
  EXPECT_EQ(truth.at("fp_box").limiting_static_friction->value, 9.57);
  EXPECT_EQ(truth.at("r_box").mass->value, 3.5);
  EXPECT_EQ(truth.at("r_box").limiting_static_friction->value, 40.62);
  EXPECT_TRUE(truth.at("r_box").contact_stiffness && truth.at("r_box").friction_radius);
}

/// Distances of a frame's points from the true surfaces, sorted, in standard deviations of the
/// depth noise.
std::vector<double> surface_errors(const Recording& recording, const SimulationCase& simulation,
                                   std::size_t index) {
  const fs::path folder = recording.folder;
  const SurfaceQuery scene(read_mesh(folder / "truth/scene.ply").value());
  const SurfaceQuery box(read_mesh(folder / "objects/box.obj").value());
  const RgbdFrame frame = decode_frame(recording, index).value();
  const Pose T_base_camera =
      *read_trajectory(folder / "truth/camera.txt").value().at(frame.depth_stamp);
  const Pose T_base_box =
      *read_trajectory(folder / "truth/objects/box.txt").value().at(frame.depth_stamp);
  std::vector<double> errors;
  for (int y = 0; y < frame.depth.height(); ++y) {
    for (int x = 0; x < frame.depth.width(); ++x) {
      const double z = frame.depth(x, y);
      if (z <= 0.0) continue;
      const Eigen::Vector3d p_base =
          T_base_camera * recording.manifest.camera->unproject(Eigen::Vector2d(x, y), z);
      const Eigen::Vector3d p_box = T_base_box.inverse() * p_base;
      float distance = 10.0F;
      if (const auto hit = scene.closest(p_base.cast<float>(), distance)) distance = hit->distance;
      if (const auto hit = box.closest(p_box.cast<float>(), distance)) distance = hit->distance;
      const double step = z * z / (580.0 * 0.075 * 8.0);
      errors.push_back(distance / std::hypot(simulation.depth_noise.depth_std(z), step / 3.46));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(Simulate, DepthImagesLieOnTheTrueSurfaces) {
  SimulationCase simulation = tiny("tabletop");
  simulation.width = 160;
  simulation.height = 120;
  for (const bool is_distorted : {false, true}) {
    if (is_distorted) {
      simulation.camera = simulated_camera(simulation);
      simulation.camera->distortion = {0.12, -0.25, 0.001, -0.0005, 0.0};
    }
    const TemporaryFolder folder;
    const Recording recording = simulated(simulation, 4, folder.path());
    const std::vector<double> errors = surface_errors(recording, simulation, 3);
    ASSERT_GT(errors.size(), 15000U);
    // A point is nearer to the surface than it is off along the ray, so the median lies below that
    // of a normal's magnitude (0.67) by the cosine of the incidence.
    EXPECT_GT(errors[errors.size() / 2], 0.3);
    EXPECT_LT(errors[errors.size() / 2], 0.7);
    // Only outliers and shifted edges are beyond 5 sigma.
    EXPECT_LT(errors[errors.size() * 99 / 100], 5.0);
  }
}

/// Distances of detected from projected corners over some frames, sorted [px].
std::vector<double> corner_errors(const Recording& recording) {
  const fs::path truth = recording.folder / "truth";
  const Trajectory camera = read_trajectory(truth / "camera.txt").value();
  TagDetectorOptions options;
  options.decimation = 1;
  auto detector = TagDetector::create({"tag36h11"}, options).value();
  std::vector<double> errors;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const RgbdFrame frame = decode_frame(recording, i).value();
    const Pose T_camera_base = camera.at(frame.color_stamp)->inverse();
    for (const TagDetection& detection : detector.detect(to_gray(frame.color))) {
      const auto& markers = recording.manifest.markers;
      const auto marker =
          std::find_if(markers.begin(), markers.end(),
                       [&](const MarkerEntry& entry) { return entry.id == detection.id; });
      EXPECT_NE(marker, markers.end()) << detection.id.to_string();
      if (marker == markers.end()) continue;
      Pose T_base_parent;
      if (marker->role == MarkerRole::object) {
        const auto file = truth / "objects" / (marker->object + ".txt");
        T_base_parent = *read_trajectory(file).value().at(frame.color_stamp);
      }
      const Pose T_camera_marker = T_camera_base * T_base_parent * marker->T_parent_marker;
      const auto corners = tag_corners(marker->size);
      for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector2d seen =
            recording.manifest.camera->project(T_camera_marker * corners[k]);
        errors.push_back((seen - detection.corners[k]).norm());
      }
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(Simulate, DetectedTagsMatchTheProjectedTruth) {
  for (const char* name : {"tabletop", "push", "room"}) {
    SimulationCase simulation = case_named(name);
    simulation.frame_rate = 3.0 / duration_of(simulation);
    const TemporaryFolder folder;
    const std::vector<double> errors = corner_errors(simulated(simulation, 1, folder.path()));
    ASSERT_GE(errors.size(), 12U) << name;
    // The corner error with noise and JPEG is about 0.03 px. A regular 4x4 grid of sub-samples
    // (edges to 1/8 px) would make it 0.09 px for the push's upright tags.
    EXPECT_LT(errors[errors.size() / 2], 0.06) << name;
  }
}

TEST(Simulate, AFolderThatCanNotBeWrittenToIsAnError) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "file";
  std::ofstream(file) << "not a folder";
  const auto result = simulate(tiny("tabletop"), 1, file, {1});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().to_string().find(file.string()), std::string::npos);
}

TEST(Simulate, RefusesAnInvalidCase) {
  const TemporaryFolder folder;
  SimulationCase timeless = tiny("tabletop");
  timeless.duration = 0.0;
  EXPECT_THROW((void)simulate(timeless, 1, folder.path(), {1}), ContractError);
  SimulationCase blind = tiny("tabletop");
  blind.with_images = false;
  EXPECT_THROW((void)simulate(blind, 1, folder.path(), {1}), ContractError);
}

}  // namespace
}  // namespace pcavr
