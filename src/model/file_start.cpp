// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "model/file_start.hpp"

#include <fstream>
#include <system_error>

namespace pcavr::model {

FileStart read_file_start(const std::filesystem::path& file) {
  FileStart start{.text = std::string(kMaxHeader, '\0')};
  std::ifstream stream(file, std::ios::binary);
  stream.read(start.text.data(), static_cast<std::streamsize>(start.text.size()));
  start.text.resize(static_cast<std::size_t>(stream.gcount()));
  std::error_code code;
  start.size = std::filesystem::file_size(file, code);
  if (code) start.size = start.text.size();
  return start;
}

}  // namespace pcavr::model
