// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// A device plugin: makes a vendor's haptic device available to pcavr as a shared library with the
// functions below. This one simulates a device: a mass of 0.1 kg that a spring and damper pull
// along a circle, with a handle that a spring keeps upright and that a torque tilts. Use it as
// `plugin:libround_device.so` or, for another radius in millimetres,
// `plugin:libround_device.so,50`.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "pcavr/teleoperation/devices/device_plugin.h"

namespace {

constexpr double kMass = 0.1;         // [kg]
constexpr double kStiffness = 200.0;  // [N/m]
constexpr double kDamping = 9.0;      // [N s/m] critical
constexpr double kTurn = 1.0;         // [rad/s] around the circle
constexpr double kTilt = 0.5;         // [N m/rad] of the handle's spring
constexpr double kTiltTime = 0.05;    // [s] in which it follows a torque

struct RoundDevice {
  double radius = 0.03;  // [m]
  double tip[3] = {};
  double velocity[3] = {};
  double tilt[3] = {};  // [rad] small, about each axis
};

// A real plugin would initialise the vendor's SDK and open the device here.
void* open(const char* options, char* error, size_t error_size) {
  const double millimetres = *options == '\0' ? 30.0 : std::strtod(options, nullptr);
  if (!(millimetres > 0.0 && millimetres <= 100.0)) {
    std::snprintf(error, error_size, "'%s' is not a radius from 0 to 100 mm", options);
    return nullptr;
  }
  auto* device = new (std::nothrow) RoundDevice;
  if (device != nullptr) device->radius = 1e-3 * millimetres;
  return device;
}

void close(void* device) { delete static_cast<RoundDevice*>(device); }

// A real plugin would send the force to the SDK and read the tip's position here.
int exchange(void* given, double t, double dt, const pcavr_device_feedback* feedback,
             pcavr_device_sample* sample) {
  auto& device = *static_cast<RoundDevice*>(given);
  const double target[3] = {device.radius * std::sin(kTurn * t),
                            device.radius * std::cos(kTurn * t), 0.0};
  for (int i = 0; i < 3; ++i) {
    const double force = kStiffness * (target[i] - device.tip[i]) - kDamping * device.velocity[i] +
                         feedback->force[i];
    device.velocity[i] += dt / kMass * force;
    device.tip[i] += dt * device.velocity[i];
    sample->tip[i] = device.tip[i];
  }
  for (int i = 0; i < 3; ++i) {
    device.tilt[i] += dt / kTiltTime * (feedback->torque[i] / kTilt - device.tilt[i]);
    sample->quaternion[i] = std::sin(0.5 * device.tilt[i]);
  }
  const double* q = sample->quaternion;
  sample->quaternion[3] = std::sqrt(std::fmax(0.0, 1.0 - q[0] * q[0] - q[1] * q[1] - q[2] * q[2]));
  sample->is_present = 1;
  sample->is_engaged = 1;
  return 0;
}

constexpr pcavr_device_plugin kPlugin = {
    sizeof(pcavr_device_plugin), PCAVR_DEVICE_PLUGIN_ABI, "round device", open, close, exchange};

}  // namespace

const pcavr_device_plugin* pcavr_get_device_plugin(void) { return &kPlugin; }
