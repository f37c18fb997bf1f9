// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/ros2/raw_sertype.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/q_radmin.h>

// The layout of a serdata, for code that stores one inside a type of its own, depends on how the
// library was built; the build sets DDS_HAS_SHM as the library's package states it.

namespace pcavr {
namespace {

constexpr std::size_t kAlignment = 4;  // the protocol copies whole words

struct RawSertype {
  ddsi_sertype base;  // first: Cyclone DDS knows only this part
  std::size_t max_size = 0;
};

struct RawSerdata {
  ddsi_serdata base;                // first, as above
  std::vector<std::uint8_t> bytes;  ///< padded to whole words
  std::size_t size = 0;
};

static_assert(offsetof(RawSertype, base) == 0);

const RawSertype& sertype_of(const ddsi_sertype* type) {
  return *reinterpret_cast<const RawSertype*>(type);
}
const RawSerdata& serdata_of(const ddsi_serdata* data) {
  return *reinterpret_cast<const RawSerdata*>(data);
}

/// Nothing if there is no memory: no exception may pass through the library.
RawSerdata* make_serdata(const ddsi_sertype* type, ddsi_serdata_kind kind,
                         std::size_t size) noexcept {
  try {
    auto data = std::make_unique<RawSerdata>();
    data->bytes.resize((size + kAlignment - 1) / kAlignment * kAlignment, 0);
    data->size = size;
    ddsi_serdata_init(&data->base, type, kind);
    data->base.hash = type->serdata_basehash;
    return data.release();
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

bool has_same_key(const ddsi_serdata*, const ddsi_serdata*) { return true; }  // there are no keys

std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(serdata_of(data).size);
}

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                             const nn_rdata* fragment, std::size_t size) {
  if (size > sertype_of(type).max_size) return nullptr;
  RawSerdata* const data = make_serdata(type, kind, size);
  if (data == nullptr) return nullptr;
  std::size_t done = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    const std::size_t end = std::min<std::size_t>(fragment->maxp1, size);
    if (end <= done || fragment->min > done) continue;  // repeats what was there
    const unsigned char* const payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(data->bytes.data() + done, payload + (done - fragment->min), end - done);
    done = end;
  }
  return &data->base;
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* pieces, std::size_t size) {
  if (size > sertype_of(type).max_size) return nullptr;
  RawSerdata* const data = make_serdata(type, kind, size);
  if (data == nullptr) return nullptr;
  std::size_t done = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && done < size; ++i) {
    const std::size_t length = std::min<std::size_t>(pieces[i].iov_len, size - done);
    std::memcpy(data->bytes.data() + done, pieces[i].iov_base, length);
    done += length;
  }
  return &data->base;
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash*) {
  RawSerdata* const data = make_serdata(type, SDK_KEY, 0);
  return data == nullptr ? nullptr : &data->base;
}

/// `sample` is a std::span of the message.
ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
  if (kind != SDK_DATA) return from_key(type, nullptr);
  return make_raw_serdata(*type, *static_cast<const std::span<const std::uint8_t>*>(sample));
}

void to_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, serdata_of(data).bytes.data() + offset, size);
}

ddsi_serdata* refer(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                    ddsrt_iovec_t* piece) {
  piece->iov_base = const_cast<std::uint8_t*>(serdata_of(data).bytes.data() + offset);
  piece->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}

void release(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }

bool to_no_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool key_to_no_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return true;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  RawSerdata* const key = make_serdata(data->type, SDK_KEY, 0);
  if (key == nullptr) return nullptr;
  key->base.type = nullptr;
  return &key->base;
}

void free_serdata(ddsi_serdata* data) { delete reinterpret_cast<RawSerdata*>(data); }

std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* buffer, std::size_t size) {
  if (size > 0) buffer[0] = '\0';
  return 0;
}

void key_hash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash->value, 0, sizeof(hash->value));
}

const ddsi_serdata_ops& serdata_operations() {
  static const ddsi_serdata_ops operations = [] {
    ddsi_serdata_ops set{};
    set.eqkey = has_same_key;
    set.get_size = size_of;
    set.from_ser = from_fragments;
    set.from_ser_iov = from_pieces;
    set.from_keyhash = from_key;
    set.from_sample = from_sample;
    set.to_ser = to_bytes;
    set.to_ser_ref = refer;
    set.to_ser_unref = release;
    set.to_sample = to_no_sample;
    set.to_untyped = to_untyped;
    set.untyped_to_sample = key_to_no_sample;
    set.free = free_serdata;
    set.print = print;
    set.get_keyhash = key_hash;
    return set;
  }();
  return operations;
}

void free_sertype(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete reinterpret_cast<RawSertype*>(type);
}

bool is_equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return sertype_of(a).max_size == sertype_of(b).max_size;
}
std::uint32_t hash_of(const ddsi_sertype*) { return 0; }  // the name is hashed by the library

void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

/// The same for every data representation: the bytes are the receiver's to decode.
ddsi_sertype* derive(const ddsi_sertype* type, dds_data_representation_id_t,
                     dds_type_consistency_enforcement_qospolicy_t) {
  return const_cast<ddsi_sertype*>(type);
}

const ddsi_sertype_ops& sertype_operations() {
  static const ddsi_sertype_ops operations = [] {
    ddsi_sertype_ops set{};
    set.version = ddsi_sertype_v0;
    set.free = free_sertype;
    set.zero_samples = zero_samples;
    set.realloc_samples = realloc_samples;
    set.free_samples = free_samples;
    set.equal = is_equal;
    set.hash = hash_of;
    set.derive_sertype = derive;
    return set;
  }();
  return operations;
}

}  // namespace

ddsi_sertype* make_raw_sertype(const std::string& type_name, std::size_t max_size) {
  auto type = std::make_unique<RawSertype>();
  type->max_size = max_size;
  ddsi_sertype_init(&type->base, type_name.c_str(), &sertype_operations(), &serdata_operations(),
                    true);
  type->base.allowed_data_representation = DDS_DATA_REPRESENTATION_RESTRICT_DEFAULT;
  return &type.release()->base;
}

ddsi_serdata* make_raw_serdata(const ddsi_sertype& type, std::span<const std::uint8_t> message) {
  RawSerdata* const data = make_serdata(&type, SDK_DATA, message.size());
  if (data == nullptr) return nullptr;
  std::copy(message.begin(), message.end(), data->bytes.begin());
  return &data->base;
}

std::span<const std::uint8_t> bytes_of(const ddsi_serdata& sample) {
  const RawSerdata& data = serdata_of(&sample);
  return std::span(data.bytes).first(data.size);
}

}  // namespace pcavr
