// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/gamepad_device.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string>
#include <thread>

#define SDL_MAIN_HANDLED
#include <SDL.h>

#include "teleoperation/devices/newest.hpp"
#include "teleoperation/devices/rate_tip.hpp"
#include "teleoperation/devices/stop_button.hpp"

namespace pcavr {
namespace {

constexpr std::chrono::milliseconds kPeriod(4);  // 250 Hz: the fastest that gamepads send
/// [ms] A rumble that is not renewed ends: longer than a delay of the thread, but short.
constexpr std::uint32_t kRumbleDuration = 100;
constexpr double kFull = 32767.0;  // SDL's axes are of 16 bits

using Controller = std::unique_ptr<SDL_GameController, decltype(&SDL_GameControllerClose)>;

/// RAII of an SDL subsystem, which SDL counts by reference.
class Subsystem {
 public:
  Subsystem() {
    // SDL would handle Ctrl-C itself without these hints, and get no events without a window.
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    is_up_ = SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) == 0;
  }
  ~Subsystem() {
    if (is_up_) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }
  Subsystem(const Subsystem&) = delete;
  Subsystem& operator=(const Subsystem&) = delete;
  [[nodiscard]] bool is_up() const { return is_up_; }

 private:
  bool is_up_ = false;
};

Controller first_controller() {
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (!SDL_IsGameController(i)) continue;
    if (SDL_GameController* found = SDL_GameControllerOpen(i)) {
      return {found, SDL_GameControllerClose};
    }
  }
  return {nullptr, SDL_GameControllerClose};
}

double axis(SDL_GameController* controller, SDL_GameControllerAxis which) {
  return std::max(-1.0, SDL_GameControllerGetAxis(controller, which) / kFull);
}

/// Zero within the dead zone, rescaled to start from zero at its border.
Eigen::Vector2d outside_dead_zone(const Eigen::Vector2d& stick, double dead_zone) {
  const double length = stick.norm();
  if (length <= dead_zone) return Eigen::Vector2d::Zero();
  return stick / length * std::min(1.0, (length - dead_zone) / (1.0 - dead_zone));
}

RateCommand command_of(SDL_GameController* controller, double dead_zone) {
  // SDL's y axes point down, or towards the operator.
  const Eigen::Vector2d level = outside_dead_zone(
      {-axis(controller, SDL_CONTROLLER_AXIS_LEFTY), -axis(controller, SDL_CONTROLLER_AXIS_LEFTX)},
      dead_zone);
  const Eigen::Vector2d upright =
      outside_dead_zone({0.0, -axis(controller, SDL_CONTROLLER_AXIS_RIGHTY)}, dead_zone);
  const bool is_engaged =
      SDL_GameControllerGetButton(controller, SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) != 0 ||
      axis(controller, SDL_CONTROLLER_AXIS_TRIGGERRIGHT) > 0.5;
  return {{level.x(), level.y(), upright.y()}, is_engaged, true};
}

bool is_pressed(SDL_GameController* controller, int button) {
  return SDL_GameControllerGetButton(controller, static_cast<SDL_GameControllerButton>(button)) !=
         0;
}

std::uint16_t strength(double ratio) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(ratio, 0.0, 1.0) * 65535.0));
}

}  // namespace

struct GamepadDevice::Content {
  Content(const GamepadOptions& gamepad_options, const RateOptions& rate)
      : options(gamepad_options), tip(rate) {}
  ~Content() {
    is_stopping = true;
    if (thread.joinable()) thread.join();
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  void run() noexcept;
  void rumble() noexcept;

  GamepadOptions options;
  Subsystem subsystem;
  Controller controller{nullptr, SDL_GameControllerClose};  ///< the thread's, once it runs
  std::string name = "gamepad";
  RateTip tip;
  Newest<RateCommand> newest;
  StopButton stop;
  std::atomic<float> heavy{0.0F};  ///< 0 to 1
  std::atomic<float> light{0.0F};  ///< 0 to 1
  std::atomic<bool> is_stopping{false};
  std::thread thread;
};

void GamepadDevice::Content::rumble() noexcept {
  SDL_GameControllerRumble(controller.get(), strength(heavy), strength(light), kRumbleDuration);
}

void GamepadDevice::Content::run() noexcept {
  while (!is_stopping) {
    SDL_GameControllerUpdate();
    if (controller && SDL_GameControllerGetAttached(controller.get()) == SDL_FALSE) {
      controller.reset();
    }
    if (!controller) controller = first_controller();
    stop.set(controller && is_pressed(controller.get(), options.stop_button));
    newest.put(controller ? command_of(controller.get(), options.dead_zone) : RateCommand{});
    if (controller) rumble();
    std::this_thread::sleep_for(kPeriod);
  }
  if (controller) SDL_GameControllerRumble(controller.get(), 0, 0, 0);
}

GamepadDevice::GamepadDevice(std::unique_ptr<Content> content) : content_(std::move(content)) {}

GamepadDevice::~GamepadDevice() = default;

Expected<std::unique_ptr<GamepadDevice>> GamepadDevice::open(const GamepadOptions& options,
                                                             const RateOptions& rate) {
  PCAVR_REQUIRE(std::isfinite(options.max_force) && options.max_force > 0.0, options.max_force);
  PCAVR_REQUIRE(options.dead_zone >= 0.0 && options.dead_zone < 1.0, options.dead_zone);
  PCAVR_REQUIRE(options.stop_button >= 0 && options.stop_button < SDL_CONTROLLER_BUTTON_MAX &&
                    options.stop_button != SDL_CONTROLLER_BUTTON_RIGHTSHOULDER,
                options.stop_button);
  auto content = std::make_unique<Content>(options, rate);
  if (!content->subsystem.is_up()) {
    return Error{.message = std::string("no gamepad: SDL initialization failed: ") + SDL_GetError(),
                 .hint = "check the read permissions of /dev/input"};
  }
  SDL_GameControllerUpdate();
  content->controller = first_controller();
  if (!content->controller) {
    return Error{.message = "no gamepad among " + std::to_string(SDL_NumJoysticks()) + " joysticks",
                 .hint =
                     "connect one; if SDL has no mapping for it, set it in the environment "
                     "variable SDL_GAMECONTROLLERCONFIG"};
  }
  if (const char* product = SDL_GameControllerName(content->controller.get())) {
    content->name += std::string(" (") + product + ")";
  }
  content->thread = std::thread([own = content.get()] { own->run(); });
  return std::unique_ptr<GamepadDevice>(new GamepadDevice(std::move(content)));
}

std::string_view GamepadDevice::name() const noexcept { return content_->name; }

DeviceSample GamepadDevice::exchange(double /*t*/, double dt,
                                     const DeviceFeedback& feedback) noexcept {
  Content& own = *content_;
  DeviceSample sample = own.tip.step(own.newest.get(), dt, feedback.p_base_tool);
  sample.is_stop_pressed = own.stop.take();
  // No vibration while the clutch is open, even if the world still has a force.
  const double force = sample.is_engaged ? feedback.force_base.norm() / own.options.max_force : 0.0;
  const double pulse = sample.is_engaged ? feedback.pulse : 0.0;
  own.heavy.store(std::isfinite(force) ? static_cast<float>(force) : 0.0F);
  own.light.store(std::isfinite(pulse) ? static_cast<float>(pulse) : 0.0F);
  return sample;
}

}  // namespace pcavr
