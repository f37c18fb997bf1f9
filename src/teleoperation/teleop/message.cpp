// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/message.hpp"

#include <array>
#include <cmath>
#include <concepts>

#include "pcavr/base/core/bytes.hpp"
#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

namespace pcavr {
namespace {

constexpr double kTimeUnit = 1e-5;  // [s]; 32 bits cover 11 hours
constexpr std::uint8_t kHasPose = 0x08;
constexpr std::uint8_t kHasTwist = 0x10;
constexpr std::uint8_t kHasToolRetraction = 0x20;
constexpr std::uint8_t kHasParameters = 0x40;
constexpr std::uint8_t kCaseMask = 0x07;
constexpr std::uint8_t kKnownFlags = 0x7f;
constexpr std::uint8_t kCases = 5;
constexpr std::uint16_t kHasLimitSurface = 0x8000;
constexpr std::uint16_t kHasSurfaceOffset = 0x4000;

using Field = std::optional<ParameterValue> ObjectParameters::*;
constexpr std::array<Field, 10> kFields{&ObjectParameters::mass,
                                        &ObjectParameters::limiting_static_friction,
                                        &ObjectParameters::sliding_friction_coefficient,
                                        &ObjectParameters::viscous_friction,
                                        &ObjectParameters::contact_stiffness,
                                        &ObjectParameters::contact_damping,
                                        &ObjectParameters::contact_exponent,
                                        &ObjectParameters::friction_radius,
                                        &ObjectParameters::tool_friction_coefficient,
                                        &ObjectParameters::loading_rate};
constexpr std::size_t kLimitingFriction = 1;

void write_real(double value, ByteWriter& writer) { writer.f32(static_cast<float>(value)); }

void write_vector(const Eigen::Vector3d& vector, ByteWriter& writer) {
  for (const double value : vector) write_real(value, writer);
}

/// Reads a message; one number that is not finite makes it invalid.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <std::unsigned_integral Integer>
  [[nodiscard]] Integer integer() {
    return bytes_.integer<Integer>();
  }
  [[nodiscard]] double real() {
    const double value = bytes_.f32();
    is_finite_ = is_finite_ && std::isfinite(value);
    return value;
  }
  [[nodiscard]] Eigen::Vector3d vector() {
    const double x = real();
    const double y = real();
    return {x, y, real()};
  }
  [[nodiscard]] bool is_complete() const {
    return is_finite_ && bytes_.is_valid() && bytes_.is_at_end();
  }

 private:
  ByteReader bytes_;
  bool is_finite_ = true;
};

std::uint16_t fields_of(const ObjectParameters& parameters) {
  unsigned present = parameters.limit_surface ? kHasLimitSurface : 0U;
  if (parameters.contact_surface_offset) present |= kHasSurfaceOffset;
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    if (parameters.*kFields[i]) present |= 1U << i;
  }
  return static_cast<std::uint16_t>(present);
}

void write(const ObjectParameters& parameters, ByteWriter& writer) {
  writer.integer(fields_of(parameters));
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    const std::optional<ParameterValue>& value = parameters.*kFields[i];
    if (!value) continue;
    write_real(value->value, writer);
    if (i == kLimitingFriction) write_real(value->std.value_or(0.0), writer);
  }
  if (parameters.contact_surface_offset) write_vector(*parameters.contact_surface_offset, writer);
  if (!parameters.limit_surface) return;
  write_real(parameters.limit_surface->force, writer);
  write_real(parameters.limit_surface->length, writer);
  for (const double coefficient : parameters.limit_surface->coefficients) {
    write_real(coefficient, writer);
  }
}

bool are_known_fields(std::uint16_t present) {
  constexpr unsigned kKnown = ((1U << kFields.size()) - 1U) | kHasLimitSurface | kHasSurfaceOffset;
  return present != 0 && (present & ~kKnown) == 0;
}

std::optional<ObjectParameters> read_parameters(Reader& reader) {
  ObjectParameters parameters;
  const auto present = reader.integer<std::uint16_t>();
  if (!are_known_fields(present)) return std::nullopt;
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    if ((present >> i & 1U) == 0) continue;
    parameters.*kFields[i] = ParameterValue{reader.real(), std::nullopt};
    if (i == kLimitingFriction) (parameters.*kFields[i])->std = reader.real();
  }
  if ((present & kHasSurfaceOffset) != 0) parameters.contact_surface_offset = reader.vector();
  if ((present & kHasLimitSurface) == 0) return parameters;
  LimitSurface& surface = parameters.limit_surface.emplace();
  surface.force = reader.real();
  surface.length = reader.real();
  for (double& coefficient : surface.coefficients) coefficient = reader.real();
  return parameters;
}

