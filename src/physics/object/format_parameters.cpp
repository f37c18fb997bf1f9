// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/physics/object/contact_units.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

#include "physics/object/parameter_fields.hpp"

namespace pcavr {
namespace {

using namespace parameter_file;

void emit_field(YAML::Emitter& out, const Field& field, const ObjectParameters& parameters) {
  const std::optional<ParameterValue>& parameter = parameters.*field.member;
  if (!parameter) return;
  out << YAML::Key << field.key << YAML::Value << shortest_decimal(parameter->value);
  if (parameter->std && std::isfinite(*parameter->std)) {
    out << YAML::Key << std_key(field) << YAML::Value << shortest_decimal(*parameter->std);
  }
}

void emit_contact(YAML::Emitter& out, const ObjectParameters& parameters) {
  const double exponent = parameters.contact_exponent ? parameters.contact_exponent->value : 1.0;
  out << YAML::Key << "contact" << YAML::Value << YAML::BeginMap;
  if (parameters.contact_stiffness) {
    out << YAML::Key << "law" << YAML::Value
        << std::string(contact_law_name(exponent, parameters.contact_mass.has_value()));
  }
  for (const Field& field : kContactFields) emit_field(out, field, parameters);
  if (const auto& offset = parameters.contact_surface_offset) {
    out << YAML::Key << "surface_offset" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const double value : *offset) out << shortest_decimal(value);
    out << YAML::EndSeq;
  }
  if (parameters.contact_damping) {
    out << YAML::Key << "damping_unit" << YAML::Value << damping_unit(exponent);
    const auto& law = parameters.contact_damping_law;
    const bool is_fitted = parameters.sources.presses.contains("contact.damping");
    if (law || is_fitted) {
      out << YAML::Key << "damping_law" << YAML::Value
          << (law ? std::string(key_of(*law)) : std::string(kFittedDamping));
    }
  }
  out << YAML::EndMap;
}

void emit_limit_surface(YAML::Emitter& out, const LimitSurface& surface) {
  out << YAML::Key << "limit_surface" << YAML::Value << YAML::BeginMap;
  out << YAML::Key << "force" << YAML::Value << shortest_decimal(surface.force);
  out << YAML::Key << "length" << YAML::Value << shortest_decimal(surface.length);
  out << YAML::Key << "coefficients" << YAML::Value << YAML::Flow << YAML::BeginSeq;
  for (const double coefficient : surface.coefficients) out << shortest_decimal(coefficient);
  out << YAML::EndSeq << YAML::EndMap;
}

void emit_sliding_force(YAML::Emitter& out, const std::vector<SlidingForce>& rows) {
  if (rows.empty()) return;
  out << YAML::Key << "sliding_force" << YAML::Value << YAML::BeginSeq;
  for (const SlidingForce& row : rows) {
    out << YAML::Flow << YAML::BeginMap;
    out << YAML::Key << "speed" << YAML::Value << shortest_decimal(row.speed);
    out << YAML::Key << "force" << YAML::Value << shortest_decimal(row.force);
    out << YAML::Key << "std" << YAML::Value << shortest_decimal(row.std) << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_counts(YAML::Emitter& out, const char* key, const std::map<std::string, int>& counts) {
  if (counts.empty()) return;
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  for (const auto& [name, count] : counts) out << YAML::Key << name << YAML::Value << count;
  out << YAML::EndMap;
}

void emit_sources(YAML::Emitter& out, const ParameterSources& sources) {
  if (!sources.given.empty()) {
    out << YAML::Key << "given" << YAML::Value << YAML::Flow << sources.given;
  }
  emit_counts(out, "pushes", sources.pushes);
  emit_counts(out, "presses", sources.presses);
  emit_counts(out, "impacts", sources.impacts);
  if (!sources.recordings.empty()) {
    out << YAML::Key << "recordings" << YAML::Value << YAML::Flow << YAML::BeginSeq;
    for (const std::string& id : sources.recordings) out << YAML::DoubleQuoted << id;
    out << YAML::EndSeq;
  }
  if (sources.correlated.empty()) return;
  out << YAML::Key << "correlation" << YAML::Value << YAML::BeginMap;
  out << YAML::Key << "parameters" << YAML::Value << YAML::Flow << sources.correlated;
  out << YAML::Key << "matrix" << YAML::Value << YAML::BeginSeq;
  const std::size_t size = sources.correlated.size();
  PCAVR_REQUIRE(sources.correlation.size() == size * size, sources.correlation.size(), size);
  for (std::size_t row = 0; row < size; ++row) {
    out << YAML::Flow << YAML::BeginSeq;
    for (std::size_t column = 0; column < size; ++column) {
      out << shortest_decimal(sources.correlation[row * size + column]);
    }
    out << YAML::EndSeq;
  }
  out << YAML::EndSeq << YAML::EndMap;
}

void emit_object(YAML::Emitter& out, const ObjectParameters& parameters) {
  out << YAML::BeginMap;
  for (const Field& field : kFields) emit_field(out, field, parameters);
  if (parameters.contact_stiffness || parameters.contact_damping || parameters.contact_exponent) {
    emit_contact(out, parameters);
  }
  if (parameters.limit_surface) emit_limit_surface(out, *parameters.limit_surface);
  emit_sliding_force(out, parameters.sliding_force);
  emit_sources(out, parameters.sources);
  out << YAML::EndMap;
}

/// Each line prefixed by '#'.
std::string as_comment(const std::string& comment) {
  std::string text;
  const std::string readable = as_utf8_text(comment);
  LineReader lines(readable);
  while (const auto line = lines.next()) {
    text += line->empty() ? std::string("#") : "# " + std::string(*line);
    text += '\n';
  }
  return text;
}

}  // namespace

std::string format_parameters(const ParameterTable& table, const std::string& comment) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  out << YAML::Key << kFormatKey << YAML::Value << kFormat;
  for (const auto& [name, parameters] : table) {
    out << YAML::Key << name << YAML::Value;
    emit_object(out, parameters);
  }
  out << YAML::EndMap;
  return as_comment(comment) + out.c_str() + '\n';
}

}  // namespace pcavr
