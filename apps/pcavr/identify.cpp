// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <filesystem>
#include <optional>

#include <fmt/core.h>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/object/parameters_file.hpp"
#include "pcavr/physics/object_identification/combine_with_known.hpp"
#include "pcavr/pipeline/identify_runs.hpp"
#include "pcavr/pipeline/plan_motion.hpp"
#include "pcavr/pipeline/support_name.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "commands.hpp"
#include "damping_option.hpp"
#include "identify_plan.hpp"
#include "identify_robot.hpp"
#include "list_recordings.hpp"
#include "output_option.hpp"

namespace pcavr::app {
namespace {

struct IdentifyArguments {
  IdentificationGoal goal = IdentificationGoal::contact;
  std::vector<std::string> recordings;
  std::vector<std::string> scenes;  ///< none, one for all recordings, or one for each
  std::string tracked;
  std::string parameters;
  std::string output;
  std::string report;
  std::string plan;
  std::string damping_law = "exact";
  std::string group_by = "object";
  bool replace = false;
  bool skip_bad = false;
  int threads = 1;
};

std::string finding_line(const ParameterFinding& finding) {
  if (!finding.is_excited) return fmt::format("    {:<30} {}\n", finding.name, finding.remark);
  const std::string std_text = finding.std ? fmt::format(" +- {:.2g}", *finding.std) : "";
  return fmt::format("    {:<30} {:.4g}{} {}\n", finding.name, finding.value, std_text,
                     finding.unit);
}

nlohmann::ordered_json object_json(const ObjectIdentification& object) {
  nlohmann::ordered_json json{{"name", object.name}};
  for (const ParameterFinding& finding : object.findings) {
    json[finding.name + ".is_excited"] = finding.is_excited;
    if (!finding.is_excited) continue;
    json[finding.name] = finding.value;
    if (finding.std) json[finding.name + "_std"] = *finding.std;
  }
  json["notes"] = object.notes;
  return json;
}

std::string offset_line(const char* what, const TimeOffset& offset) {
  if (!offset.is_known) return fmt::format("{} after tool: not known\n", what);
  return fmt::format("{} after tool: {:.2f} +- {:.2f} ms\n", what, offset.offset * 1e3,
                     offset.std * 1e3);
}

CommandResult describe(const Identification& found, const IdentifyArguments& arguments) {
  CommandResult result;
  result.summary = offset_line("force   ", found.inputs.tool_to_force) +
                   offset_line("tracking", found.inputs.tool_to_camera);
  for (const std::string& note : found.notes) result.summary += "note: " + note + '\n';
  result.json = {{"parameters", arguments.output}, {"report", arguments.report}};
  result.json["objects"] = nlohmann::ordered_json::array();
  for (const ObjectIdentification& object : found.objects) {
    result.summary += "  " + object.name + '\n';
    for (const ParameterFinding& finding : object.findings) result.summary += finding_line(finding);
    for (const std::string& note : object.notes) result.summary += "    note: " + note + '\n';
    result.json["objects"].push_back(object_json(object));
  }
  result.json["notes"] = found.notes;
  result.json["contacts_left_out"] = found.contacts_left_out();
  for (const auto& [reason, count] : found.contacts_left_out()) {
    result.summary += "not used   contacts: " + reason + ": " + std::to_string(count) + '\n';
  }
  describe_left_out(found.left_out, result);
  result.summary += "wrote " + arguments.output + '\n' + how_to_open(arguments.report) + '\n';
  return result;
}

/// Whether --force may replace the file: one that parses as a parameter file.
bool is_parameter_file(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxSize = 1U << 24U;  // [bytes] about ten thousand objects
  std::error_code code;
  return std::filesystem::file_size(file, code) <= kMaxSize && read_parameters(file).has_value();
}

struct IdentifyOutputs {
  OutputFile parameters;
  OutputFolder report;
  std::optional<OutputFile> plan = std::nullopt;
};

/// Creates the outputs before any work.
Expected<IdentifyOutputs> create_outputs(const IdentifyArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.tracked, arguments.parameters};
  inputs.insert(inputs.end(), arguments.scenes.begin(), arguments.scenes.end());
  inputs.insert(inputs.end(), arguments.recordings.begin(), arguments.recordings.end());
  std::vector<std::filesystem::path> outputs{arguments.output, arguments.report};
  if (!arguments.plan.empty()) outputs.emplace_back(arguments.plan);
  const Expected<void> apart = check_outputs(outputs, inputs);
  if (!apart) return apart.error();
  Expected<OutputFile> parameters =
      OutputFile::create(arguments.output, {.replace = arguments.replace,
                                            .kind = "parameter file",
                                            .is_replaceable = is_parameter_file});
  if (!parameters) return parameters.error();
  Expected<OutputFolder> report =
      create_output({arguments.report, arguments.replace}, OutputKind::report, inputs);
  if (!report) return report.error();
  IdentifyOutputs created{*std::move(parameters), *std::move(report)};
  if (arguments.plan.empty()) return created;
  Expected<OutputFile> plan = create_plan_file(arguments.plan, arguments.replace);
  if (!plan) return plan.error();
  created.plan = *std::move(plan);
  return created;
}

/// Commits all outputs, or none.
Expected<void> commit(IdentifyOutputs& outputs) {
  Expected<void> done = outputs.parameters.commit();
  if (!done) return done;
  if (outputs.plan) done = outputs.plan->commit();
  if (!done) {
    outputs.parameters.undo();
    return done;
  }
  done = outputs.report.commit();
  if (done) return done;
  if (outputs.plan) outputs.plan->undo();
  outputs.parameters.undo();
  return done;
}

Expected<ParameterTable> known_parameters(const IdentifyArguments& arguments) {
  if (arguments.parameters.empty()) return ParameterTable();
  return read_parameters(arguments.parameters);
}

/// The scene of a recording, by its index; empty without one.
std::string scene_of(const IdentifyArguments& arguments, std::size_t recording) {
  if (arguments.scenes.empty()) return {};
  return arguments.scenes.size() == 1 ? arguments.scenes.front() : arguments.scenes[recording];
}

/// What one recording gives to identify from, and its start.
Expected<IdentificationRun> read_run(const IdentifyArguments& arguments, std::size_t index,
                                     Configuration& configuration, const Observer& observer) {
  const Expected<Recording> recording =
      read_with_warnings(arguments.recordings[index], arguments.skip_bad, configuration, observer);
  if (!recording) return recording.error();
  Expected<IdentificationInput> input =
      identification_input(*recording,
                           {.scene = scene_of(arguments, index),
                            .tracked = arguments.tracked,
                            .skip_bad = arguments.skip_bad,
                            .perception = configuration.perception(),
                            .parallelism = {arguments.threads}},
                           observer);
  if (!input) return input.error();
  const Expected<std::filesystem::path> folder = resolve_path(recording->folder);
  if (!folder) return folder.error();
  return IdentificationRun{recording->folder.string(), start_of(*recording), *std::move(input),
                           support_of(*folder)};
}

IdentificationOptions options_of(const IdentifyArguments& arguments,
                                 const Configuration& configuration) {
  IdentificationOptions options = configuration.identification();
  options.damping_law = damping_law_of(arguments.damping_law);  // none: by the criterion
  return options;
}

RunGrouping grouping_of(const std::string& name) {
  if (name == "support") return RunGrouping::support;
  return name == "speed" ? RunGrouping::speed : RunGrouping::object;
}

struct IdentifyResult {
  Identification found;
  std::optional<MotionPlan> plan = {};
};

Expected<IdentifyResult> run(const IdentifyArguments& arguments, Configuration& configuration,
                             const Observer& observer) {
  const Expected<ParameterTable> known = known_parameters(arguments);
  if (!known) return known.error();
  Expected<IdentificationRun> one = read_run(arguments, 0, configuration, observer);
  if (!one) return one.error();
  one->input.known = *known;
  const IdentificationOptions options = options_of(arguments, configuration);
  Expected<Identification> found = identify(one->input, arguments.goal, options);
  if (!found) {
    Error error = found.error();
    if (!error.file.empty()) error.file = (std::filesystem::path(one->name) / error.file).string();
    return error;
  }
  for (const std::string& warning : found->warnings) {
    observer.on_warning(one->name + ": " + warning);
  }
  for (ObjectIdentification& object : found->objects) {
    const auto before = known->find(object.name);
    if (before != known->end()) combine_with_known(before->second, object);
  }
  found->configuration = configuration.changed();
  IdentifyResult result{*std::move(found)};
  if (!arguments.plan.empty()) result.plan = plan_motion(one->input, result.found, options);
  return result;
}

/// Many runs: one answer.
Expected<PooledIdentification> run_pooled(const IdentifyArguments& arguments,
                                          Configuration& configuration, const Observer& observer) {
  const Expected<ParameterTable> known = known_parameters(arguments);
  if (!known) return known.error();
  std::vector<IdentificationRun> runs;
  for (std::size_t i = 0; i < arguments.recordings.size(); ++i) {
    Expected<IdentificationRun> one = read_run(arguments, i, configuration, observer);
    if (!one) return one.error();
    one->input.known = *known;
    runs.push_back(*std::move(one));
    observer.on_progress("reading runs", runs.size(), arguments.recordings.size());
  }
  Expected<PooledIdentification> found =
      identify_runs(std::move(runs), arguments.goal, options_of(arguments, configuration),
                    grouping_of(arguments.group_by), observer);
  if (!found) return found.error();
  for (const std::string& warning : found->warnings) observer.on_warning(warning);
  found->configuration = configuration.changed();
  for (const auto& [name, parameters] : *known) found->known.emplace(name, parameters);
  return found;
}

/// The comment at the top of the parameter file.
std::string comment_of(const Identification& found, const std::string& recording) {
  std::string comment = "identified from " + recording;
  for (const ObjectIdentification& object : found.objects) {
    if (object.friction.is_valid && !object.friction.viscous.is_excited) {
      comment += "\nassumed, not identified: viscous_friction of " + object.name +
                 "; it is valid together with the coefficient, at the speeds that were pushed";
    }
    if (!object.is_exponent_given) continue;
    comment += "\nassumed, not identified: contact.exponent of " + object.name +
               "; its stiffness and damping are valid for this exponent";
  }
  return comment;
}

CommandResult describe(const PooledIdentification& found, const IdentifyArguments& arguments) {
  CommandResult result;
  result.summary = fmt::format("{} runs\n", found.runs.size());
  result.json = {{"parameters", arguments.output}, {"report", arguments.report}};
  result.json["runs"] = found.runs;
  result.json["objects"] = nlohmann::ordered_json::array();
  for (const PooledObject& object : found.objects) {
    result.summary += fmt::format("  {}: {} runs, {} left out\n", object.name, object.runs.size(),
                                  object.left_out.size());
    for (const ParameterFinding& finding : object.found.findings)
      result.summary += finding_line(finding);
    for (const PooledParameter& parameter : object.parameters) {
      if (parameter.scatter <= 0.0) continue;
      result.summary += fmt::format("    {}: {:.2g} {} scatter from run to run\n", parameter.name,
                                    parameter.scatter, parameter.unit);
    }
    for (const std::string& note : object.found.notes) result.summary += "    note: " + note + '\n';
    result.json["objects"].push_back(object_json(object.found));
  }
  result.json["warnings"] = found.warnings;
  result.summary += "wrote " + arguments.output + '\n' + how_to_open(arguments.report) + '\n';
  return result;
}

Expected<CommandResult> identify_recording(const IdentifyArguments& arguments,
                                           Configuration& configuration, const Observer& observer) {
  Expected<IdentifyOutputs> outputs = create_outputs(arguments);
  if (!outputs) return outputs.error();
  const Expected<IdentifyResult> done = run(arguments, configuration, observer);
  if (!done) return done.error();
  const Identification& found = done->found;
  const std::string& recording = arguments.recordings.front();
  Expected<void> written = write_identification_report(found, recording, outputs->report.path());
  if (!written) return written.error();
  written = outputs->parameters.write(
      format_parameters(found.parameters(), comment_of(found, recording)));
  if (!written) return written.error();
  if (done->plan) written = outputs->plan->write(format_path(*done->plan));
  if (!written) return written.error();
  const Expected<void> committed = commit(*outputs);
  if (!committed) return committed.error();
  CommandResult result = describe(found, arguments);
  if (done->plan) add_plan(*done->plan, arguments.plan, result);
  return result;
}

Expected<CommandResult> identify_many(const IdentifyArguments& arguments,
                                      Configuration& configuration, const Observer& observer) {
  Expected<IdentifyOutputs> outputs = create_outputs(arguments);
  if (!outputs) return outputs.error();
  const Expected<PooledIdentification> found = run_pooled(arguments, configuration, observer);
  if (!found) return found.error();
  Expected<void> done = write_pooled_report(*found, outputs->report.path());
  if (done) {
    done = outputs->parameters.write(format_parameters(
        found->parameters(), fmt::format("identified from {} runs", found->runs.size())));
  }
  if (done) done = commit(*outputs);
  if (!done) return done.error();
  return describe(*found, arguments);
}

Expected<CommandResult> identify_recordings(IdentifyArguments arguments,
                                            Configuration& configuration,
                                            const Observer& observer) {
  Expected<std::vector<std::string>> recordings = list_recordings(arguments.recordings);
  if (!recordings) return recordings.error();
  arguments.recordings = std::move(*recordings);
  if (arguments.report.empty()) {
    const std::filesystem::path output = arguments.output;
    arguments.report = (output.parent_path() / output.stem()).string() + ".report";
  }
  const std::size_t count = arguments.recordings.size();
  if (arguments.scenes.size() > 1 && arguments.scenes.size() != count) {
    return Error{.message = fmt::format("is given {} times for {} recordings",
                                        arguments.scenes.size(), count),
                 .file = "--scene",
                 .place = {},
                 .hint = "give one scene for all, or one for each recording, in their order"};
  }
  if (count == 1) return identify_recording(arguments, configuration, observer);
  for (const auto& [option, value] :
       {std::pair("--tracked", &arguments.tracked), std::pair("--plan", &arguments.plan)}) {
    if (value->empty()) continue;
    return Error{.message = fmt::format("is for one recording, not for {}", count),
                 .file = option,
                 .place = {},
                 .hint = "leave it out: each recording's own folder tracked is used"};
  }
  return identify_many(arguments, configuration, observer);
}

void add_goal(CLI::App& app, Configuration& configuration, Action& action, IdentificationGoal goal,
              const std::string& name, const std::string& what) {
  CLI::App* command = app.add_subcommand(name, what);
  command->footer("Example:\n  pcavr identify " + name +
                  " my_recording --scene my_scene -o parameters.yaml");
  auto arguments = std::make_shared<IdentifyArguments>();
  arguments->goal = goal;
  command
      ->add_option("recording", arguments->recordings,
                   "Folder with a recording.yaml; or several, or a folder of them, or a text file "
                   "with one in each line: all runs together give one answer")
      ->required();
  command
      ->add_option("--scene", arguments->scenes,
                   "Scene from pcavr build; without it the manifest must have the objects' poses. "
                   "Of several recordings, one for all, or one for each in their order")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option(
      "--tracked", arguments->tracked,
      "Folder with objects/NAME/tracked.txt, used instead of tracking; by default the "
      "recording's own folder tracked, if it has one");
  command->add_option("--parameters", arguments->parameters,
                      "Parameter file with known parameters; friction that is identified again is "
                      "combined with them by its stds, other results replace them");
  command->add_option("-o,--output", arguments->output, "Parameter file to write")->required();
  command->add_option("--report", arguments->report,
                      "Folder for the report; by default next to the parameter file");
  command->add_option("--plan", arguments->plan,
                      "CSV file to write with the motion of a next recording, by which the "
                      "parameters get the stds that identification.plan wishes");
  command
      ->add_option("--damping-law", arguments->damping_law,
                   "Damping of a Hunt-Crossley contact from the restitution of impacts: the exact "
                   "relation, a published law, or criterion: the published law with the smallest "
                   "error there")
      ->check(CLI::IsMember(damping_law_names()))
      ->capture_default_str();
  command
      ->add_option("--group-by", arguments->group_by,
                   "Of several recordings: a table of each object's parameters, also by what it "
                   "stands on (the name of the recording's folder), or by the speed of its slides")
      ->check(CLI::IsMember({"object", "support", "speed"}))
      ->capture_default_str();
  command->add_flag("--force", arguments->replace,
                    "Replace an existing parameter file and report of pcavr; "
                    "other files and folders are never replaced");
  command->add_flag("--skip-bad", arguments->skip_bad, "Skip bad rows and frames, and count them");
  add_threads_option(*command, arguments->threads);
  command->callback([arguments, &configuration, &action] {
    action = [arguments, &configuration](const Observer& observer) {
      return identify_recordings(*arguments, configuration, observer);
    };
  });
}

}  // namespace

void add_identify(CLI::App& app, Configuration& configuration, Action& action) {
  CLI::App* command = app.add_subcommand(
      "identify",
      "Identify contact and friction of objects from force and motion, or an arm from its torques");
  command->require_subcommand(1);
  add_goal(*command, configuration, action, IdentificationGoal::contact, "contact",
           "Contact law (stiffness, damping, exponent) from presses along z");
  add_goal(*command, configuration, action, IdentificationGoal::friction, "friction",
           "Limiting and sliding friction, mass and friction radius from pushes");
  add_identify_robot(*command, configuration, action);
}

}  // namespace pcavr::app
