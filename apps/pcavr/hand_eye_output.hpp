// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pcavr/robots/calibration/hand_eye.hpp"

namespace pcavr::app {

/// The figures of a hand-eye calibration for programs, and for people.
[[nodiscard]] nlohmann::ordered_json hand_eye_json(const HandEyeResult& found);
[[nodiscard]] std::string hand_eye_summary(const HandEyeResult& found);

}  // namespace pcavr::app
