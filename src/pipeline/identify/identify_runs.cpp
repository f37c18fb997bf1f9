// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/physics/object_identification/combine_with_known.hpp"
#include "pcavr/physics/object_identification/run_scatter.hpp"

#include "contact_motion.hpp"
#include "surface_std.hpp"

namespace pcavr {
namespace {

/// Stds from the other runs beyond which a run is left out: of honest stds one run in a million.
constexpr double kMaxDeviation = 5.0;
/// Relative scatter of friction from run to run that is always expected: by some per cent dry
/// surfaces differ from day to day, which three others need not show.
constexpr double kMinScatter = 0.02;
/// Of the runs: more that disagree are no exceptions.
constexpr double kMaxLeftOut = 1.0 / 3.0;
constexpr double kSpeedUnit = 1e-3;  // [m/s] ranges of speed begin at powers of two of it
constexpr double kRunGap = 10.0;     // [s] from the end of one run to the begin of the next
constexpr const char* kCompared[] = {"limiting_static_friction", "sliding_friction_coefficient"};

/// The runs, what is known of each alone, and how they follow each other.
struct RunData {
  const std::vector<IdentificationRun>& runs;
  std::vector<double> delays = {};  ///< [s] by which each run's stamps are moved
  std::vector<TipPath> tips = {};   ///< without outliers
};

/// A run that touched an object, and the object's place there.
struct Touching {
  std::size_t run = 0;
  std::size_t object = 0;
};

Error run_error(const IdentificationRun& run, const std::string& message, const std::string& hint) {
  return {.message = message, .file = run.name, .place = {}, .hint = hint};
}

bool is_same_body(const IdentifiableObject& a, const IdentifiableObject& b) {
  return a.model.mesh_object.vertices == b.model.mesh_object.vertices &&
         a.model.mesh_object.triangles == b.model.mesh_object.triangles;
}

std::optional<Error> check_object(const IdentificationRun& first, const IdentifiableObject& before,
                                  const IdentificationRun& run, const IdentifiableObject& object) {
  const auto differs = [&](const std::string& what) {
    return run_error(run,
                     fmt::format("{} has another {} than in {}", object.name, what, first.name),
                     "give one object one name, and others another");
  };
  if (!is_same_body(before, object)) return differs("CAD body");
  if (before.mass != object.mass) return differs("mass");
  if (before.is_movable != object.is_movable) return differs("entry movable");
  return std::nullopt;
}

/// Errors that no contact shows: of runs that are not of one kind, or one.
std::optional<Error> check_runs(const std::vector<IdentificationRun>& runs) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> first;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const IdentificationInput& input = runs[k].input;
    if (input.tool_radius != runs[0].input.tool_radius)
      return run_error(runs[k], "has another tool_radius than " + runs[0].name,
                       "identify runs of one tip together");
    for (std::size_t j = 0; j < k; ++j) {
      const IdentificationInput& other = runs[j].input;
      if (runs[j].start == runs[k].start && other.t_force == input.t_force &&
          other.force_base == input.force_base)
        return run_error(runs[k], "is the same recording as " + runs[j].name, "give each one once");
    }
    for (std::size_t i = 0; i < input.objects.size(); ++i) {
      const auto [entry, is_new] = first.try_emplace(input.objects[i].name, k, i);
      if (is_new) continue;
      const auto [run, object] = entry->second;
      if (auto error =
              check_object(runs[run], runs[run].input.objects[object], runs[k], input.objects[i]))
        return error;
    }
  }
  return std::nullopt;
}

/// The parameters that one run identified alone, by name.
const ParameterFinding* identified_row(const ObjectIdentification& found, const std::string& name) {
  const auto row = std::ranges::find(found.findings, name, &ParameterFinding::name);
  const bool is_found = row != found.findings.end() && row->is_excited && row->std &&
                        *row->std > 0.0 && std::isfinite(*row->std);
  return is_found ? &*row : nullptr;
}

PooledParameter in_runs(const std::string& name, const std::vector<Touching>& runs,
                        const std::vector<Identification>& alone) {
  PooledParameter parameter{.name = name, .unit = {}};
  std::vector<ParameterValue> values;
  for (const Touching& one : runs) {
    const ParameterFinding* row = identified_row(alone[one.run].objects[one.object], name);
    if (row == nullptr) continue;
    parameter.unit = row->unit;
    parameter.runs.push_back({one.run, {row->value, row->std}});
    values.push_back(parameter.runs.back().value);
  }
  const std::vector<double> deviations = deviations_of_runs(values, kMinScatter);
  for (std::size_t i = 0; i < deviations.size(); ++i)
    parameter.runs[i].stds_from_others = deviations[i];
  return parameter;
}

/// The run that contradicts the others most, if one does.
std::optional<std::size_t> worst_run(const std::vector<Touching>& runs,
                                     const std::vector<Identification>& alone, std::string& why) {
  std::optional<std::size_t> worst;
  double most = kMaxDeviation;
  for (const char* name : kCompared) {
    for (const PooledParameter::Run& run : in_runs(name, runs, alone).runs) {
      if (std::abs(run.stds_from_others) <= most) continue;
      most = std::abs(run.stds_from_others);
      worst = run.run;
      why = fmt::format("its {} is {:.1f} stds {} those of the others", name, most,
                        run.stds_from_others > 0.0 ? "above" : "below");
    }
  }
  return worst;
}

