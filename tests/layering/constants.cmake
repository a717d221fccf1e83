# Each named constant of a source folder has a comment: on its own lines, or
# directly above it or above the constants that it stands with. The comment says
# what CONTRIBUTING asks of a tunable: unit, consequence, and how it was chosen.
# Folders are added to the list when all of their constants are explained; none
# is taken off it.
# Usage: cmake -D ROOT=<source tree> -P constants.cmake
cmake_minimum_required(VERSION 3.25)
set(folders
    analysis/src
    calib/src
    core/src
    db/src
    rig/src
    vision/src/background
    vision/src/contact
    vision/src/detection
    vision/src/explanation
    vision/src/footage
    vision/src/numbers
    vision/src/layers
    vision/src/outline
    vision/src/overlay
    vision/src/synthetic
    vision/src/track
    vision/src/tracking)
set(breaches "")
foreach(folder IN LISTS folders)
  file(GLOB_RECURSE files RELATIVE "${ROOT}" "${ROOT}/${folder}/*.h"
       "${ROOT}/${folder}/*.cc")
  foreach(file IN LISTS files)
    file(READ "${ROOT}/${file}" text)
    # One list element a line: no character may divide or join elements.
    string(REGEX REPLACE "[][\\]" "_" text "${text}")
    string(REPLACE ";" "$" text "${text}")
    string(REPLACE "\n" ";" lines "${text}")
    set(number 0)
    set(above FALSE) # a comment stands above, with nothing but constants between
    set(name "") # of the constant whose declaration goes on
    foreach(line IN LISTS lines)
      math(EXPR number "${number} + 1")
      if(NOT name)
        if(line MATCHES "^ *//")
          set(above TRUE)
          continue()
        elseif(NOT line MATCHES
               "(^| )constexpr [^=(]*[ *](k[A-Z][A-Za-z0-9_]*)( =|_|{|$)")
          set(above FALSE)
          continue()
        endif()
        set(name "${CMAKE_MATCH_2}")
        set(at ${number})
        set(explained ${above})
      endif()
      if(line MATCHES "//")
        set(explained TRUE)
      endif()
      if(line MATCHES "[$]( *//.*)?$")
        if(NOT explained)
          string(REGEX REPLACE "_+$" "" name "${name}") # of brackets
          list(APPEND breaches "${file}:${at}: ${name}")
        endif()
        set(name "")
      endif()
    endforeach()
  endforeach()
endforeach()
if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "constants without a comment:\n  ${text}")
endif()