bool are_known_flags(std::uint8_t flags) {
  const bool has_twist_without_pose = (flags & kHasTwist) != 0 && (flags & kHasPose) == 0;
  return (flags & ~kKnownFlags) == 0 && (flags & kCaseMask) < kCases && !has_twist_without_pose;
}

}  // namespace

PlanarPose planar_pose_of(const Pose& T_base_object) {
  return {T_base_object.translation().x(), T_base_object.translation().y(),
          heading_of(T_base_object)};
}

Pose pose_at(const PlanarPose& pose, const Pose& T_base_start) {
  const double angle = pose.yaw - heading_of(T_base_start);
  const Eigen::Quaterniond q_yaw(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  return {q_yaw * T_base_start.rotation(), {pose.x, pose.y, T_base_start.translation().z()}};
}

double distance(const PlanarPose& a, const PlanarPose& b, double rotation_radius) {
  return std::hypot(a.x - b.x, a.y - b.y) +
         rotation_radius * std::abs(std::remainder(a.yaw - b.yaw, 2.0 * M_PI));
}

std::string describe(const CorrectionMessage& message) {
  const ObjectParameters& changed = message.parameters;
  const bool has_contact = changed.contact_stiffness || changed.contact_damping ||
                           changed.contact_exponent || changed.contact_surface_offset;
  ObjectParameters others = changed;
  others.contact_stiffness.reset();
  others.contact_damping.reset();
  others.contact_exponent.reset();
  others.contact_surface_offset.reset();
  std::string what;
  const auto add = [&what](const char* part) {
    if (!what.empty()) what += '+';
    what += part;
  };
  if (message.pose) add("position");
  if (has_contact) add("contact parameters");
  if (fields_of(others) != 0) add("friction parameters");
  return what;
}

std::vector<std::uint8_t> encode(const CorrectionMessage& message, double epoch) {
  const double units = std::round((message.t - epoch) / kTimeUnit);
  PCAVR_REQUIRE(units >= 0.0 && units <= 4294967295.0, message.t, epoch);
  PCAVR_REQUIRE(message.object < 256, message.object);
  PCAVR_REQUIRE(message.pose || !message.twist);
  const bool has_parameters = fields_of(message.parameters) != 0;
  unsigned flags = static_cast<unsigned>(message.which);
  if (message.pose) flags |= kHasPose;
  if (message.twist) flags |= kHasTwist;
  if (message.tool_retraction) flags |= kHasToolRetraction;
  if (has_parameters) flags |= kHasParameters;
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  writer.integer(static_cast<std::uint8_t>(flags));
  writer.integer(static_cast<std::uint8_t>(message.object));
  writer.integer(message.sequence);
  writer.integer(static_cast<std::uint32_t>(units));
  if (const auto& pose = message.pose) write_vector({pose->x, pose->y, pose->yaw}, writer);
  if (message.twist) write_vector(*message.twist, writer);
  if (message.tool_retraction) write_vector(*message.tool_retraction, writer);
  if (has_parameters) write(message.parameters, writer);
  return bytes;
}

std::optional<CorrectionMessage> decode(std::span<const std::uint8_t> bytes, double epoch) {
  Reader reader(bytes);
  CorrectionMessage message;
  const auto flags = reader.integer<std::uint8_t>();
  if (!are_known_flags(flags)) return std::nullopt;
  message.which = static_cast<CorrectionCase>(flags & kCaseMask);
  message.object = reader.integer<std::uint8_t>();
  message.sequence = reader.integer<std::uint8_t>();
  message.t = epoch + kTimeUnit * static_cast<double>(reader.integer<std::uint32_t>());
  if ((flags & kHasPose) != 0) {
    const Eigen::Vector3d pose = reader.vector();
    message.pose = PlanarPose{pose.x(), pose.y(), pose.z()};
  }
  if ((flags & kHasTwist) != 0) message.twist = reader.vector();
  if ((flags & kHasToolRetraction) != 0) message.tool_retraction = reader.vector();
  if ((flags & kHasParameters) != 0) {
    const std::optional<ObjectParameters> parameters = read_parameters(reader);
    if (!parameters) return std::nullopt;
    message.parameters = *parameters;
  }
  if (!reader.is_complete()) return std::nullopt;
  return message;
}

std::size_t bytes_of_tracked_pose() { return encode({.pose = PlanarPose{}}, 0.0).size(); }

std::size_t bytes_of_wrench_sample() {
  return encode({.tool_retraction = Eigen::Vector3d::Zero()}, 0.0).size();
}

}  // namespace pcavr
