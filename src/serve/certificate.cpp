// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/certificate.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pcavr/base/core/output.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

constexpr int kDays = 397;            // browsers reject longer ones
constexpr double kMinDaysLeft = 7.0;  // so that it does not expire while it is used
constexpr long kDay = 24L * 3600;     // [s]

struct FreeOpenSsl {
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(BIO* text) const { BIO_free_all(text); }
  void operator()(GENERAL_NAMES* names) const { GENERAL_NAMES_free(names); }
  void operator()(ifaddrs* list) const { ::freeifaddrs(list); }
};
template <typename Handle>
using Owned = std::unique_ptr<Handle, FreeOpenSsl>;

Error cannot_create(const fs::path& file) {
  return Error{.message = "can't create a certificate", .file = file.string()};
}

std::string address_of(const sockaddr* address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* number =
      address->sa_family == AF_INET
          ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in*>(address)->sin_addr)
          : &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr;
  return ::inet_ntop(address->sa_family, number, text.data(), text.size()) == nullptr ? ""
                                                                                      : text.data();
}

/// The subject alternative names in OpenSSL's syntax: "DNS:localhost,IP:127.0.0.1".
std::string alternative_names() {
  std::string names = "DNS:localhost,IP:127.0.0.1,IP:::1";
  for (const std::string& name : machine_names()) names += ",DNS:" + name;
  for (const std::string& address : machine_addresses()) names += ",IP:" + address;
  return names;
}

bool add_extension(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context{};
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str());
  if (extension == nullptr) return false;
  const bool is_added = X509_add_ext(certificate, extension, -1) == 1;
  X509_EXTENSION_free(extension);
  return is_added;
}

bool set_serial(X509* certificate) {
  // Serial numbers of one issuer must differ; 63 random bits, so that it is positive.
  std::uint64_t serial = 0;
  if (RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) != 1) return false;
  return ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial >> 1 | 1) == 1;
}

Owned<X509> self_sign(EVP_PKEY* key) {
  Owned<X509> certificate(X509_new());
  X509* c = certificate.get();
  if (c == nullptr || X509_set_version(c, 2) != 1 || !set_serial(c)) return nullptr;
  // Valid since a day ago, for a headset whose clock is behind.
  X509_gmtime_adj(X509_getm_notBefore(c), -kDay);
  X509_gmtime_adj(X509_getm_notAfter(c), (kDays - 1) * kDay);
  X509_NAME* name = X509_get_subject_name(c);
  const std::string_view common_name = "pcavr on this machine";
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8,
                             reinterpret_cast<const unsigned char*>(common_name.data()),
                             static_cast<int>(common_name.size()), -1, 0);
  const bool is_signed = X509_set_issuer_name(c, name) == 1 && X509_set_pubkey(c, key) == 1 &&
                         add_extension(c, NID_basic_constraints, "critical,CA:FALSE") &&
                         add_extension(c, NID_key_usage, "critical,digitalSignature") &&
                         add_extension(c, NID_ext_key_usage, "serverAuth") &&
                         add_extension(c, NID_subject_alt_name, alternative_names()) &&
                         X509_sign(c, key, EVP_sha256()) > 0;
  if (!is_signed) return nullptr;
  return certificate;
}

template <typename Write>
std::string pem(Write write) {
  const Owned<BIO> text(BIO_new(BIO_s_mem()));
  if (!text || write(text.get()) != 1) return {};
  char* bytes = nullptr;
  const long length = BIO_get_mem_data(text.get(), &bytes);
  return {bytes, static_cast<std::size_t>(length)};
}

