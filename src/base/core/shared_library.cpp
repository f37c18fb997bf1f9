// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/shared_library.hpp"

#include <string>
#include <system_error>

#include <dlfcn.h>

namespace pcavr {

void UnloadLibrary::operator()(void* library) const { dlclose(library); }

Expected<SharedLibrary> load_library(const std::filesystem::path& file) {
  std::error_code unreadable;
  if (!std::filesystem::exists(file, unreadable)) {
    return Error{.message = "does not exist",
                 .file = file.string(),
                 .hint = "give the path of the plugin's .so"};
  }
  // Absolute: dlopen would search a bare name among the system's libraries.
  const std::filesystem::path absolute = std::filesystem::absolute(file, unreadable);
  SharedLibrary library(dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (library) return library;
  const char* reason = dlerror();
  return Error{.message = std::string("can't be loaded as a library: ") + (reason ? reason : "?"),
               .file = file.string(),
               .hint = "build it as a shared library for this machine"};
}

}  // namespace pcavr
