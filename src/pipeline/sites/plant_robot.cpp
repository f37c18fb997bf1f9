// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/plant_robot.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/simulation/live_plant.hpp"
#include "pcavr/simulation/plant_camera.hpp"
#include "pcavr/simulation/plant_truth.hpp"

namespace pcavr {
namespace {

// Longest time of the plant that one call catches up with [s]; more is skipped: this process did
// not run.
constexpr double kMaxCatchUp = 0.05;

/// The plant's camera. The plant's thread never waits for the rendering one.
class PlantPictures final : public PictureSource {
 public:
  PlantPictures(PlantCamera camera, std::vector<double> heights)
      : camera_(std::move(camera)), heights_(std::move(heights)) {}

  /// The plant as it is at `t` [s of the scene].
  void update(double t, const LivePlant& plant) {
    if (t < next_) return;
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return;
    next_ = t + kPicturePeriod;
    t_ = t;
    p_base_tip_ = plant.p_base_tip();
    T_base_objects_.clear();
    for (std::size_t i = 0; i < plant.size(); ++i) {
      const PlantBodyState body = plant.body(i);
      T_base_objects_.emplace_back(
          Eigen::Quaterniond(Eigen::AngleAxisd(body.yaw, Eigen::Vector3d::UnitZ())),
          Eigen::Vector3d(body.p_base.x(), body.p_base.y(), heights_[i]));
    }
    is_new_ = true;
  }

  [[nodiscard]] Expected<std::optional<CameraPicture>> newest(double) override {
    Eigen::Vector3d p_base_tip;
    std::vector<Pose> T_base_objects;
    double t = 0.0;
    {
      const std::lock_guard lock(mutex_);
      if (!std::exchange(is_new_, false)) return std::optional<CameraPicture>();
      t = t_;
      p_base_tip = p_base_tip_;
      T_base_objects = T_base_objects_;
    }
    return std::optional(
        CameraPicture{t, camera_.render(p_base_tip, T_base_objects, ++number_), camera_.camera()});
  }

 private:
  static constexpr double kPicturePeriod = 0.1;  // [s]: some part of a core renders them

  PlantCamera camera_;
  std::vector<double> heights_;  ///< [m] of the bodies' origins, by body
  double next_ = 0.0;            ///< [s]
  std::uint64_t number_ = 0;     ///< of the rendering thread
  std::mutex mutex_;             ///< of what follows
  double t_ = 0.0;
  Eigen::Vector3d p_base_tip_ = Eigen::Vector3d::Zero();
  std::vector<Pose> T_base_objects_;
  bool is_new_ = false;
};

class LivePlantRobot final : public PlantRobot {
 public:
  LivePlantRobot(const PlantCase& plant, std::uint64_t seed, std::vector<std::size_t> objects,
                 double tracking_latency, std::unique_ptr<PlantPictures> pictures)
      : case_(plant),
        plant_(plant, seed),
        objects_(std::move(objects)),
        tracking_latency_(tracking_latency),
        start_(plant.tool.p_base_start),
        p_base_command_(start_),
        pictures_(std::move(pictures)) {}

  [[nodiscard]] std::string name() const override { return "simulated plant"; }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return start_; }
  void set_command(const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond&) override {
    p_base_command_ = p_base_tip;
  }

  void advance(double t, RobotSamples& samples) override {
    if (t - now() > kMaxCatchUp) skip(t - now() - LivePlant::kStep);
    const auto steps = static_cast<int>(std::floor((t - now()) / LivePlant::kStep + 1e-6));
    const Eigen::Vector3d from = last_command_.value_or(p_base_command_);
    measured_.clear();
    // The command arrives once a call: between two of them it goes in a straight line.
    for (int i = 1; i <= steps; ++i) {
      plant_.step(from + (static_cast<double>(i) / steps) * (p_base_command_ - from), measured_);
    }
    samples.has_fault |= !plant_.is_finite();
    if (samples.has_fault) return;
    if (steps > 0) last_command_ = p_base_command_;
    append(samples);
    deliver_tracking(t, samples);
    if (pictures_) pictures_->update(t, plant_);
  }
  [[nodiscard]] PictureSource* pictures() override { return pictures_.get(); }

  void keep_truth() override { plant_.keep_run(); }
  [[nodiscard]] Expected<void> write_truth(const std::filesystem::path& folder) const override {
    return write_plant_truth(folder, case_, plant_.run());
  }

