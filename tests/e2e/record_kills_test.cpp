// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "record_kills.hpp"

namespace pcavr {
namespace {

TEST(RecordKills, ThirtyLoseAtMostHalfASecond) { test::kill_recordings(30, 1); }

}  // namespace
}  // namespace pcavr
