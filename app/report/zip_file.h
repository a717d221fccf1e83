// A zip archive of texts, without compression: what an .eln file is.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace touchdown::report {

struct ZipEntry {
  std::string name;  // with folders, "/" between them
  std::string bytes;
};

// The archive (PKWARE APPNOTE 6.3, method 0, names in UTF-8). The same entries
// give the same bytes: all are dated 1980-01-01. Throws std::invalid_argument
// where it would need more than 65535 entries or 4 GB.
std::string ZipArchive(std::span<const ZipEntry> entries);

// CRC-32 as zip and PNG use it.
std::uint32_t Crc32(std::string_view bytes);

}  // namespace touchdown::report
