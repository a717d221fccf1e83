# Archives of what reads pictures, in IMAGE_ARCHIVES, and of SQLite, in
# STORE_ARCHIVES; where some are not there, or do not link, both are empty. Ten
# shared libraries are then loaded whenever the program starts.
#
# Not by default: a security update of the distribution does not reach an
# archive, and libtiff's draws in libjbig (GPL-2+). docs/hardening.md has what
# it costs.
option(TOUCHDOWN_STATIC_READERS
       "Link libtiff, libjpeg, libpng and SQLite as archives" OFF)
set(IMAGE_ARCHIVES)
set(STORE_ARCHIVES)
set(found ${TOUCHDOWN_STATIC_READERS})
set(archives)
# What libtiff needs in turn comes after it.
foreach(part tiff webp zstd lzma Lerc jbig deflate jpeg png16 sqlite3)
  find_library(SYSTEM_${part}_ARCHIVE lib${part}.a)
  list(APPEND archives "${SYSTEM_${part}_ARCHIVE}")
  if(NOT SYSTEM_${part}_ARCHIVE)
    set(found OFF)
  endif()
endforeach()
list(APPEND archives z m ${CMAKE_DL_LIBS})
if(found)
  try_compile(
    SYSTEM_ARCHIVES_LINK SOURCES
    "${PROJECT_SOURCE_DIR}/cmake/system_archives_check.cxx"
    LINK_LIBRARIES ${archives}
    CXX_STANDARD 20)
  if(SYSTEM_ARCHIVES_LINK)
    set(STORE_ARCHIVES "${SYSTEM_sqlite3_ARCHIVE}" m ${CMAKE_DL_LIBS})
    set(IMAGE_ARCHIVES ${archives})
    list(REMOVE_ITEM IMAGE_ARCHIVES "${SYSTEM_sqlite3_ARCHIVE}")
  endif()
endif()
if(TOUCHDOWN_STATIC_READERS AND NOT IMAGE_ARCHIVES)
  message(STATUS "libtiff, SQLite and others are linked as shared libraries: "
                 "no archives that link")
endif()

# touchdown_or_archives(name PROPERTY target...) makes the library `name`: the
# targets or, for a target that has this property, the archives that it holds.
function(touchdown_or_archives name property)
  add_library(${name} INTERFACE)
  set(archives "$<TARGET_PROPERTY:${property}>")
  target_link_libraries(${name} INTERFACE "${archives}")
  foreach(target ${ARGN})
    target_link_libraries(
      ${name} INTERFACE "$<$<NOT:$<BOOL:${archives}>>:${target}>")
  endforeach()
endfunction()
touchdown_or_archives(touchdown_image_files IMAGE_ARCHIVES PNG::PNG TIFF::TIFF
                      JPEG::JPEG)
touchdown_or_archives(touchdown_sqlite STORE_ARCHIVES SQLite::SQLite3)
