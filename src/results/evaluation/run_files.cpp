// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "run_files.hpp"

#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

using Fields = std::span<const std::string_view>;
/// A row's error, if any.
using RowError = std::optional<Error>;
/// Handles a row of an object: its stamp, the object, and the remaining fields.
using RowHandler = std::function<RowError(Stamp, const std::string& object, Fields rest)>;

enum class Stamps { ascend, may_repeat };

struct ObjectTable {
  fs::path file;
  std::vector<std::string> columns;  ///< the first two are "t" and "object"
  Stamps stamps = Stamps::ascend;    ///< of one object
};

std::string header_of(const ObjectTable& table) {
  std::string header;
  for (const std::string& column : table.columns) header += (header.empty() ? "" : ",") + column;
  return header;
}

RowError parse_row(const ObjectTable& table, std::string_view line,
                   std::map<std::string, Stamp, std::less<>>& last, const RowHandler& handle) {
  const std::vector<std::string_view> fields = split_at(',', line);
  if (fields.size() != table.columns.size()) {
    return Error{.message = "has " + std::to_string(fields.size()) + " columns, not " +
                            std::to_string(table.columns.size()),
                 .hint = "each line has " + header_of(table)};
  }
  const Expected<Stamp> stamp = parse_stamp(fields[0]);
  if (!stamp) return stamp.error();
  const std::string object(fields[1]);
  if (object.empty()) {
    return Error{.message = "has no object name", .place = "object", .hint = "write its name"};
  }
  const auto before = last.find(object);
  if (before != last.end() &&
      (*stamp < before->second || (table.stamps == Stamps::ascend && *stamp == before->second))) {
    return Error{.message = "time " + std::string(fields[0]) +
                            " is not after the previous one of " + object + ", " +
                            format_stamp(before->second),
                 .hint = "sort the rows by time and remove duplicates"};
  }
  last[object] = *stamp;
  return handle(*stamp, object, Fields(fields).subspan(2));
}

/// Calls `handle` for each row of a CSV file by object.
Expected<void> read_table(const ObjectTable& table, const RowHandler& handle) {
  const std::string file = table.file.string();
  const Expected<std::string> text = read_file(table.file);
  if (!text) return text.error();
  LineReader lines(*text);
  const Expected<std::vector<std::string>> header = read_header(file, lines);
  if (!header) return header.error();
  if (*header != table.columns) {
    return Error{.message = "has an unexpected header",
                 .file = file,
                 .line = 1,
                 .hint = "the first line must be " + header_of(table)};
  }
  std::map<std::string, Stamp, std::less<>> last;
  while (const std::optional<std::string_view> line = lines.next()) {
    if (trimmed(*line).empty()) continue;
    RowError error = parse_row(table, *line, last, handle);
    if (!error) continue;
    error->file = file;
    error->line = lines.line();
    return *std::move(error);
  }
  return {};
}

RowError append_phase(std::string_view word, const std::string& column, Stamp stamp,
                      PhaseTimeline& timeline) {
  const std::optional<Phase> phase = phase_from_string(word);
  if (!phase) {
    return Error{.message = "'" + std::string(word) + "' is not a phase",
                 .place = column,
                 .hint = "write free, static, critical or sliding"};
  }
  if (timeline.empty() || timeline.back().phase != *phase) timeline.push_back({stamp, *phase});
  return std::nullopt;
}

/// [N] A prediction may exceed any measured force: this only keeps its squares finite.
constexpr InputRange kRunForce{"force of a run", -1e9, 1e9, "N", "keeps squares and sums finite"};
/// [byte] Size of one correction: typically 30 to 100.
constexpr InputRange kMessageSize{"message", 0.0, 1e6, "byte", "far beyond any message"};

RowError read_number(std::string_view field, const std::string& column, const InputRange& range,
                     double& number) {
  const std::optional<double> read = parse_number(field);
  if (!read) {
    return Error{.message = "'" + std::string(field) + "' is not a finite number",
                 .place = column,
                 .hint = "write a decimal number"};
  }
  if (RowError error = check_range(range, *read)) {
    error->place = column;
    return error;
  }
  number = *read;
  return std::nullopt;
}

RowError append_force(Stamp stamp, Fields rest, std::vector<ForceSample>& samples) {
  ForceSample sample{.stamp = stamp};
  RowError error = read_number(rest[0], "measured", kRunForce, sample.measured);
  if (!error) error = read_number(rest[1], "virtual", kRunForce, sample.rendered);
  if (!error) samples.push_back(sample);
  return error;
}

