// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// Both sites for hours of virtual time through random faults, or without any, so that processes
// grow old:
//   pcavr_bench_soak FIRST_SEED LAST_SEED MINUTES [calm]
// A line for each seed; exit code 1 if something did not hold.
#include <cstdlib>
#include <exception>
#include <limits>
#include <string>

#include <fmt/core.h>

#include "sites/soak/two_sites_soak.hpp"
#include "support/heap_watermark.hpp"

namespace {

bool soak(std::uint64_t seed, double minutes, bool is_calm) {
  pcavr::SoakOptions options{
      .seed = seed, .duration = 60.0 * minutes, .heap_bytes = [] { return heap_bytes.load(); }};
  if (is_calm) options.fault_interval = std::numeric_limits<double>::infinity();
  const pcavr::SoakReport report = pcavr::run_two_sites_soak(options);
  std::size_t faults = 0;
  for (const auto& [name, count] : report.faults) faults += count;
  fmt::print(
      "seed {}: digest {:016x}, {} faults, {} sessions, {} commands, {} corrections, "
      "path {:.1f} m, {} times too much force, oldest command {:.3f} s, heap at most {:.1f} MB, "
      "{:.3f} MB at the end\n",
      seed, report.digest, faults, report.sessions, report.commands, report.corrections,
      report.path, report.pressed, report.max_age, 1e-6 * static_cast<double>(report.heap_peak),
      1e-6 * static_cast<double>(report.heap_rest));
  for (const auto& [message, count] : report.endings) {
    fmt::print("  operator's site ended {} times: {}\n", count, message);
  }
  for (const std::string& violation : report.violations) fmt::print("  violation: {}\n", violation);
  std::fflush(stdout);
  return report.violations.empty();
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_calm = argc == 5 && std::string(argv[4]) == "calm";
  if (argc != 4 && !is_calm) {
    fmt::print(stderr, "usage: {} FIRST_SEED LAST_SEED MINUTES [calm]\n", argv[0]);
    return 2;
  }
  try {
    bool holds = true;
    for (std::uint64_t seed = std::stoull(argv[1]); seed <= std::stoull(argv[2]); ++seed) {
      holds = soak(seed, std::stod(argv[3]), is_calm) && holds;
    }
    return holds ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& fault) {
    fmt::print(stderr, "{}\n", fault.what());
    return EXIT_FAILURE;
  }
}
