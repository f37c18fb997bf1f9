// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

/// The checkout that the tests were built from. Defined in one source file, so that no other
/// depends on the checkout's path, and a compiler cache works for every clone.
[[nodiscard]] std::filesystem::path source_folder();
