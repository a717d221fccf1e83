# Writes the commit that is being built into a header, where it has changed. An
# archive that git made of a commit says in cmake/commit.txt which it is.
# Usage: cmake -D ROOT=<source tree> -D OUT=<commit.h> -P commit.cmake
file(READ "${ROOT}/cmake/commit.txt" commit)
if(commit MATCHES "^([0-9a-f]+)\n$")
  string(SUBSTRING "${CMAKE_MATCH_1}" 0 12 commit)
else()
  execute_process(
    COMMAND git -C "${ROOT}" describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
    RESULT_VARIABLE status)
  if(status OR NOT commit)
    set(commit "unknown commit")
  endif()
endif()
set(text "#define TOUCHDOWN_COMMIT \"${commit}\"\n")
set(before "")
if(EXISTS "${OUT}")
  file(READ "${OUT}" before)
endif()
if(NOT before STREQUAL text)
  file(WRITE "${OUT}" "${text}")
endif()
