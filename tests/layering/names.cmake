# What no compiler sees: two types of one name in one namespace, each in its own
# file. The linker keeps one of their constructors for both.
# Usage: cmake -D ROOT=<source tree> -P names.cmake
file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/*.h" "${ROOT}/*.cc")
set(breaches "")
set(known "")
foreach(file IN LISTS files)
  if(file MATCHES "^(build|tests/layering/breach|tests/benchmarks)/")
    continue()
  endif()
  file(STRINGS "${ROOT}/${file}" lines
       REGEX "^(namespace|}  // namespace|struct|class|enum class) ?")
  set(space "")
  set(own FALSE) # inside an unnamed namespace
  foreach(line IN LISTS lines)
    if(line MATCHES "^namespace ([a-z_:]+) {")
      set(space "${CMAKE_MATCH_1}")
    elseif(line MATCHES "^namespace {")
      set(own TRUE)
    elseif(line MATCHES "^}  // namespace$")
      set(own FALSE)
    elseif(NOT own AND line MATCHES
                       "^(struct|class|enum class) (alignas\\([0-9]+\\) )?([A-Za-z0-9_]+)[^:;]*( : [^;]*)?{"
    )
      set(name "${space}::${CMAKE_MATCH_3}")
      if(DEFINED "at_${name}")
        list(APPEND breaches "${name}: ${at_${name}} and ${file}")
      endif()
      set("at_${name}" "${file}")
    endif()
  endforeach()
endforeach()
if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "one name for two types:\n  ${text}")
endif()
