// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/plugin_robot.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

#include <dlfcn.h>
#include <fmt/core.h>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/core/shared_library.hpp"
#include "pcavr/pipeline/robot_plugin.h"

namespace pcavr {
namespace {

constexpr char kEntry[] = "pcavr_get_robot_plugin";
constexpr double kFar = 100.0;              // [m] beyond it a position is not plausible
constexpr double kMaxAge = 10.0;            // [s] of a sample
constexpr double kNormTolerance = 1e-3;     // of a quaternion
constexpr double kSilence = 0.2;            // [s] without a pose of the tool, which is noted
constexpr std::uint32_t kMaxPixels = 4096;  // of a picture's edge
// A plugin of before there were pictures ends there.
constexpr std::size_t kMinPluginSize = offsetof(pcavr_robot_plugin, take_picture);
constexpr double kSlow = 5e-4;  // [s] of a call, which is noted: half a cycle
constexpr auto kStartInterval = std::chrono::milliseconds(1);

using Vector = Eigen::Map<const Eigen::Vector3d>;

bool is_position(const double (&p)[3]) {
  const Vector position(p);
  return position.allFinite() && position.norm() < kFar;
}
bool is_rotation(const double (&q)[4]) {
  const double norm = Eigen::Map<const Eigen::Vector4d>(q).norm();
  return std::abs(norm - 1.0) < kNormTolerance;
}
bool is_age(double age) { return age >= 0.0 && age < kMaxAge; }
bool is_std(double std) { return std > 0.0 && std < kFar; }
Eigen::Quaterniond rotation(const double (&q)[4]) { return Eigen::Quaterniond(q).normalized(); }

Expected<const pcavr_robot_plugin*> plugin_of(void* library, const std::string& file) {
  const auto get = reinterpret_cast<const pcavr_robot_plugin* (*)()>(dlsym(library, kEntry));
  if (get == nullptr) {
    return Error{.message = std::string("is not a robot plugin: it lacks ") + kEntry,
                 .file = file,
                 .hint = "export it as declared in pcavr/pipeline/robot_plugin.h"};
  }
  const pcavr_robot_plugin* plugin = get();
  if (plugin == nullptr) return Error{.message = "returned no plugin", .file = file};
  if (plugin->abi != PCAVR_ROBOT_PLUGIN_ABI || plugin->size < kMinPluginSize) {
    return Error{
        .message = fmt::format("has plugin ABI {} of {} bytes, expected {} of {}", plugin->abi,
                               plugin->size, PCAVR_ROBOT_PLUGIN_ABI, kMinPluginSize),
        .file = file,
        .hint = "build it with this version's robot_plugin.h"};
  }
  if (plugin->open == nullptr || plugin->close == nullptr || plugin->exchange == nullptr) {
    return Error{
        .message = "lacks one of open, close and exchange", .file = file, .hint = "set all three"};
  }
  return plugin;
}

bool has_camera(const pcavr_robot_plugin& plugin) {
  return plugin.size >= sizeof(pcavr_robot_plugin) && plugin.take_picture != nullptr;
}

class PluginRobot final : public RobotInterface, private PictureSource {
 public:
  PluginRobot(SharedLibrary library, const pcavr_robot_plugin& plugin, void* robot,
              std::size_t objects)
      : library_(std::move(library)), plugin_(plugin), robot_(robot), objects_(objects) {}
  ~PluginRobot() override {
    static_cast<void>(caught([this] {
      plugin_.close(robot_);
      return true;
    }));
  }
  PluginRobot(const PluginRobot&) = delete;
  PluginRobot& operator=(const PluginRobot&) = delete;

  /// Waits for the tool's first sample, at most `timeout` [s]. False without one.
  bool start(double timeout) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
    while (std::chrono::steady_clock::now() < end) {
      RobotSamples samples;
      call(0.0, nullptr, samples);
      if (!samples.tool.empty()) {
        p_base_start_ = samples.tool.back().p_base_tip;
        q_base_tool_ = samples.tool.back().q_base_tool;
        set_command(p_base_start_, q_base_tool_);
        return true;
      }
      std::this_thread::sleep_for(kStartInterval);
    }
    return false;
  }

  [[nodiscard]] std::string name() const override {
    return plugin_.name != nullptr ? plugin_.name : "plugin";
  }
  [[nodiscard]] bool follows_commands() const override { return true; }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override { return p_base_start_; }
  void set_command(const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond&) override {
    command_ = pcavr_robot_command{
        .size = sizeof(pcavr_robot_command), .reserved = 0, .tip = {}, .quaternion = {}};
    Eigen::Map<Eigen::Vector3d>(command_.tip) = p_base_tip;
    Eigen::Map<Eigen::Vector4d>(command_.quaternion) = q_base_tool_.coeffs();
  }
  void advance(double t, RobotSamples& samples) override {
    const std::size_t before = samples.tool.size();
    call(t, &command_, samples);
    if (samples.tool.size() > before) {
      last_tool_ = t;
      is_silent_ = false;
    } else if (t - last_tool_.value_or(t) > kSilence && !std::exchange(is_silent_, true)) {
      notices_.push_back(fmt::format("the robot gives no pose of its tool for {:.1f} s", kSilence));
    }
  }
  [[nodiscard]] std::vector<std::string> take_notices() override {
    return std::exchange(notices_, {});
  }

  [[nodiscard]] PictureSource* pictures() override {
    return has_camera(plugin_) ? static_cast<PictureSource*>(this) : nullptr;
  }

