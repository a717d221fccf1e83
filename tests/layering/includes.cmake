# What the compiler cannot see: system headers that any target could include.
#   sqlite3.h      only in db/src and in its tests
#   OpenCV         only in calib/src and vision/src
#   spdlog         never in a header
#   CLI11          only where the whole command line is parsed or described
#   app/           never included by a module
# Usage: cmake -D ROOT=<source tree> -P includes.cmake
file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/*.h" "${ROOT}/*.cc")
set(breaches "")
foreach(file IN LISTS files)
  if(file MATCHES "^(build|tests/layering/breach|tests/benchmarks)/")
    continue()
  endif()
  file(STRINGS "${ROOT}/${file}" includes REGEX "^[ \t]*#[ \t]*include")
  foreach(line IN LISTS includes)
    if(line MATCHES "sqlite3\\.h" AND NOT file MATCHES "^(db/src|tests/db)/")
      list(APPEND breaches "${file}: ${line} (SQLite belongs in db/src)")
    endif()
    if(line MATCHES "opencv2?/" AND NOT file MATCHES "^(calib|vision)/src/")
      list(APPEND breaches
           "${file}: ${line} (OpenCV belongs in calib/src and vision/src)")
    endif()
    if(line MATCHES "spdlog/" AND file MATCHES "\\.h$")
      list(APPEND breaches "${file}: ${line} (spdlog stays out of headers)")
    endif()
    if(line MATCHES "CLI/"
       AND NOT file MATCHES "^app/cli/(options|main|command_tree|defaults)\\.cc$")
      list(APPEND breaches
           "${file}: ${line} (CLI11 stands behind app/cli/options.h)")
    endif()
    if(line MATCHES "[\"<]app/" AND NOT file MATCHES "^(app|tests)/")
      list(APPEND breaches "${file}: ${line} (modules do not know app)")
    endif()
  endforeach()
endforeach()
if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "includes across a wall of the house:\n  ${text}")
endif()
