# Writes files into a C++ source as bytes, to be found by name (page_files.h).
# Usage: cmake -D OUT=page_files.cc -D FILES=a;b -P embed.cmake
set(arrays "")
set(entries "")
set(number 0)
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(................................................................................)"
                       "\\1\n" bytes "${bytes}")
  string(APPEND arrays
         "constexpr unsigned char kBytes${number}[] = {\n${bytes}};\n")
  string(APPEND entries "    {\"${name}\", kBytes${number}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(
  WRITE "${OUT}"
  "#include \"app/review/page_files.h\"

namespace touchdown::review {
namespace {

${arrays}
struct Entry {
  std::string_view name;
  std::span<const unsigned char> bytes;
};
constexpr Entry kEntries[] = {
${entries}};

}  // namespace

std::optional<std::string_view> PageFile(std::string_view name) {
  for (const Entry& entry : kEntries) {
    if (entry.name == name) {
      return std::string_view(
          reinterpret_cast<const char*>(entry.bytes.data()),
          entry.bytes.size());
    }
  }
  return std::nullopt;
}

}  // namespace touchdown::review
")
