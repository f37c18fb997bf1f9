// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/plugin_device.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include <dlfcn.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/shared_library.hpp"
#include "pcavr/teleoperation/devices/device_plugin.h"

#include "teleoperation/devices/clutch.hpp"

namespace pcavr {
namespace {

constexpr char kEntry[] = "pcavr_get_device_plugin";

Expected<const pcavr_device_plugin*> plugin_of(void* library, const std::string& file) {
  const auto get = reinterpret_cast<const pcavr_device_plugin* (*)()>(dlsym(library, kEntry));
  if (get == nullptr) {
    return Error{.message = std::string("is not a device plugin: it lacks ") + kEntry,
                 .file = file,
                 .hint = "export it as declared in pcavr/teleoperation/devices/device_plugin.h"};
  }
  const pcavr_device_plugin* plugin = get();
  if (plugin == nullptr) return Error{.message = "returned no plugin", .file = file};
  if (plugin->abi != PCAVR_DEVICE_PLUGIN_ABI || plugin->size < sizeof(pcavr_device_plugin)) {
    return Error{.message = "has plugin ABI " + std::to_string(plugin->abi) + " of " +
                            std::to_string(plugin->size) + " bytes, expected " +
                            std::to_string(PCAVR_DEVICE_PLUGIN_ABI) + " of " +
                            std::to_string(sizeof(pcavr_device_plugin)),
                 .file = file,
                 .hint = "build it with this version's device_plugin.h"};
  }
  if (plugin->open == nullptr || plugin->close == nullptr || plugin->exchange == nullptr) {
    return Error{
        .message = "lacks one of open, close and exchange", .file = file, .hint = "set all three"};
  }
  return plugin;
}

bool is_valid(const pcavr_device_sample& sample) {
  return is_plausible_tip(Eigen::Vector3d(sample.tip)) &&
         is_rotation(Eigen::Quaterniond(sample.quaternion));
}

}  // namespace

struct PluginDevice::Content {
  explicit Content(const PluginDeviceOptions& plugin_options)
      : options(plugin_options),
        q_base_operator(Eigen::AngleAxisd(plugin_options.facing, Eigen::Vector3d::UnitZ())) {}
  ~Content() {
    if (device != nullptr) plugin->close(device);
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  /// The plugin's sample, if it is valid.
  std::optional<pcavr_device_sample> call(double t, double dt,
                                          const DeviceFeedback& feedback) noexcept;

  PluginDeviceOptions options;
  Eigen::Quaterniond q_base_operator;
  SharedLibrary library;  // unloaded after the device was closed
  const pcavr_device_plugin* plugin = nullptr;
  void* device = nullptr;
  std::string name;
  Clutch clutch;
  bool is_stop_pressed = false;  ///< in the last call
  std::atomic<double> slowest{0.0};
  std::atomic<std::uint64_t> slow{0};
  std::atomic<std::uint64_t> faults{0};
};

std::optional<pcavr_device_sample> PluginDevice::Content::call(
    double t, double dt, const DeviceFeedback& feedback) noexcept {
  pcavr_device_feedback plugin_feedback{.size = sizeof plugin_feedback,
                                        .is_engaged = clutch.is_closed(),
                                        .force = {},
                                        .pulse = clutch.is_closed() ? feedback.pulse : 0.0,
                                        .torque = {}};
  if (clutch.is_closed()) {
    Eigen::Map<Eigen::Vector3d>(plugin_feedback.force) =
        q_base_operator.conjugate() * feedback.force_base;
    Eigen::Map<Eigen::Vector3d>(plugin_feedback.torque) =
        q_base_operator.conjugate() * feedback.torque_base;
  }
  pcavr_device_sample sample{};
  sample.size = sizeof sample;
  sample.quaternion[3] = 1.0;
  bool is_ok = false;
  const auto start = std::chrono::steady_clock::now();
  try {
    is_ok = plugin->exchange(device, t, dt, &plugin_feedback, &sample) == 0;
  } catch (...) {
    is_ok = false;
  }
  const std::chrono::duration<double> duration = std::chrono::steady_clock::now() - start;
  if (duration.count() > slowest) slowest = duration.count();
  if (duration.count() > options.slow_limit) ++slow;
  is_stop_pressed = is_ok && sample.is_stop_pressed != 0;
  if (is_ok && (sample.is_present == 0 || is_valid(sample))) return sample;
  ++faults;
  return std::nullopt;
}

PluginDevice::PluginDevice(std::unique_ptr<Content> content) : content_(std::move(content)) {}

PluginDevice::~PluginDevice() = default;

Expected<std::unique_ptr<PluginDevice>> PluginDevice::open(const std::filesystem::path& library,
                                                           const PluginDeviceOptions& options) {
  PCAVR_REQUIRE(std::isfinite(options.facing), options.facing);
  PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0, options.max_speed);
  auto content = std::make_unique<Content>(options);
  Expected<SharedLibrary> loaded = load_library(library);
  if (!loaded) return loaded.error();
  content->library = *std::move(loaded);
  const auto plugin = plugin_of(content->library.get(), library.string());
  if (!plugin) return plugin.error();
  content->plugin = *plugin;
  std::array<char, 256> reason{};
  content->device = content->plugin->open(options.text.c_str(), reason.data(), reason.size() - 1);
  if (content->device == nullptr) {
    return Error{.message = std::string("can't open its device: ") +
                            (reason[0] != '\0' ? reason.data() : "no reason given"),
                 .file = library.string()};
  }
  content->name = content->plugin->name != nullptr ? content->plugin->name : "plugin";
  return std::unique_ptr<PluginDevice>(new PluginDevice(std::move(content)));
}

PluginHealth PluginDevice::health() const noexcept {
  return {content_->slowest, content_->slow, content_->faults};
}

std::string_view PluginDevice::name() const noexcept { return content_->name; }

DeviceSample PluginDevice::exchange(double t, double dt, const DeviceFeedback& feedback) noexcept {
  Content& own = *content_;
  const std::optional<pcavr_device_sample> sample = own.call(t, dt, feedback);
  if (!sample || sample->is_present == 0) {
    own.clutch.open();
    return {.is_stop_pressed = own.is_stop_pressed};
  }
  const Eigen::Vector3d p_hand = own.q_base_operator * Eigen::Vector3d(sample->tip);
  if (sample->is_engaged == 0) own.clutch.open();
  if (sample->is_engaged != 0 && !own.clutch.is_closed() &&
      is_plausible_tip(feedback.p_base_tool)) {
    own.clutch.close(p_hand, feedback.p_base_tool);
  }
  const bool is_engaged = own.clutch.is_closed();
  return {.p_base_tip = is_engaged ? own.clutch.follow(p_hand, own.options.max_speed * dt) : p_hand,
          .q_base_tool = own.q_base_operator * Eigen::Quaterniond(sample->quaternion).normalized(),
          .is_engaged = is_engaged,
          .is_present = true,
          .is_stop_pressed = own.is_stop_pressed};
}

}  // namespace pcavr