/// Takes runs that contradict the others out of `runs`.
std::vector<std::size_t> leave_out_runs(const std::string& object, std::vector<Touching>& runs,
                                        PooledIdentification& result) {
  const std::vector<Touching> all = runs;
  std::vector<std::size_t> left_out;
  std::vector<std::string> reasons;
  std::string why;
  while (const std::optional<std::size_t> worst = worst_run(runs, result.alone, why)) {
    std::erase_if(runs, [&](const Touching& one) { return one.run == *worst; });
    left_out.push_back(*worst);
    reasons.push_back(why);
  }
  if (static_cast<double>(left_out.size()) > kMaxLeftOut * static_cast<double>(all.size())) {
    result.warnings.push_back(fmt::format(
        "{}: the runs contradict each other ({} of {} by more than {:.0f} stds): all are used, and "
        "the std contains their scatter",
        object, left_out.size(), all.size(), kMaxDeviation));
    runs = all;
    return {};
  }
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    result.warnings.push_back(
        fmt::format("{}: {} is left out: {}", object, result.runs[left_out[i]], reasons[i]));
  }
  return left_out;
}

/// The runs' own effects are common to all contacts of a run: no number of contacts averages them.
void add_scatter(PooledParameter& parameter, ParameterFinding& row, ObjectIdentification& found) {
  std::vector<ParameterValue> values;
  for (const PooledParameter::Run& run : parameter.runs) values.push_back(run.value);
  if (values.empty()) return;
  parameter.scatter = scatter_of_runs(values).scatter;
  const double share = parameter.scatter / std::sqrt(static_cast<double>(values.size()));
  row.std = std::hypot(row.std.value_or(0.0), share);
  if (std::optional<ParameterValue>* value = find_parameter(row.name, found.parameters);
      value != nullptr && *value)
    (*value)->std = row.std;
  if (row.name != "sliding_friction_coefficient" || row.value <= 0.0) return;
  for (SlidingForce& force : found.parameters.sliding_force)
    force.std = std::hypot(force.std, share / row.value * force.force);
}

/// What the contacts of these runs show together.
ObjectIdentification identify_together(const std::string& name,
                                       const std::vector<Touching>& touching, const RunData& data,
                                       const IdentificationOptions& options,
                                       const PooledIdentification& result) {
  const Touching& first = touching.front();
  const IdentificationInput& input = data.runs[first.run].input;
  const auto known = input.known.find(name);
  ObjectIdentifier identifier(input.objects[first.object],
                              known == input.known.end() ? ObjectParameters() : known->second,
                              input.tool_radius, result.goal, options);
  for (const Touching& one : touching) {
    const Identification& alone = result.alone[one.run];
    const auto tracked =
        on_clock(data.runs[one.run].input.objects[one.object].tracked, alone.inputs.camera_shift());
    for (const auto& contact :
         contacts_with_motion(alone.contacts, one.object, data.tips[one.run], tracked)) {
      Contact moved = delayed(*contact, data.delays[one.run]);
      moved.object = 0;
      identifier.add(std::make_shared<const Contact>(std::move(moved)));
    }
  }
  return identifier.result().object;
}

/// Each parameter that the runs show together, with its scatter, which goes into the stds of
/// `found`.
std::vector<PooledParameter> parameters_of(const std::vector<Touching>& touching,
                                           const PooledIdentification& result,
                                           ObjectIdentification& found) {
  std::vector<PooledParameter> parameters;
  for (ParameterFinding& row : found.findings) {
    if (!row.is_excited) continue;
    PooledParameter& parameter = parameters.emplace_back(in_runs(row.name, touching, result.alone));
    parameter.unit = row.unit;
    add_scatter(parameter, row, found);
    parameter.pooled = {row.value, row.std};
  }
  return parameters;
}

std::vector<std::size_t> runs_of(const std::vector<Touching>& touching) {
  std::vector<std::size_t> runs;
  for (const Touching& one : touching) runs.push_back(one.run);
  return runs;
}

/// The typical speed of an object's slides in one run, as the range that it is in: each is twice
/// as fast as the one before. The first number is the key to order them by.
std::pair<int, std::string> speed_range(const ObjectIdentification& found) {
  std::vector<double> speeds;
  for (const FrictionSample& sample : found.slide_samples) speeds.push_back(std::abs(sample.speed));
  const double speed = speeds.empty() ? 0.0 : median(std::move(speeds));
  if (!(speed > 0.0)) return {std::numeric_limits<int>::min(), "no slide"};
  const int octave = static_cast<int>(std::floor(std::log2(speed / kSpeedUnit)));
  return {octave, fmt::format("{:g} to {:g} mm/s", std::exp2(octave), std::exp2(octave + 1))};
}