RowError append_correction(Stamp stamp, const std::string& object, Fields rest,
                           std::vector<RunCorrection>& corrections) {
  RunCorrection correction{.stamp = stamp, .object = object, .which = std::string(rest[0])};
  bool is_valid = false;
  for (const char* which : {"1.1", "1.2a", "1.2b", "1.3", "2"}) {
    is_valid = is_valid || correction.which == which;
  }
  if (!is_valid) {
    return Error{.message = "'" + correction.which + "' is not a case of the correction switch",
                 .place = "case",
                 .hint = "write 1.1, 1.2a, 1.2b, 1.3 or 2"};
  }
  for (const std::string_view word : split_at('+', rest[1])) {
    if (word == "lost") {
      correction.is_lost = true;
    } else {
      correction.what.emplace_back(word);
    }
  }
  double bytes = 0.0;
  RowError error = read_number(rest[2], "bytes", kMessageSize, bytes);
  if (error) return error;
  correction.bytes = static_cast<std::size_t>(bytes);
  corrections.push_back(std::move(correction));
  return std::nullopt;
}

Expected<void> read_forces(const fs::path& file, RunFiles& run) {
  return read_table({file, {"t", "object", "measured", "virtual"}},
                    [&](Stamp stamp, const std::string& object, Fields rest) {
                      return append_force(stamp, rest, run.forces[object]);
                    });
}

Expected<void> read_run_phases(const fs::path& file, RunFiles& run) {
  return read_table(
      {file, {"t", "object", "measured", "predicted"}},
      [&](Stamp stamp, const std::string& object, Fields rest) {
        const RowError error = append_phase(rest[0], "measured", stamp, run.measured[object]);
        return error ? error : append_phase(rest[1], "predicted", stamp, run.predicted[object]);
      });
}

Expected<void> read_corrections(const fs::path& file, RunFiles& run) {
  run.corrections.emplace();
  return read_table({file, {"t", "object", "case", "what", "bytes"}, Stamps::may_repeat},
                    [&](Stamp stamp, const std::string& object, Fields rest) {
                      return append_correction(stamp, object, rest, *run.corrections);
                    });
}

/// [SI] A stiffness of a steep law may be large: this only keeps sums finite.
constexpr InputRange kRunParameter{"parameter of a run", -1e30, 1e30, "", "keeps sums finite"};

Expected<void> read_parameter_history(const fs::path& file, RunFiles& run) {
  return read_table(
      {file, {"t", "object", "parameter", "running", "transmitted"}, Stamps::may_repeat},
      [&](Stamp stamp, const std::string& object, Fields rest) {
        ParameterSample sample{.stamp = stamp};
        RowError error = read_number(rest[1], "running", kRunParameter, sample.running);
        if (!error) {
          error = read_number(rest[2], "transmitted", kRunParameter, sample.transmitted);
        }
        if (!error) {
          run.parameter_history[object][std::string(rest[0])].push_back(sample);
        }
        return error;
      });
}

Expected<void> read_parameters_into(const fs::path& file, std::optional<ParameterTable>& table) {
  Expected<ParameterTable> read = read_parameters(file);
  if (!read) return read.error();
  table = std::move(read).value();
  return {};
}

Expected<void> read_settings(const fs::path& file, RunFiles& run) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<RunSettings> settings = parse_run_settings(*text, file.string());
  if (!settings) return settings.error();
  run.settings = std::move(settings).value();
  return {};
}

/// Reads each file that exists, up to the first Error.
Expected<void> read_existing(
    const fs::path& folder,
    const std::vector<std::pair<const char*, std::function<Expected<void>(const fs::path&)>>>&
        readers) {
  for (const auto& [name, read] : readers) {
    const Expected<bool> present = is_present(folder / name);
    if (!present) return present.error();
    if (!*present) continue;
    const Expected<void> done = read(folder / name);
    if (!done) return done;
  }
  return {};
}

}  // namespace

Expected<RunFiles> read_run_files(const fs::path& folder) {
  RunFiles run;
  if (const Expected<void> complete = check_line_counts(folder / "run.yaml"); !complete) {
    return complete.error();
  }
  const Expected<void> read = read_existing(
      folder,
      {{"run.yaml", [&](const fs::path& file) { return read_settings(file, run); }},
       {"force.csv", [&](const fs::path& file) { return read_forces(file, run); }},
       {"phases.csv", [&](const fs::path& file) { return read_run_phases(file, run); }},
       {"corrections.csv", [&](const fs::path& file) { return read_corrections(file, run); }},
       {"parameters.csv", [&](const fs::path& file) { return read_parameter_history(file, run); }},
       {"parameters.yaml",
        [&](const fs::path& file) { return read_parameters_into(file, run.parameters); }}});
  if (!read) return read.error();
  return run;
}

Expected<TruthFiles> read_truth_files(const fs::path& folder) {
  TruthFiles truth;
  const auto read_phases = [&](const fs::path& file) {
    return read_table({file, {"t", "object", "phase"}},
                      [&](Stamp stamp, const std::string& object, Fields rest) {
                        return append_phase(rest[0], "phase", stamp, truth.phases[object]);
                      });
  };
  const Expected<void> read = read_existing(
      folder, {{"phase.csv", read_phases}, {"parameters.yaml", [&](const fs::path& file) {
                                              return read_parameters_into(file, truth.parameters);
                                            }}});
  if (!read) return read.error();
  return truth;
}

}  // namespace pcavr
