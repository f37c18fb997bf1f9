// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "pcavr/perception/board/board.hpp"
#include "pcavr/perception/board/picture_rig.hpp"

namespace pcavr {

/// Turns the board in views of which `turns` can't be distinguished, so that it turns between two
/// views by the same angle as the flange: no place of the camera changes that angle.
void resolve_turns(const Board& board, const std::vector<ArmPicture>& given,
                   std::vector<HandEyeView>& views);

/// By how many degrees the board is turned about its normal in this view against its place in the
/// others, where a turn by quarters brings it there.
[[nodiscard]] std::optional<int> turned_degrees(const Board& board, const HandEyeView& view,
                                                const HandEyeResult& found);

}  // namespace pcavr