 private:
  // PictureSource.
  [[nodiscard]] Expected<std::optional<CameraPicture>> newest(double t) override {
    pcavr_robot_picture picture{};
    picture.size = sizeof picture;
    const Expected<int> answer = caught([&] { return plugin_.take_picture(robot_, t, &picture); });
    if (!answer) return Error{.message = "the robot's plugin throws: " + answer.error().message};
    if (*answer != 1) return std::optional<CameraPicture>();
    const bool is_valid = picture.width > 0 && picture.width <= kMaxPixels && picture.height > 0 &&
                          picture.height <= kMaxPixels && picture.rgb != nullptr &&
                          is_age(picture.age);
    if (!is_valid) return Error{.message = "the robot's plugin gives one that is not valid"};
    CameraPicture taken{t - picture.age, ColorImage(static_cast<int>(picture.width),
                                                    static_cast<int>(picture.height))};
    static_assert(sizeof(Rgb8) == 3);
    std::memcpy(taken.image.pixels().data(), picture.rgb, taken.image.pixels().size() * 3);
    return std::optional(std::move(taken));
  }

  void call(double t, const pcavr_robot_command* command, RobotSamples& samples) {
    pcavr_robot_state state{};
    state.size = sizeof state;
    state.quaternion[3] = state.object_quaternion[3] = 1.0;
    const auto start = std::chrono::steady_clock::now();
    const Expected<int> answer =
        caught([&] { return plugin_.exchange(robot_, t, command, &state); });
    const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
    note_once(duration.count() > kSlow, kIsSlow,
              [] { return "the robot's plugin takes more than 0.5 ms"; });
    note_once(!answer, kHasThrown,
              [&] { return "the robot's plugin throws: " + answer.error().message; });
    if (!answer) {
      samples.has_fault = true;
      return;
    }
    note_once(*answer != 0, kHasFailed,
              [&] { return fmt::format("the robot's plugin answers {}", *answer); });
    if (*answer == 0) append(t, state, samples);
  }

  void append(double t, const pcavr_robot_state& state, RobotSamples& samples) {
    bool is_valid = true;
    if (state.has_tool != 0) {
      const bool is_tool =
          is_position(state.tip) && is_rotation(state.quaternion) && is_age(state.age_tool);
      if (is_tool) {
        samples.tool.push_back({t - state.age_tool, Vector(state.tip), rotation(state.quaternion)});
      }
      is_valid = is_valid && is_tool;
    }
    if (state.has_wrench != 0) {
      const bool is_wrench = Vector(state.force).allFinite() && Vector(state.torque).allFinite() &&
                             is_age(state.age_wrench);
      if (is_wrench) {
        samples.wrench.push_back({t - state.age_wrench, Vector(state.force), Vector(state.torque)});
      }
      is_valid = is_valid && is_wrench;
    }
    if (state.has_object != 0) is_valid = append_object(t, state, samples) && is_valid;
    samples.has_fault |= !is_valid;
    note_once(!is_valid, kIsInvalid,
              [] { return "a sample of the robot's plugin is not valid, and is ignored"; });
  }

  bool append_object(double t, const pcavr_robot_state& state, RobotSamples& samples) const {
    const bool is_valid = state.object < objects_ && is_position(state.object_position) &&
                          is_rotation(state.object_quaternion) && is_age(state.age_object) &&
                          is_std(state.object_position_std) && is_std(state.object_rotation_std);
    if (!is_valid) return false;
    samples.tracked.push_back(
        {state.object,
         {t - state.age_object,
          Pose(rotation(state.object_quaternion), Vector(state.object_position)),
          state.object_position_std, state.object_rotation_std}});
    return true;
  }

  /// Notes a line of each kind when it begins: other cycles make no text.
  enum Kind : std::size_t { kIsSlow, kHasThrown, kHasFailed, kIsInvalid, kKinds };
  template <typename Text>
  void note_once(bool is_now, Kind kind, const Text& text) {
    if (is_now && !std::exchange(is_noted_[kind], true)) notices_.emplace_back(text());
  }

  SharedLibrary library_;  // unloaded after the robot was closed
  const pcavr_robot_plugin& plugin_;
  void* robot_;
  std::size_t objects_;
  Eigen::Vector3d p_base_start_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_base_tool_ = Eigen::Quaterniond::Identity();
  pcavr_robot_command command_{};
  std::optional<double> last_tool_;  ///< [s]
  bool is_silent_ = false;
  std::array<bool, kKinds> is_noted_{};
  std::vector<std::string> notices_;
};

}  // namespace

Expected<std::unique_ptr<RobotInterface>> make_plugin_robot(const std::filesystem::path& library,
                                                            const PluginRobotOptions& options) {
  Expected<SharedLibrary> loaded = load_library(library);
  if (!loaded) return loaded.error();
  const auto plugin = plugin_of(loaded->get(), library.string());
  if (!plugin) return plugin.error();
  std::vector<const char*> objects;
  for (const std::string& name : options.objects) objects.push_back(name.c_str());
  std::array<char, 256> reason{};
  const Expected<void*> opened = caught([&] {
    return (*plugin)->open(options.text.c_str(), objects.data(), objects.size(), reason.data(),
                           reason.size() - 1);
  });
  if (!opened || *opened == nullptr) {
    const std::string given = reason[0] != '\0' ? reason.data() : "no reason given";
    return Error{.message = "can't open its robot: " + (opened ? given : opened.error().message),
                 .file = library.string()};
  }
  auto robot = std::make_unique<PluginRobot>(*std::move(loaded), **plugin, *opened, objects.size());
  if (robot->start(options.start_timeout)) return std::unique_ptr<RobotInterface>(std::move(robot));
  return Error{
      .message = fmt::format("gives no pose of the tool within {} s", options.start_timeout),
      .file = library.string(),
      .hint = "start the robot's controller first"};
}

}  // namespace pcavr
