// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "video_encoder.hpp"

#include <string>
#include <system_error>

#include <dlfcn.h>

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr char kLibrary[] = "libpcavr_video.so";

/// The library is in the installation, or in the build tree.
Expected<fs::path> find_library() {
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& candidate :
       {folder / ".." / PCAVR_LIBRARY_FOLDER, fs::path(PCAVR_INSTALLED_LIBRARY_FOLDER),
        fs::path(PCAVR_BUILT_LIBRARY_FOLDER)}) {
    if (fs::exists(candidate / kLibrary, ignored)) return candidate / kLibrary;
  }
  return Error{.message = std::string(kLibrary) + " is missing",
               .hint = "install pcavr again, or leave out the video"};
}

}  // namespace

Expected<std::unique_ptr<VideoEncoder>> load_video_encoder() {
  const Expected<fs::path> file = find_library();
  if (!file) return file.error();
  // Never unloaded: FFmpeg's threads may outlive the encoder.
  void* library = dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);
  const auto create =
      library == nullptr
          ? nullptr
          : reinterpret_cast<VideoEncoder* (*)()>(dlsym(library, "pcavr_create_video_encoder"));
  if (create == nullptr) {
    const char* reason = dlerror();
    return Error{.message = std::string("can't be loaded: ") + (reason ? reason : "unknown reason"),
                 .file = file->string(),
                 .hint =
                     "install OpenCV's video library (libopencv-videoio406), or leave out the "
                     "video"};
  }
  return std::unique_ptr<VideoEncoder>(create());
}

}  // namespace pcavr
