// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#define SDL_MAIN_HANDLED
#include <SDL.h>

namespace pcavr::test {

/// SDL's virtual gamepad, which records the amplitudes of its motors.
class VirtualGamepad {
 public:
  VirtualGamepad() {
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER);
    SDL_VirtualJoystickDesc description{};
    description.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    description.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    description.naxes = SDL_CONTROLLER_AXIS_MAX;
    description.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    description.name = "Virtual Pad";
    description.userdata = this;
    description.Rumble = [](void* pad, Uint16 low, Uint16 high) {
      static_cast<VirtualGamepad*>(pad)->heavy = low;
      static_cast<VirtualGamepad*>(pad)->light = high;
      return 0;
    };
    index_ = SDL_JoystickAttachVirtualEx(&description);
    joystick_ = SDL_JoystickOpen(index_);
  }
  ~VirtualGamepad() {
    unplug();
    SDL_JoystickClose(joystick_);
    SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
  }
  VirtualGamepad(const VirtualGamepad&) = delete;
  VirtualGamepad& operator=(const VirtualGamepad&) = delete;

  void axis(SDL_GameControllerAxis which, int value) {
    SDL_JoystickSetVirtualAxis(joystick_, which, static_cast<Sint16>(value));
  }
  void button(SDL_GameControllerButton which, bool is_down) {
    SDL_JoystickSetVirtualButton(joystick_, which, is_down ? 1 : 0);
  }
  void unplug() {
    if (index_ >= 0) SDL_JoystickDetachVirtual(index_);
    index_ = -1;
  }

  std::atomic<int> heavy{0};
  std::atomic<int> light{0};

 private:
  int index_ = -1;
  SDL_Joystick* joystick_ = nullptr;
};

}  // namespace pcavr::test
