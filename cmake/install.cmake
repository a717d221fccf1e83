# What `cmake --install` puts below a prefix, and Debian's packages are made of.
# The program needs nothing else of this tree.
include(GNUInstallDirs)
set(TOUCHDOWN_ZSH_FOLDER
    "${CMAKE_INSTALL_DATADIR}/zsh/site-functions"
    CACHE STRING "Where zsh looks for completions, below the prefix")

install(TARGETS touchdown)

# Manual pages and completions, told by the program itself.
set(texts "${PROJECT_BINARY_DIR}/texts")
add_custom_command(
  OUTPUT "${texts}/touchdown.bash"
  COMMAND "${CMAKE_COMMAND}" -E rm -rf "${texts}"
  COMMAND touchdown describe "${texts}"
  DEPENDS touchdown
  VERBATIM)
add_custom_target(touchdown_texts ALL DEPENDS "${texts}/touchdown.bash")
install(DIRECTORY "${texts}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}")
install(
  FILES "${texts}/touchdown.bash"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
  RENAME touchdown)
install(FILES "${texts}/_touchdown" DESTINATION "${TOUCHDOWN_ZSH_FOLDER}")
install(FILES "${texts}/touchdown.fish"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d")

install(FILES app/review/touchdown-review.desktop
        DESTINATION "${CMAKE_INSTALL_DATADIR}/applications")
install(FILES app/review/touchdown.svg
        DESTINATION "${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps")

set(documents "${CMAKE_INSTALL_DATADIR}/doc/touchdown")
install(FILES README.md CONTRIBUTING.md DESTINATION "${documents}")
install(
  DIRECTORY docs
  DESTINATION "${documents}"
  PATTERN examples EXCLUDE)
install(DIRECTORY docs/examples DESTINATION "${documents}"
        USE_SOURCE_PERMISSIONS)

# The licences of what is compiled in, in the words of the packages that it came
# in: headers, and archives that are linked.
set(compiled_in libeigen3-dev libspdlog-dev libcli11-dev nlohmann-json3-dev
                libtomlplusplus-dev libexpected-dev)
if(OPENCV_ARCHIVES)
  list(APPEND compiled_in libopencv-core-dev)
endif()
if(IMAGE_ARCHIVES)
  list(APPEND compiled_in libtiff-dev libjpeg62-turbo-dev libpng-dev
       libsqlite3-dev libwebp-dev libzstd-dev liblzma-dev liblerc-dev
       libjbig-dev libdeflate-dev)
endif()
foreach(package IN LISTS compiled_in)
  set(licence "/usr/share/doc/${package}/copyright")
  if(EXISTS "${licence}")
    install(
      FILES "${licence}"
      DESTINATION "${documents}/licences"
      RENAME "${package}.txt")
  else()
    message(STATUS "the licence of ${package} is not here: ${licence}")
  endif()
endforeach()
