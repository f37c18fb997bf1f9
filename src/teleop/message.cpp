// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/message.hpp"

#include <array>
#include <bit>
#include <cmath>

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

class Writer {
 public:
  template <typename Unsigned>
  void whole(Unsigned value) {
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void real(double value) { whole(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  std::vector<std::uint8_t> bytes;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <typename Unsigned>
  Unsigned whole() {
    Unsigned value = 0;
    if (bytes_.size() < sizeof(Unsigned)) {
      is_sound_ = false;
      return value;
    }
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
      value = static_cast<Unsigned>(value | (static_cast<std::uint64_t>(bytes_[i]) << (8 * i)));
    }
    bytes_ = bytes_.subspan(sizeof(Unsigned));
    return value;
  }
  double real() {
    const double value = std::bit_cast<float>(whole<std::uint32_t>());
    is_sound_ = is_sound_ && std::isfinite(value);
    return value;
  }
  Eigen::Vector3d vector() {
    const double x = real();
    const double y = real();
    return {x, y, real()};
  }
  [[nodiscard]] bool is_sound() const { return is_sound_; }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool is_sound_ = true;
};

std::uint16_t fields_of(const ObjectParameters& parameters) {
  unsigned present = parameters.limit_surface ? kHasLimitSurface : 0U;
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    if (parameters.*kFields[i]) present |= 1U << i;
  }
  return static_cast<std::uint16_t>(present);
}

void write(const ObjectParameters& parameters, Writer& writer) {
  writer.whole(fields_of(parameters));
  for (std::size_t i = 0; i < kFields.size(); ++i) {
    const std::optional<ParameterValue>& value = parameters.*kFields[i];
    if (!value) continue;
    writer.real(value->value);
    if (i == kLimitingFriction) writer.real(value->deviation.value_or(0.0));
  }
  if (!parameters.limit_surface) return;
  writer.real(parameters.limit_surface->force);
  writer.real(parameters.limit_surface->length);
  for (const double coefficient : parameters.limit_surface->coefficients) writer.real(coefficient);
}

ObjectParameters read_parameters(Reader& reader) {
  ObjectParameters parameters;
  const auto present = reader.whole<std::uint16_t>();
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

bool are_known(std::uint8_t flags) {
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
  Writer writer;
  writer.whole(static_cast<std::uint8_t>(flags));
  writer.whole(static_cast<std::uint8_t>(message.object));
  writer.whole(message.sequence);
  writer.whole(static_cast<std::uint32_t>(units));
  if (message.place) {
    for (const double value : {message.place->x, message.place->y, message.place->yaw}) {
      writer.real(value);
    }
  }
  for (const auto& vector : {message.twist, message.lead_out}) {
    if (!vector) continue;
    for (const double value : *vector) writer.real(value);
  }
  if (has_parameters) write(message.parameters, writer);
  return writer.bytes;
}

std::optional<CorrectionMessage> decode(std::span<const std::uint8_t> bytes, double epoch) {
  Reader reader(bytes);
  CorrectionMessage message;
  const auto flags = reader.whole<std::uint8_t>();
  if (!are_known(flags)) return std::nullopt;
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
  if ((flags & kHasParameters) != 0) message.parameters = read_parameters(reader);
  if (!reader.is_sound() || !reader.is_at_end()) return std::nullopt;
  return message;
}

std::size_t bytes_of_tracked_pose() { return encode({.place = PlanarPlace{}}, 0.0).size(); }

std::size_t bytes_of_wrench_sample() {
  return encode({.lead_out = Eigen::Vector3d::Zero()}, 0.0).size();
}

}  // namespace pcavr
