// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/message.hpp"

#include <array>
#include <cmath>
#include <concepts>

#include "pcavr/core/bytes.hpp"
#include "pcavr/core/check.hpp"
#include "pcavr/prediction/body_physics.hpp"

namespace pcavr {
namespace {

constexpr double kTimeUnit = 1e-5;  // [s]; 32 bits of it last for 11 hours
constexpr std::uint8_t kHasPlace = 0x08;
constexpr std::uint8_t kHasTwist = 0x10;
constexpr std::uint8_t kHasLeadOut = 0x20;
constexpr std::uint8_t kHasParameters = 0x40;
constexpr std::uint8_t kCaseMask = 0x07;
constexpr std::uint8_t kKnownFlags = 0x7f;
constexpr std::uint8_t kCases = 5;
constexpr std::uint16_t kHasLimitSurface = 0x8000;

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

/// Numbers of a message; one that is not finite makes the whole unsound.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <std::unsigned_integral Whole>
  [[nodiscard]] Whole whole() {
    return bytes_.whole<Whole>();
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
  [[nodiscard]] bool took_all() const {
    return is_finite_ && bytes_.is_sound() && bytes_.is_at_end();
  }

 private:
  ByteReader bytes_;
  bool is_finite_ = true;
};

std::uint16_t fields_of(const ObjectParameters& parameters) {
  unsigned present = parameters.limit_surface ? kHasLimitSurface : 0U;
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    if (parameters.*kFields[i]) present |= 1U << i;
  }
  return static_cast<std::uint16_t>(present);
}

void write(const ObjectParameters& parameters, ByteWriter& writer) {
  writer.whole(fields_of(parameters));
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    const std::optional<ParameterValue>& value = parameters.*kFields[i];
    if (!value) continue;
    write_real(value->value, writer);
    if (i == kLimitingFriction) write_real(value->deviation.value_or(0.0), writer);
  }
  if (!parameters.limit_surface) return;
  write_real(parameters.limit_surface->force, writer);
  write_real(parameters.limit_surface->length, writer);
  for (const double coefficient : parameters.limit_surface->coefficients) {
    write_real(coefficient, writer);
  }
}

bool are_known_fields(std::uint16_t present) {
  constexpr unsigned kKnown = ((1U << kFields.size()) - 1U) | kHasLimitSurface;
  return present != 0 && (present & ~kKnown) == 0;
}

std::optional<ObjectParameters> read_parameters(Reader& reader) {
  ObjectParameters parameters;
  const auto present = reader.whole<std::uint16_t>();
  if (!are_known_fields(present)) return std::nullopt;
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    if ((present >> i & 1U) == 0) continue;
    parameters.*kFields[i] = ParameterValue{reader.real(), std::nullopt};
    if (i == kLimitingFriction) (parameters.*kFields[i])->deviation = reader.real();
  }
  if ((present & kHasLimitSurface) == 0) return parameters;
  LimitSurface& surface = parameters.limit_surface.emplace();
  surface.force = reader.real();
  surface.length = reader.real();
  for (double& coefficient : surface.coefficients) coefficient = reader.real();
  return parameters;
}

bool are_known_flags(std::uint8_t flags) {
  const bool has_lone_twist = (flags & kHasTwist) != 0 && (flags & kHasPlace) == 0;
  return (flags & ~kKnownFlags) == 0 && (flags & kCaseMask) < kCases && !has_lone_twist;
}

}  // namespace

PlanarPlace place_of(const Pose& T_base_object) {
  return {T_base_object.translation().x(), T_base_object.translation().y(),
          heading_of(T_base_object)};
}

Pose pose_at(const PlanarPlace& place, const Pose& T_base_start) {
  const double turn = place.yaw - heading_of(T_base_start);
  const Eigen::Quaterniond q_turn(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
  return {q_turn * T_base_start.rotation(), {place.x, place.y, T_base_start.translation().z()}};
}

std::string describe(const CorrectionMessage& message) {
  const ObjectParameters& news = message.parameters;
  const bool has_contact = news.contact_stiffness || news.contact_damping || news.contact_exponent;
  ObjectParameters others = news;
  others.contact_stiffness.reset();
  others.contact_damping.reset();
  others.contact_exponent.reset();
  std::string what;
  const auto add = [&what](const char* word) {
    if (!what.empty()) what += '+';
    what += word;
  };
  if (message.place) add("position");
  if (has_contact) add("contact parameters");
  if (fields_of(others) != 0) add("friction parameters");
  return what;
}

std::vector<std::uint8_t> encode(const CorrectionMessage& message, double epoch) {
  const double units = std::round((message.t - epoch) / kTimeUnit);
  PCAVR_REQUIRE(units >= 0.0 && units <= 4294967295.0, message.t, epoch);
  PCAVR_REQUIRE(message.object < 256, message.object);
  PCAVR_REQUIRE(message.place || !message.twist);
  const bool has_parameters = fields_of(message.parameters) != 0;
  unsigned flags = static_cast<unsigned>(message.which);
  if (message.place) flags |= kHasPlace;
  if (message.twist) flags |= kHasTwist;
  if (message.lead_out) flags |= kHasLeadOut;
  if (has_parameters) flags |= kHasParameters;
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  writer.whole(static_cast<std::uint8_t>(flags));
  writer.whole(static_cast<std::uint8_t>(message.object));
  writer.whole(message.sequence);
  writer.whole(static_cast<std::uint32_t>(units));
  if (const auto& place = message.place) write_vector({place->x, place->y, place->yaw}, writer);
  if (message.twist) write_vector(*message.twist, writer);
  if (message.lead_out) write_vector(*message.lead_out, writer);
  if (has_parameters) write(message.parameters, writer);
  return bytes;
}

std::optional<CorrectionMessage> decode(std::span<const std::uint8_t> bytes, double epoch) {
  Reader reader(bytes);
  CorrectionMessage message;
  const auto flags = reader.whole<std::uint8_t>();
  if (!are_known_flags(flags)) return std::nullopt;
  message.which = static_cast<CorrectionCase>(flags & kCaseMask);
  message.object = reader.whole<std::uint8_t>();
  message.sequence = reader.whole<std::uint8_t>();
  message.t = epoch + kTimeUnit * static_cast<double>(reader.whole<std::uint32_t>());
  if ((flags & kHasPlace) != 0) {
    const Eigen::Vector3d place = reader.vector();
    message.place = PlanarPlace{place.x(), place.y(), place.z()};
  }
  if ((flags & kHasTwist) != 0) message.twist = reader.vector();
  if ((flags & kHasLeadOut) != 0) message.lead_out = reader.vector();
  if ((flags & kHasParameters) != 0) {
    const std::optional<ObjectParameters> parameters = read_parameters(reader);
    if (!parameters) return std::nullopt;
    message.parameters = *parameters;
  }
  if (!reader.took_all()) return std::nullopt;
  return message;
}

std::size_t bytes_of_tracked_pose() { return encode({.place = PlanarPlace{}}, 0.0).size(); }

std::size_t bytes_of_wrench_sample() {
  return encode({.lead_out = Eigen::Vector3d::Zero()}, 0.0).size();
}

}  // namespace pcavr
