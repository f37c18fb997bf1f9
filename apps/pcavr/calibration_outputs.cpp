// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration_outputs.hpp"

#include <utility>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/pipeline/calibrate.hpp"

namespace pcavr::app {

std::string CalibrationOutputOption::written_lines() const {
  std::string text = "wrote " + file + '\n';
  if (!report.empty()) text += how_to_open(report) + '\n';
  return text;
}

std::string how_to_use(const std::filesystem::path& calibration) {
  return "to use it: copy " + calibration.string() +
         " into the recording, and name it in recording.yaml: calibration: " +
         calibration.filename().string() + '\n';
}

void add_calibration_output(CLI::App& command, CalibrationOutputOption& output) {
  command.add_option("-o,--output", output.file, "Calibration file to write (YAML)")->required();
  command.add_option("--report", output.report, "Folder for a report with pictures");
  command.add_flag("--force", output.replace,
                   "Replace an existing calibration and report; other files are never replaced");
}

Expected<CalibrationOutputs> CalibrationOutputs::create(
    const CalibrationOutputOption& output, const std::vector<std::filesystem::path>& inputs) {
  std::vector<std::filesystem::path> outputs{output.file};
  if (!output.report.empty()) outputs.emplace_back(output.report);
  const Expected<void> apart = check_outputs(outputs, inputs);
  if (!apart) return apart.error();
  Expected<OutputFile> file = OutputFile::create(
      output.file,
      {.replace = output.replace, .kind = "calibration", .is_replaceable = is_calibration_file});
  if (!file) return file.error();
  CalibrationOutputs created{.file = *std::move(file)};
  if (output.report.empty()) return created;
  Expected<OutputFolder> folder =
      OutputFolder::create(output.report, {.kind = OutputKind::report, .replace = output.replace});
  if (!folder) return folder.error();
  created.report.emplace(*std::move(folder));
  return created;
}

Expected<void> CalibrationOutputs::commit(
    const std::string& text,
    const std::function<Expected<void>(const std::filesystem::path&)>& write_report) {
  Expected<void> done = report ? write_report(report->path()) : Expected<void>();
  if (done) done = file.write(text);
  if (done) done = file.commit();
  if (!done || !report) return done;
  done = report->commit();
  if (!done) file.undo();
  return done;
}

}  // namespace pcavr::app
