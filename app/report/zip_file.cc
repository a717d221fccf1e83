#include "app/report/zip_file.h"

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace touchdown::report {
namespace {

constexpr std::uint32_t kPolynomial = 0xEDB88320;  // reflected

std::array<std::uint32_t, 256> MakeTable() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) {
      c = (c & 1U) != 0 ? kPolynomial ^ (c >> 1U) : c >> 1U;
    }
    table[i] = c;
  }
  return table;
}

// Numbers of zip files: little-endian.
void Put(std::string& out, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) {
    out += static_cast<char>((value >> (8 * i)) & 0xFFU);
  }
}

constexpr std::uint32_t kVersion = 20;       // needed to extract: 2.0
constexpr std::uint32_t kUtf8 = 1U << 11U;   // of the name
constexpr std::uint32_t kFirstDay = 0x0021;  // 1980-01-01, as MS-DOS has it

// The fields that local and central headers share.
void PutCommon(std::string& out, const ZipEntry& entry) {
  Put(out, kVersion, 2);
  Put(out, kUtf8, 2);
  Put(out, 0, 2);  // stored
  Put(out, 0, 2);  // midnight
  Put(out, kFirstDay, 2);
  Put(out, Crc32(entry.bytes), 4);
  Put(out, static_cast<std::uint32_t>(entry.bytes.size()), 4);
  Put(out, static_cast<std::uint32_t>(entry.bytes.size()), 4);
  Put(out, static_cast<std::uint32_t>(entry.name.size()), 2);
  Put(out, 0, 2);  // no extra field
}

}  // namespace

std::uint32_t Crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = MakeTable();
  std::uint32_t c = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    c = table[(c ^ static_cast<unsigned char>(byte)) & 0xFFU] ^ (c >> 8U);
  }
  return c ^ 0xFFFFFFFFU;
}

std::string ZipArchive(std::span<const ZipEntry> entries) {
  std::size_t size = 0;
  for (const ZipEntry& entry : entries) {
    size += entry.bytes.size() + 2 * entry.name.size() + 128;
  }
  if (size > std::numeric_limits<std::uint32_t>::max() ||
      entries.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument(
        "the archive would have more than 65535 files or 4 GB; leave out "
        "--evidence or choose fewer trials");
  }
  std::string out;
  out.reserve(size);
  std::string directory;
  for (const ZipEntry& entry : entries) {
    const auto offset = static_cast<std::uint32_t>(out.size());
    out += "PK\x03\x04";
    PutCommon(out, entry);
    out += entry.name + entry.bytes;
    directory += "PK\x01\x02";
    Put(directory, kVersion, 2);  // made by
    PutCommon(directory, entry);
    Put(directory, 0, 2);  // no comment
    Put(directory, 0, 2);  // disk
    Put(directory, 0, 2);  // internal attributes
    Put(directory, 0, 4);  // external attributes
    Put(directory, offset, 4);
    directory += entry.name;
  }
  const auto begin = static_cast<std::uint32_t>(out.size());
  const auto count = static_cast<std::uint32_t>(entries.size());
  out += directory;
  out += "PK\x05\x06";
  Put(out, 0, 4);  // this disk, and that of the directory
  Put(out, count, 2);
  Put(out, count, 2);
  Put(out, static_cast<std::uint32_t>(directory.size()), 4);
  Put(out, begin, 4);
  Put(out, 0, 2);  // no comment
  return out;
}

}  // namespace touchdown::report
