// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/evaluate.hpp"

#include <utility>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/ply_file.hpp"
#include "pcavr/physics/object/parameters_file.hpp"

#include "comparison_side.hpp"
#include "findings.hpp"
#include "report.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

struct Evaluation {
  Report report;
  Findings findings;
};

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

ComparisonSide parameter_side(const fs::path& file) {
  ComparisonSide side;
  side.kind = SideKind::parameters;
  side.folder = file;
  return side;
}

/// A parameter file against another, or that of a truth or a run.
Expected<Evaluation> evaluate_parameters(const EvaluationInput& input) {
  if (input.reference.empty()) {
    return Error{.message = "is a parameter file, but no reference was given",
                 .file = input.subject.string(),
                 .hint = "give --truth, or a second parameter file as --reference"};
  }
  const fs::path reference =
      is_file(input.reference) ? input.reference : input.reference / "parameters.yaml";
  const Expected<ParameterTable> estimate = read_parameters(input.subject);
  if (!estimate) return estimate.error();
  const Expected<ParameterTable> truth = read_parameters(reference);
  if (!truth) return truth.error();
  Evaluation evaluation;
  evaluation.findings.parameters = parameter_errors(*truth, *estimate);
  evaluation.findings.has_true_parameters = true;
  evaluation.report =
      make_report(parameter_side(reference), parameter_side(input.subject), evaluation.findings);
  return evaluation;
}

Expected<ComparisonSide> read_reference(const EvaluationInput& input, ComparisonSide& subject) {
  if (!input.reference.empty()) return read_side(input.reference);
  if (subject.kind == SideKind::run) return extract_tracking(subject);
  return Error{.message = "is a " + name_of(subject.kind) + ", but no reference was given",
               .file = subject.folder.string(),
               .hint = "give --truth, or a second scene as --reference"};
}

Expected<Evaluation> compare_sides(const EvaluationInput& input, Parallelism parallelism,
                                   const Observer& observer) {
  if (is_file(input.subject)) return evaluate_parameters(input);
  Expected<ComparisonSide> subject = read_side(input.subject);
  if (!subject) return subject.error();
  const Expected<ComparisonSide> reference = read_reference(input, *subject);
  if (!reference) return reference.error();
  Expected<Findings> findings = compare(*reference, *subject, input.options, parallelism, observer);
  if (!findings) return findings.error();
  Evaluation evaluation;
  evaluation.report = make_report(*reference, *subject, *findings);
  evaluation.findings = std::move(findings).value();
  return evaluation;
}

Expected<Evaluation> evaluate_sides(const EvaluationInput& input, Parallelism parallelism,
                                    const Observer& observer) {
  Expected<Evaluation> evaluation = compare_sides(input, parallelism, observer);
  if (evaluation) evaluation->report.configuration = input.configuration;
  return evaluation;
}

}  // namespace

Expected<std::string> evaluate(const EvaluationInput& input, const fs::path& report_folder,
                               Parallelism parallelism, const Observer& observer) {
  const Expected<Evaluation> evaluation = evaluate_sides(input, parallelism, observer);
  if (!evaluation) return evaluation.error();
  const auto& [report, findings] = *evaluation;
  const std::string json = format_json(report, findings);
  Expected<void> written = write_file(report_folder / "report.json", json);
  if (!written) return written.error();
  if (findings.surface) {
    written =
        write_file(report_folder / kErrorMeshFile, format_ply(findings.surface->map.mesh_base));
    if (!written) return written.error();
  }
  written = write_report_page(evaluation_page(report, findings), report_folder);
  if (!written) return written.error();
  return json;
}

Expected<std::string> evaluation_metrics(const EvaluationInput& input, Parallelism parallelism,
                                         const Observer& observer) {
  const Expected<Evaluation> evaluation = evaluate_sides(input, parallelism, observer);
  if (!evaluation) return evaluation.error();
  return format_json(evaluation->report, evaluation->findings);
}

}  // namespace pcavr
