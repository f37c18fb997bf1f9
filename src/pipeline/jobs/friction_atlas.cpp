// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "friction_atlas.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/csv_field.hpp"
#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/parquet.hpp"

namespace pcavr {
namespace {

struct AtlasKey {
  const char* key;  ///< as in the parameter file
  std::optional<ParameterValue> ObjectParameters::*value;
  const char* unit;
};
const std::array<AtlasKey, 4> kKeys{
    {{"sliding_friction_coefficient", &ObjectParameters::sliding_friction_coefficient, "1"},
     {"limiting_static_friction", &ObjectParameters::limiting_static_friction, "N"},
     {"viscous_friction", &ObjectParameters::viscous_friction, "N s/m"},
     {"friction_radius", &ObjectParameters::friction_radius, "m"}}};

std::string origin_of(const std::string& key, const ObjectParameters& parameters) {
  return std::ranges::count(parameters.sources.given, key) > 0 ? "given" : "identified";
}

/// Rows of one object on one support.
class ObjectRows {
 public:
  explicit ObjectRows(AtlasRow common) : common_(std::move(common)) {}

  void add(const std::string& key, const std::optional<ParameterValue>& value, const char* unit,
           const std::string& origin) {
    AtlasRow row = common_;
    row.key = key;
    row.unit = unit;
    row.origin = value ? origin : "not identified";
    if (value) row.value = value->value;
    if (value) row.std = value->std;
    rows_.push_back(std::move(row));
  }
  /// The surface's scales, which count as exact, and coefficients.
  void add_surface(const ObjectParameters& parameters, const SurfaceStd& std) {
    const std::optional<LimitSurface>& surface = parameters.limit_surface;
    if (!surface) return add("limit_surface", {}, "1", {});
    const std::string origin = origin_of("limit_surface", parameters);
    add("limit_surface.force", ParameterValue{surface->force}, "N", origin);
    add("limit_surface.length", ParameterValue{surface->length}, "m", origin);
    for (std::size_t i = 0; i < surface->coefficients.size(); ++i) {
      const auto& [x, y, m] = kQuarticExponents[i];
      const std::optional<double> own = std ? std::optional((*std)[i]) : std::nullopt;
      add(fmt::format("limit_surface.fx{}_fy{}_m{}", x, y, m),
          ParameterValue{surface->coefficients[i], own}, "1", origin);
    }
  }
  [[nodiscard]] std::vector<AtlasRow> take() { return std::move(rows_); }

 private:
  AtlasRow common_;
  std::vector<AtlasRow> rows_;
};

std::string format_csv(const std::vector<AtlasRow>& rows) {
  const auto number = [](const std::optional<double>& value) {
    return value ? shortest_decimal(*value) : std::string();
  };
  std::string text = "object,support,recordings,key,value,std,unit,origin\n";
  for (const AtlasRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{}\n", csv_field(row.object), csv_field(row.support),
                        row.recordings, row.key, number(row.value), number(row.std), row.unit,
                        row.origin);
  }
  return text;
}

template <typename Value, typename Get>
ParquetColumn column(const char* name, const std::vector<AtlasRow>& rows, const Get& get) {
  std::vector<Value> values;
  values.reserve(rows.size());
  for (const AtlasRow& row : rows) values.push_back(get(row));
  return {name, std::move(values)};
}

ParquetColumns parquet_columns(const std::vector<AtlasRow>& rows) {
  const auto texts = [&](const char* name, std::string AtlasRow::*text) {
    return column<std::string>(name, rows, [&](const AtlasRow& row) { return row.*text; });
  };
  const auto numbers = [&](const char* name, std::optional<double> AtlasRow::*number) {
    return column<std::optional<double>>(name, rows,
                                         [&](const AtlasRow& row) { return row.*number; });
  };
  return {texts("object", &AtlasRow::object),
          texts("support", &AtlasRow::support),
          column<std::int64_t>(
              "recordings", rows,
              [](const AtlasRow& row) { return static_cast<std::int64_t>(row.recordings); }),
          texts("key", &AtlasRow::key),
          numbers("value", &AtlasRow::value),
          numbers("std", &AtlasRow::std),
          texts("unit", &AtlasRow::unit),
          texts("origin", &AtlasRow::origin)};
}

}  // namespace

std::vector<AtlasRow> atlas_rows_of(const std::string& object, const std::string& support,
                                    std::size_t recordings, const ObjectParameters& parameters,
                                    const SurfaceStd& surface_std) {
  ObjectRows rows({.object = object, .support = support, .recordings = recordings});
  for (const AtlasKey& entry : kKeys)
    rows.add(entry.key, parameters.*entry.value, entry.unit, origin_of(entry.key, parameters));
  rows.add_surface(parameters, surface_std);
  return rows.take();
}

Expected<void> write_atlas(const std::vector<AtlasRow>& rows, const std::filesystem::path& folder) {
  const Expected<void> written = write_file(folder / "friction_atlas.csv", format_csv(rows));
  if (!written) return written;
  const std::array table{parquet_columns(rows)};
  return write_file(folder / "friction_atlas.parquet", format_parquet(table));
}

Expected<std::map<std::string, SurfaceStd>> read_surface_stds(const std::filesystem::path& report) {
  const Expected<std::string> text = read_file(report);
  if (!text) return text.error();
  std::map<std::string, SurfaceStd> stds;
  try {
    for (const nlohmann::json& object : nlohmann::json::parse(*text).at("objects")) {
      const auto surface = object.find("limit_surface");
      if (surface == object.end() || !surface->contains("coefficients_std")) continue;
      stds[object.at("name").get<std::string>()] =
          surface->at("coefficients_std").get<std::array<double, 15>>();
    }
  } catch (const nlohmann::json::exception& failure) {
    return Error{.message = std::string("is no report of pcavr: ") + failure.what(),
                 .file = report.string()};
  }
  return stds;
}

}  // namespace pcavr
