// APPNOTE.TXT of PKWARE, version 6.3: sections 4.3.7 (local header), 4.3.12
// (central directory), 4.3.16 (its end).
//
// The archive is written in one pass. A member is its local header and its
// bytes; its offset and checksum are kept in memory until Commit() writes the
// central directory, by which readers find the members.
#include "app/text/zip_file.h"

#include <zlib.h>

#include <cstddef>
#include <limits>
#include <stdexcept>

namespace touchdown::pipeline {
namespace {

// Fields that are the same in every header. The date is fixed, so that equal
// members make equal bytes.
constexpr std::uint16_t kVersion = 20;         // folders and stored members
constexpr std::uint16_t kUtf8Names = 1 << 11;  // flag
constexpr std::uint16_t kStored = 0;           // method
constexpr std::uint16_t kMidnight = 0;
constexpr std::uint16_t kFirstDay = (1 << 5) | 1;  // 1980-01-01

// Little-endian fields, one after the other: a header is built as it stands in
// the tables of APPNOTE.TXT, in the order of the calls.
class Fields {
 public:
  Fields& U16(std::uint32_t value) { return Bytes(value, 2); }
  Fields& U32(std::uint32_t value) { return Bytes(value, 4); }
  Fields& Text(std::string_view text) {
    bytes_ += text;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  // Appends the `n` lowest bytes of `value`, the lowest first.
  Fields& Bytes(std::uint32_t value, int n) {
    constexpr int kBitsOfAByte = 8;
    for (int i = 0; i < n; ++i) {
      bytes_ += static_cast<char>((value >> (kBitsOfAByte * i)) & 0xffU);
    }
    return *this;
  }
  std::string bytes_;
};

// Throws std::invalid_argument where the archive passes a limit of the format:
// its offsets have 32 bits and its counts 16. The larger fields of ZIP64 are
// not written.
void Require(bool fits) {
  if (!fits) {
    throw std::invalid_argument(
        "a ZIP archive holds 65535 files of 4 GiB in all; leave some out");
  }
}

}  // namespace

ZipFile::ZipFile(std::filesystem::path target) : file_(std::move(target)) {}

// `written_` is the offset at which the next byte will stand.
void ZipFile::Write(std::string_view bytes) {
  file_.Write(bytes);
  written_ += bytes.size();
  Require(written_ <= std::numeric_limits<std::uint32_t>::max());
}

void ZipFile::Add(std::string_view name, std::string_view bytes) {
  // Both limits are checked before a byte of the member is written.
  Require(members_.size() < std::numeric_limits<std::uint16_t>::max());
  Require(written_ + bytes.size() + name.size() <=
          std::numeric_limits<std::uint32_t>::max());
  // The checksum stands before the bytes, so it is computed first.
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  const Member member{std::string(name), crc,
                      static_cast<std::uint32_t>(bytes.size()),
                      static_cast<std::uint32_t>(written_)};
  constexpr std::uint32_t kLocalHeader = 0x04034b50;
  Write(Fields()
            .U32(kLocalHeader)
            .U16(kVersion)
            .U16(kUtf8Names)
            .U16(kStored)
            .U16(kMidnight)
            .U16(kFirstDay)
            .U32(member.crc)
            .U32(member.size)
            .U32(member.size)
            .U16(static_cast<std::uint32_t>(name.size()))
            .U16(0)  // no extra field
            .Text(name)
            .bytes());
  Write(bytes);
  members_.push_back(member);
}

// Writes the central directory and its end record, then gives the file its
// name.
void ZipFile::Commit() {
  const auto start = static_cast<std::uint32_t>(written_);
  // One entry for each member, with the offset of its local header.
  constexpr std::uint32_t kCentralHeader = 0x02014b50;
  for (const Member& member : members_) {
    Write(Fields()
              .U32(kCentralHeader)
              .U16(kVersion)
              .U16(kVersion)
              .U16(kUtf8Names)
              .U16(kStored)
              .U16(kMidnight)
              .U16(kFirstDay)
              .U32(member.crc)
              .U32(member.size)
              .U32(member.size)
              .U16(static_cast<std::uint32_t>(member.name.size()))
              .U16(0)  // no extra field
              .U16(0)  // no comment
              .U16(0)  // first disk
              .U16(0)  // internal attributes
              .U32(0)  // external attributes
              .U32(member.offset)
              .Text(member.name)
              .bytes());
  }
  // Readers look for this record from the end of the file.
  constexpr std::uint32_t kEnd = 0x06054b50;
  const auto count = static_cast<std::uint32_t>(members_.size());
  const auto size = static_cast<std::uint32_t>(written_) - start;
  Write(Fields()
            .U32(kEnd)
            .U16(0)  // this disk
            .U16(0)  // the directory's
            .U16(count)
            .U16(count)
            .U32(size)
            .U32(start)
            .U16(0)  // no comment
            .bytes());
  file_.Commit();
}

}  // namespace touchdown::pipeline
