# The rooms of a module: an include from one room into another needs an arrow in
# the link lists of the module's CMakeLists.txt (those that arrive through
# PUBLIC lists of others count), and no arrows go round.
# Usage: cmake -D ROOT=<source tree> -P rooms.cmake
cmake_minimum_required(VERSION 3.25)
set(breaches "")
file(GLOB lists RELATIVE "${ROOT}" "${ROOT}/*/CMakeLists.txt")
foreach(list IN LISTS lists)
  file(READ "${ROOT}/${list}" text)
  string(REGEX MATCHALL "touchdown_room\\([^)]*\\)" calls "${text}")
  if(NOT calls)
    continue()
  endif()
  get_filename_component(module "${list}" DIRECTORY)

  set(rooms "")
  foreach(call IN LISTS calls)
    string(REGEX REPLACE "^touchdown_room\\(|\\)$" "" call "${call}")
    string(REGEX MATCHALL "[^ \n]+" words "${call}")
    list(GET words 1 room)
    list(APPEND rooms ${room})
    set(direct_${room} "")
    set(public_${room} "")
    set(kind "")
    foreach(word IN LISTS words)
      if(word MATCHES "^(HEADERS|SOURCES|PUBLIC|PRIVATE)$")
        set(kind ${word})
      elseif(word MATCHES "^touchdown(::|_)${module}_([a-z_]+)$")
        list(APPEND direct_${room} ${CMAKE_MATCH_2})
        if(kind STREQUAL "PUBLIC")
          list(APPEND public_${room} ${CMAKE_MATCH_2})
        endif()
      endif()
    endforeach()
  endforeach()

  foreach(room IN LISTS rooms)
    # What may be included: the list, and what its rooms hand on.
    set(reached_${room} ${direct_${room}})
    # Whether arrows come back.
    set(beyond ${direct_${room}})
    list(LENGTH rooms steps)
    foreach(step RANGE ${steps})
      foreach(other IN LISTS reached_${room})
        list(APPEND reached_${room} ${public_${other}})
      endforeach()
      list(REMOVE_DUPLICATES reached_${room})
      foreach(other IN LISTS beyond)
        list(APPEND beyond ${direct_${other}})
      endforeach()
      list(REMOVE_DUPLICATES beyond)
    endforeach()
    if(room IN_LIST beyond)
      list(APPEND breaches "${list}: arrows from ${room} come back to it")
    endif()

    file(GLOB_RECURSE files RELATIVE "${ROOT}"
         "${ROOT}/${module}/src/${room}/*"
         "${ROOT}/${module}/include/touchdown/${module}/${room}/*")
    foreach(file IN LISTS files)
      file(STRINGS "${ROOT}/${file}" includes REGEX "^#include \"")
      foreach(line IN LISTS includes)
        if(line MATCHES "\"(touchdown/${module}/)?([a-z_]+)/"
           AND CMAKE_MATCH_2 IN_LIST rooms
           AND NOT CMAKE_MATCH_2 STREQUAL room
           AND NOT CMAKE_MATCH_2 IN_LIST reached_${room})
          list(APPEND breaches
               "${file}: ${line} (${room} has no arrow to ${CMAKE_MATCH_2})")
        endif()
      endforeach()
    endforeach()
  endforeach()

  # Every file has a room.
  file(GLOB loose RELATIVE "${ROOT}" "${ROOT}/${module}/src/*.cc"
       "${ROOT}/${module}/src/*.h"
       "${ROOT}/${module}/include/touchdown/${module}/*.h")
  foreach(file IN LISTS loose)
    list(APPEND breaches "${file}: stands in no room")
  endforeach()
endforeach()
if(breaches)
  list(JOIN breaches "\n  " text)
  message(FATAL_ERROR "across a wall between rooms:\n  ${text}")
endif()