 private:
  [[nodiscard]] double now() const { return plant_.t() + skipped_; }

  void skip(double duration) {
    const auto steps = static_cast<long long>(duration / LivePlant::kStep);
    plant_.skip(steps);
    skipped_ += LivePlant::kStep * static_cast<double>(steps);
  }

  void append(RobotSamples& samples) {
    for (const LivePlantSamples::Tool& tool : measured_.tool) {
      samples.tool.push_back(
          {tool.t + skipped_, tool.T_base_tool.translation(), tool.T_base_tool.rotation()});
    }
    for (const LivePlantSamples::Wrench& wrench : measured_.wrench) {
      samples.wrench.push_back({wrench.t + skipped_, wrench.force_base, wrench.torque_base});
    }
    for (const LivePlantSamples::Tracked& seen : measured_.tracked) {
      const TrackedPose pose{seen.t + skipped_, seen.T_base_object, seen.position_std,
                             seen.rotation_std};
      waiting_.push_back({objects_[seen.body], pose});
    }
  }

  void deliver_tracking(double t, RobotSamples& samples) {
    for (; !waiting_.empty() && waiting_.front().pose.t + tracking_latency_ <= t;
         waiting_.pop_front()) {
      samples.tracked.push_back(waiting_.front());
    }
  }

  PlantCase case_;
  LivePlant plant_;
  std::vector<std::size_t> objects_;  ///< of the world, by the plant's body
  double tracking_latency_;           ///< [s]
  Eigen::Vector3d start_;
  Eigen::Vector3d p_base_command_;
  std::optional<Eigen::Vector3d> last_command_ = {};
  double skipped_ = 0.0;  ///< [s] of the scene's time in which the plant stood still
  LivePlantSamples measured_;
  std::deque<RobotSamples::Tracked> waiting_;
  std::unique_ptr<PlantPictures> pictures_;  ///< null: without a camera
};

/// Places the body where the scene has it: on the table, turned about the vertical only.
void place(const Pose& T_base_object, PlantBody& body) {
  const Eigen::Vector3d x = T_base_object.rotation() * Eigen::Vector3d::UnitX();
  const double yaw = std::atan2(x.y(), x.x());
  const Eigen::Vector3d& p = T_base_object.translation();
  body.T_base_object = Pose(Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
                            {p.x(), p.y(), body.T_base_object.translation().z()});
}

Error other_objects(const std::string& name, const char* where) {
  return Error{.message = name + " is not an object of " + where,
               .hint = "give --plant the case and --seed the seed of the scene's recording"};
}

}  // namespace

Expected<std::unique_ptr<PlantRobot>> make_plant_robot(ToolTask task, std::uint64_t seed,
                                                       const TeleopInput& world,
                                                       double tracking_latency,
                                                       const SimulationCase* camera) {
  PlantCase plant = make_plant_case(task, seed);
  std::vector<std::size_t> objects;
  for (PlantBody& body : plant.bodies) {
    const auto found =
        std::find_if(world.objects.begin(), world.objects.end(),
                     [&](const TeleopObject& object) { return object.name == body.name; });
    if (found == world.objects.end()) return other_objects(body.name, "the scene");
    objects.push_back(static_cast<std::size_t>(found - world.objects.begin()));
    place(found->T_base_object, body);
    body.is_movable = body.is_movable && found->is_movable;
  }
  for (const TeleopObject& object : world.objects) {
    const bool is_known =
        std::any_of(plant.bodies.begin(), plant.bodies.end(),
                    [&](const PlantBody& body) { return body.name == object.name; });
    if (!is_known) return other_objects(object.name, "the plant");
  }
  std::unique_ptr<PlantPictures> pictures;
  if (camera != nullptr && !camera->has_arm) {
    Expected<PlantCamera> view = PlantCamera::create(*camera, seed);
    if (!view) return view.error();
    std::vector<double> heights;
    for (const PlantBody& body : plant.bodies) {
      heights.push_back(body.T_base_object.translation().z());
    }
    pictures = std::make_unique<PlantPictures>(std::move(*view), std::move(heights));
  }
  return std::unique_ptr<PlantRobot>(std::make_unique<LivePlantRobot>(
      plant, seed, std::move(objects), tracking_latency, std::move(pictures)));
}

}  // namespace pcavr