/// Writes a file that only its owner can read, at no time readable by others.
Expected<void> write_secret(const fs::path& file, const std::string& text) {
  const fs::path temporary = file.string() + ".new";
  ::unlink(temporary.c_str());
  const int handle =
      ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
  bool is_written =
      handle >= 0 && ::write(handle, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int fault = errno;
  if (handle >= 0) is_written = ::close(handle) == 0 && is_written;
  if (is_written && ::rename(temporary.c_str(), file.c_str()) == 0) return {};
  ::unlink(temporary.c_str());
  return Error{.message = std::string("can't be written: ") + std::strerror(fault),
               .file = file.string()};
}

Expected<void> create_certificate(const TlsFiles& files) {
  const Owned<EVP_PKEY> key(EVP_EC_gen("P-256"));
  if (!key) return cannot_create(files.certificate);
  const Owned<X509> certificate = self_sign(key.get());
  if (!certificate) return cannot_create(files.certificate);
  const std::string secret = pem([&](BIO* text) {
    return PEM_write_bio_PrivateKey(text, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
  const std::string public_pem =
      pem([&](BIO* text) { return PEM_write_bio_X509(text, certificate.get()); });
  if (secret.empty() || public_pem.empty()) return cannot_create(files.certificate);
  const Expected<void> written = write_secret(files.key, secret);
  if (!written) return written;
  return write_file(files.certificate, public_pem);
}

std::vector<std::string> names_of(X509* certificate) {
  std::vector<std::string> names;
  const Owned<GENERAL_NAMES> list(static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  for (int i = 0; list && i < sk_GENERAL_NAME_num(list.get()); ++i) {
    const GENERAL_NAME* name = sk_GENERAL_NAME_value(list.get(), i);
    const bool is_address = name->type == GEN_IPADD;
    if (!is_address && name->type != GEN_DNS) continue;
    const ASN1_STRING* value = is_address ? name->d.iPAddress : name->d.dNSName;
    const unsigned char* bytes = ASN1_STRING_get0_data(value);
    const auto length = static_cast<std::size_t>(ASN1_STRING_length(value));
    if (!is_address) {
      names.emplace_back(reinterpret_cast<const char*>(bytes), length);
      continue;
    }
    std::array<char, INET6_ADDRSTRLEN> text{};
    const int family = length == sizeof(in6_addr) ? AF_INET6 : AF_INET;
    if (::inet_ntop(family, bytes, text.data(), text.size()) != nullptr) {
      names.emplace_back(text.data());
    }
  }
  return names;
}

std::string fingerprint_of(X509* certificate) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  if (X509_digest(certificate, EVP_sha256(), digest.data(), &length) != 1) return {};
  std::string text;
  for (unsigned i = 0; i < length; ++i) {
    text += fmt::format("{}{:02X}", i == 0 ? "" : ":", digest[i]);
  }
  return text;
}

Owned<X509> read_pem(const std::string& text) {
  const Owned<BIO> bytes(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  return Owned<X509>(bytes ? PEM_read_bio_X509(bytes.get(), nullptr, nullptr, nullptr) : nullptr);
}

/// Whether the key is the certificate's: not so after two servers wrote them at the same time.
bool is_key_pair(const TlsFiles& files) {
  const Expected<std::string> public_pem = read_file(files.certificate);
  const Expected<std::string> secret = read_file(files.key);
  if (!public_pem || !secret) return false;
  const Owned<BIO> bytes(BIO_new_mem_buf(secret->data(), static_cast<int>(secret->size())));
  const Owned<EVP_PKEY> key(bytes ? PEM_read_bio_PrivateKey(bytes.get(), nullptr, nullptr, nullptr)
                                  : nullptr);
  const Owned<X509> certificate = read_pem(*public_pem);
  return key && certificate && X509_check_private_key(certificate.get(), key.get()) == 1;
}

bool is_still_valid(const TlsFiles& files) {
  if (!is_key_pair(files)) return false;
  const Expected<CertificateInfo> info = read_certificate(files.certificate);
  if (!info || info->days_left < kMinDaysLeft) return false;
  std::vector<std::string> required = machine_addresses();
  for (const std::string& name : machine_names()) required.push_back(name);
  return std::all_of(required.begin(), required.end(), [&](const std::string& name) {
    return std::find(info->names.begin(), info->names.end(), name) != info->names.end();
  });
}

}  // namespace

std::vector<std::string> machine_addresses() {
  ifaddrs* first = nullptr;
  if (::getifaddrs(&first) != 0) return {};
  const Owned<ifaddrs> list(first);
  std::vector<std::string> addresses;
  for (const ifaddrs* entry = first; entry != nullptr; entry = entry->ifa_next) {
    const bool is_used = entry->ifa_addr != nullptr && (entry->ifa_flags & IFF_UP) != 0 &&
                         (entry->ifa_flags & IFF_LOOPBACK) == 0;
    if (!is_used) continue;
    const int family = entry->ifa_addr->sa_family;
    if (family != AF_INET && family != AF_INET6) continue;
    const std::string address = address_of(entry->ifa_addr);
    // Link-local addresses do not work in a browser's address bar.
    if (!address.empty() && !address.starts_with("fe80")) addresses.push_back(address);
  }
  std::sort(addresses.begin(), addresses.end(), [](const std::string& a, const std::string& b) {
    return std::pair(a.find(':') != std::string::npos, a) <
           std::pair(b.find(':') != std::string::npos, b);
  });
  addresses.erase(std::unique(addresses.begin(), addresses.end()), addresses.end());
  return addresses;
}

std::vector<std::string> machine_names() {
  std::array<char, 256> text{};
  if (::gethostname(text.data(), text.size() - 1) != 0) return {};
  const std::string name(text.data());
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '.';
  });
  if (name.empty() || name == "localhost" || !is_plain) return {};
  return {name, name + ".local"};
}

fs::path data_folder() {
  const char* data = std::getenv("XDG_DATA_HOME");
  if (data != nullptr && fs::path(data).is_absolute()) return fs::path(data) / "pcavr";
  const char* home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/") / ".local/share/pcavr";
}

Expected<TlsFiles> load_or_create_certificate(const fs::path& folder) {
  const TlsFiles files{folder / "certificate.pem", folder / "key.pem"};
  if (is_still_valid(files)) return files;
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault) return Error{.message = fault.message(), .file = folder.string()};
  const Expected<void> created = create_certificate(files);
  if (!created) return created.error();
  return files;
}

Expected<CertificateInfo> read_certificate(const fs::path& file) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  const Owned<X509> certificate = read_pem(*text);
  int days = 0;
  int seconds = 0;
  if (!certificate ||
      ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate.get())) != 1) {
    return Error{.message = "not a PEM certificate", .file = file.string()};
  }
  return CertificateInfo{names_of(certificate.get()), fingerprint_of(certificate.get()),
                         days + static_cast<double>(seconds) / static_cast<double>(kDay)};
}

}  // namespace pcavr
