// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Reads a recording: prints its streams and the share of valid pixels of each depth image.
//   01_read_a_recording RECORDING
#include <cstdio>

#include <pcavr/recordings/recording/frame_reader.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: %s RECORDING\n", argv[0]), 2;
  const auto recording = pcavr::read_recording(argv[1]);
  if (!recording) {
    std::fprintf(stderr, "%s\n", recording.error().to_string().c_str());
    return 1;
  }
  std::printf("%zu frames, %zu tool poses, %zu wrench samples, %zu markers\n",
              recording->frames.size(), recording->tool.size(), recording->wrench.size(),
              recording->manifest.markers.size());

  pcavr::FrameReader reader(*recording);
  while (true) {
    const auto frame = reader.next();
    if (!frame) {
      std::fprintf(stderr, "%s\n", frame.error().to_string().c_str());
      return 1;
    }
    if (!*frame) return 0;
    std::size_t measured = 0;
    for (const float z : (*frame)->depth.pixels()) measured += z > 0.0F ? 1 : 0;
    std::printf("%s  %.1f %% measured\n", pcavr::format_stamp((*frame)->depth_stamp).c_str(),
                100.0 * static_cast<double>(measured) /
                    static_cast<double>((*frame)->depth.pixels().size()));
  }
}
