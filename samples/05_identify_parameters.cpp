// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Identifies contact and friction of each pushed object from tool, force and tracked motion: prints
// each parameter with its standard deviation, and writes the parameter file. TRACKED has
// objects/NAME/tracked.txt: a run, or the folder tracked of a simulated recording.
//   05_identify_parameters RECORDING TRACKED PARAMETERS
#include <cstdio>

#include <pcavr/base/core/output_file.hpp>
#include <pcavr/physics/object/parameters_file.hpp>
#include <pcavr/pipeline/identify.hpp>

namespace {

void print(const pcavr::ParameterFinding& found) {
  if (!found.is_excited) {
    std::printf("  %-30s not excited: %s\n", found.name.c_str(), found.remark.c_str());
  } else if (found.std) {
    std::printf("  %-30s %.4g +- %.2g %s\n", found.name.c_str(), found.value, *found.std,
                found.unit.c_str());
  } else {
    std::printf("  %-30s %.4g %s\n", found.name.c_str(), found.value, found.unit.c_str());
  }
}

pcavr::Expected<void> identify(const char* recording_folder, const char* tracked_folder,
                               const char* parameters_file) {
  auto output = pcavr::OutputFile::create(parameters_file, {});
  if (!output) return output.error();
  const auto recording = pcavr::read_recording(recording_folder);
  if (!recording) return recording.error();
  const auto input = pcavr::identification_input(*recording, {.tracked = tracked_folder});
  if (!input) return input.error();

  const auto found = pcavr::identify(*input, pcavr::IdentificationGoal::friction);
  if (!found) return found.error();
  for (const pcavr::ObjectIdentification& object : found->objects) {
    std::printf("%s: %d pushes broke away\n", object.name.c_str(), object.limit.pushes);
    for (const pcavr::ParameterFinding& finding : object.findings) print(finding);
  }
  const auto written = output->write(pcavr::format_parameters(found->parameters()));
  if (!written) return written;
  return output->commit();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4)
    return std::fprintf(stderr, "usage: %s RECORDING TRACKED PARAMETERS\n", argv[0]), 2;
  const auto done = identify(argv[1], argv[2], argv[3]);
  if (!done) std::fprintf(stderr, "%s\n", done.error().to_string().c_str());
  return done ? 0 : 1;
}
