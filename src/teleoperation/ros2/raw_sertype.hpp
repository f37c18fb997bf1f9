// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

namespace pcavr {

/// A keyless type of Cyclone DDS known by its name alone, whose samples stay serialized. A received
/// sample of more than `max_size` [bytes] is rejected. Owned by Cyclone DDS once a topic was made
/// of it; before, by the caller: ddsi_sertype_unref().
[[nodiscard]] ddsi_sertype* make_raw_sertype(const std::string& type_name, std::size_t max_size);

/// A sample of such a type, for dds_writecdr(), which takes it over. `message` begins with the
/// header of CDR.
[[nodiscard]] ddsi_serdata* make_raw_serdata(const ddsi_sertype& type,
                                             std::span<const std::uint8_t> message);

/// The bytes of a sample that dds_takecdr() returned of such a type; valid as long as it is.
[[nodiscard]] std::span<const std::uint8_t> bytes_of(const ddsi_serdata& sample);

}  // namespace pcavr
