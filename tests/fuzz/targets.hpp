// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace pcavr::fuzz {

/// One target for each kind of outside bytes that are read: files, and messages between the sites.
/// Each checks more than survival: what is accepted can be written and read again, what is refused
/// says where and why.
/// They throw (ContractError) where that does not hold.
void manifest(std::string_view bytes);
void camera_file(std::string_view bytes);
void image_list(std::string_view bytes);
/// Trajectory, tool, wrench and joints, by the first byte's letter: g, t, w, j.
void series(std::string_view bytes);
/// JPEG and PNG of 16 x 12 pixels; and the bytes taken as the filtered rows of a PNG.
void image(std::string_view bytes);
void parameters(std::string_view bytes);
/// What an operator's hand did.
void trace(std::string_view bytes);
/// A correction from the robot's site.
void message(std::string_view bytes);
/// A message of page or server over the WebSocket.
void live(std::string_view bytes);

}  // namespace pcavr::fuzz
