// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "support/source_folder.hpp"

std::filesystem::path source_folder() { return PCAVR_SOURCE_DIR; }
