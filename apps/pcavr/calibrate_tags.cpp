// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/calibrate_tags.hpp"

#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/report/number_text.hpp"

#include "calibrate_commands.hpp"
#include "calibration_outputs.hpp"
#include "number_option.hpp"

namespace pcavr::app {
namespace {

constexpr double kInDegrees = 180.0 / std::numbers::pi;

struct CalibrateTagsArguments {
  std::string input, layout, camera;
  std::string format = "pcavr";
  double size = 0.0;  ///< [m]; 0: not given
  CalibrationOutputOption output;
  TagWalkInput walk;
};

TagFileFormat format_named(const std::string& name) {
  if (name == "apriltag_ros") return TagFileFormat::apriltag_ros;
  return name == "tagslam" ? TagFileFormat::tagslam : TagFileFormat::pcavr;
}

nlohmann::ordered_json tag_json(const LaidOutTag& tag) {
  const Eigen::Vector3d& p = tag.T_body_tag.translation();
  const Eigen::Vector4d q = tag.T_body_tag.rotation().coeffs();
  nlohmann::ordered_json json{{"tag", tag.id.to_string()},
                              {"size", tag.size},
                              {"position", {p.x(), p.y(), p.z()}},
                              {"rotation", {q[0], q[1], q[2], q[3]}},
                              {"position_std", tag.position_std()},
                              {"rotation_std", tag.rotation_std()},
                              {"images", tag.views},
                              {"left_out", tag.rejected},
                              {"pixel_rms", tag.pixel_rms},
                              {"is_reference", tag.is_reference}};
  if (tag.shift) {
    json["from_stated"] = {{"offset", tag.shift->offset},
                           {"rotation", tag.shift->rotation},
                           {"has_moved", tag.shift->has_moved}};
  }
  if (tag.move) {
    json["moved"] = {{"last_image_before", tag.move->last_before},
                     {"first_image_after", tag.move->first_after},
                     {"offset", tag.move->offset},
                     {"rotation", tag.move->rotation}};
  }
  return json;
}

std::string tag_line(const LaidOutTag& tag) {
  const Eigen::Vector3d p = 1e3 * tag.T_body_tag.translation();
  std::string text =
      fmt::format("  {:<14} {:9.1f} {:9.1f} {:9.1f} mm", tag.id.to_string(), p.x(), p.y(), p.z());
  if (tag.position_std() > 0.0) {
    text += fmt::format(" +- {} mm, +- {} deg", readable(1e3 * tag.position_std()),
                        readable(kInDegrees * tag.rotation_std()));
  }
  if (tag.is_reference) text += ", reference";
  if (tag.shift && tag.shift->has_moved) {
    text += fmt::format(", {:.1f} mm and {:.1f} deg from where it is said to be",
                        1e3 * tag.shift->offset, kInDegrees * tag.shift->rotation);
  }
  return text + '\n';
}

CommandResult describe_result(const CalibrateTagsArguments& arguments, const TagWalk& walk,
                              const CalibratedTags& found) {
  CommandResult result;
  result.json = {{"calibration", arguments.output.file},
                 {"known", walk.known.format},
                 {"images", walk.frames.size()}};
  result.summary = "known before: " + walk.known.format + '\n';
  for (const CalibratedBody& body : found.bodies) {
    nlohmann::ordered_json tags = nlohmann::ordered_json::array();
    result.summary += fmt::format("{}: residual of a corner {:.2f} px\n",
                                  body.name.empty() ? "base" : body.name, body.layout.pixel_rms);
    for (const LaidOutTag& tag : body.layout.tags) {
      tags.push_back(tag_json(tag));
      result.summary += tag_line(tag);
    }
    result.json["bodies"].push_back({{"name", body.name.empty() ? "base" : body.name},
                                     {"pixel_rms", body.layout.pixel_rms},
                                     {"correlation", body.layout.correlation},
                                     {"tags", std::move(tags)}});
  }
  result.json["verdict"] = describe_tags(found);
  result.json["notes"] = found.notes;
  result.summary += arguments.output.written_lines();
  if (arguments.format == "pcavr") result.summary += how_to_use(arguments.output.file);
  result.summary += describe_tags(found) + '\n';
  return result;
}

Expected<CommandResult> run_tags(CalibrateTagsArguments arguments, const Observer& observer) {
  Expected<CalibrationOutputs> outputs = CalibrationOutputs::create(
      arguments.output, {arguments.input, arguments.layout, arguments.camera});
  if (!outputs) return outputs.error();
  TagWalkInput& input = arguments.walk;
  input.input = arguments.input;
  input.layout = arguments.layout;
  input.camera = arguments.camera;
  if (arguments.size > 0.0) input.size = arguments.size;
  const Expected<TagWalk> walk = read_tag_walk(input, observer);
  if (!walk) return walk.error();
  const Expected<CalibratedTags> found = calibrate_tags(*walk, input);
  if (!found) return found.error();
  for (const std::string& note : found->notes) observer.on_warning(note);
  CommandResult result = describe_result(arguments, *walk, *found);
  const Expected<void> done =
      outputs->commit(format_tags(*found, input, format_named(arguments.format)),
                      [&](const std::filesystem::path& folder) {
                        return write_tags_report(*found, *walk, json_text(result.json, 2), folder);
                      });
  if (!done) return done.error();
  return result;
}

}  // namespace

void add_calibrate_tags(CLI::App& calibrate, Action& action) {
  CLI::App* command = calibrate.add_subcommand(
      "tags", "Where the tags of base and objects are, from images of a walk past them");
  command->footer("Example:\n  pcavr calibrate tags my_recording --fixed 0 -o tags.yaml");
  auto arguments = std::make_shared<CalibrateTagsArguments>();
  command
      ->add_option("input", arguments->input,
                   "A recording, or a table of tag corners: t, id, u0, v0 to u3, v3")
      ->required();
  add_calibration_output(*command, arguments->output);
  command->add_option(
      "--fixed", arguments->walk.fixed,
      "Tag that is where it is said to be, as 3 or tag36h11:3; default: the largest "
      "set of stated poses that agree");
  command->add_option("--layout", arguments->layout,
                      "Stated poses: a file of pcavr, apriltag_ros or TagSLAM; default: the "
                      "recording's markers");
  add_number(*command, "--size", arguments->size, ranges::kTagSize,
             "Size of the tags in view that nothing else names, which are then tags of the base "
             "[m]");
  command
      ->add_option("--family", arguments->walk.family,
                   "Family of the tags where the input names none")
      ->check(CLI::IsMember(tag_families()))
      ->capture_default_str();
  command->add_option("--camera", arguments->camera, "Camera file, for a table of corners");
  command->add_option("--as", arguments->format, "Format of the output")
      ->check(CLI::IsMember({"pcavr", "apriltag_ros", "tagslam"}))
      ->capture_default_str();
  command->add_flag("--skip-bad", arguments->walk.skip_bad,
                    "Leave out rows and images that can't be read");
  command->callback([arguments, &action] {
    action = [arguments](const Observer& observer) { return run_tags(*arguments, observer); };
  });
}

}  // namespace pcavr::app