std::vector<PooledGroup> groups_of(const std::string& name, const std::vector<Touching>& touching,
                                   const RunData& data, RunGrouping grouping,
                                   const IdentificationOptions& options,
                                   const PooledIdentification& result) {
  if (grouping == RunGrouping::object) return {};
  std::map<std::pair<int, std::string>, std::vector<Touching>> by_key;
  for (const Touching& one : touching) {
    const auto key = grouping == RunGrouping::support
                         ? std::pair(0, data.runs[one.run].support)
                         : speed_range(result.alone[one.run].objects[one.object]);
    by_key[key].push_back(one);
  }
  std::vector<PooledGroup> groups;
  for (const auto& [key, of_group] : by_key) {
    ObjectIdentification found = identify_together(name, of_group, data, options, result);
    groups.push_back({key.second, runs_of(of_group), parameters_of(of_group, result, found)});
  }
  return groups;
}

PooledObject pool(const std::string& name, std::vector<Touching> touching, const RunData& data,
                  RunGrouping grouping, const IdentificationOptions& options,
                  PooledIdentification& result) {
  PooledObject pooled{.name = name, .found = {}};
  pooled.left_out = leave_out_runs(name, touching, result);
  pooled.runs = runs_of(touching);
  pooled.found = identify_together(name, touching, data, options, result);
  for (const Touching& one : touching)
    add_recordings(result.alone[one.run].objects[one.object].recordings, pooled.found);
  pooled.parameters = parameters_of(touching, result, pooled.found);
  const IdentifiableObject& object =
      data.runs[touching.front().run].input.objects[touching.front().object];
  pooled.surface_std = surface_std_of(
      pooled.found, object.model,
      object.tracked.empty() ? object.T_base_object : object.tracked.front().T_base_object,
      options.limit_surface);
  pooled.groups = groups_of(name, touching, data, grouping, options, result);
  const ParameterTable& known = data.runs[touching.front().run].input.known;
  if (const auto before = known.find(name); before != known.end())
    combine_with_known(before->second, pooled.found);
  for (PooledParameter& parameter : pooled.parameters) {
    const auto row =
        std::ranges::find(pooled.found.findings, parameter.name, &ParameterFinding::name);
    parameter.pooled = {row->value, row->std};
  }
  return pooled;
}

/// [s] By which each run's stamps are moved, so that all runs are one after the other.
std::vector<double> delays_of(const std::vector<IdentificationRun>& runs) {
  std::vector<double> delays;
  double end = 0.0;
  for (const IdentificationRun& run : runs) {
    double first = run.input.t_tool.front(), last = run.input.t_tool.back();
    for (const IdentifiableObject& object : run.input.objects) {
      if (object.tracked.empty()) continue;
      first = std::min(first, object.tracked.front().t);
      last = std::max(last, object.tracked.back().t);
    }
    delays.push_back(end - first);
    end += last - first + kRunGap;
  }
  return delays;
}

}  // namespace

ParameterTable PooledIdentification::parameters() const {
  ParameterTable table = known;
  for (const PooledObject& object : objects) table[object.name] = object.found.parameters;
  return table;
}

Expected<PooledIdentification> identify_runs(std::vector<IdentificationRun> runs,
                                             IdentificationGoal goal,
                                             const IdentificationOptions& options,
                                             RunGrouping grouping, const Observer& observer) {
  std::ranges::sort(runs, [](const IdentificationRun& a, const IdentificationRun& b) {
    return std::pair(a.start, a.name) < std::pair(b.start, b.name);
  });
  for (const IdentificationRun& run : runs) {
    if (auto error = missing_streams(run.input)) {
      error->file = run.name + "/" + error->file;
      return *error;
    }
  }
  if (const auto error = check_runs(runs)) return *error;
  PooledIdentification result{.goal = goal, .grouping = grouping, .runs = {}, .alone = {}};
  std::map<std::string, std::vector<Touching>> touched;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    Expected<Identification> found = identify(runs[k].input, goal, options);
    if (!found) {
      Error error = found.error();
      error.file = error.file.empty() ? runs[k].name : runs[k].name + "/" + error.file;
      return error;
    }
    for (const std::string& warning : found->warnings)
      result.warnings.push_back(runs[k].name + ": " + warning);
    for (std::size_t i = 0; i < found->objects.size(); ++i) {
      const bool is_touched = std::ranges::any_of(
          found->contacts, [i](const Contact& contact) { return contact.object == i; });
      if (is_touched) touched[found->objects[i].name].push_back({k, i});
    }
    result.runs.push_back(runs[k].name);
    result.alone.push_back(std::move(*found));
    observer.on_progress("identifying runs", k + 1, runs.size());
  }
  RunData data{.runs = runs, .delays = delays_of(runs)};
  for (const IdentificationRun& run : runs) {
    data.tips.push_back(clean_tip_path(run.input.t_tool, run.input.p_base_tip, options.inputs));
  }
  for (auto& [name, touching] : touched) {
    result.objects.push_back(pool(name, std::move(touching), data, grouping, options, result));
  }
  return result;
}

}  // namespace pcavr
