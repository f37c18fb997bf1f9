// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "shared_files.hpp"

#include <system_error>

namespace pcavr::app {
namespace fs = std::filesystem;

fs::path find_shared_folder(const std::string& installed, const std::string& in_source,
                            const std::string& file) {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder :
       {program / "../share/pcavr" / installed, fs::path(PCAVR_SOURCE_FOLDER) / in_source}) {
    if (fs::exists(folder / file, ignored)) return folder;
  }
  return {};
}

CLI::Validator installed_calibration() {
  return CLI::Validator(
      [](std::string& file) {
        constexpr std::string_view kFolder = "calib/";
        std::error_code ignored;
        if (!file.starts_with(kFolder) || fs::exists(file, ignored)) return std::string();
        const std::string name = file.substr(kFolder.size());
        const fs::path folder = find_shared_folder("calib", "calib", name);
        if (!folder.empty()) file = (folder / name).lexically_normal().string();
        return std::string();
      },
      "");
}

}  // namespace pcavr::app
