# OpenCV's archives, where they are there and what they need is known, in
# OPENCV_ARCHIVES; otherwise that is empty. Its shared libraries bring many
# others, and to load them all takes much of a short command's time.
set(OPENCV_ARCHIVES)
# What only they need, when they need it.
set(OPENCV_ARCHIVES_SOURCE "${PROJECT_SOURCE_DIR}/app/cli/late_lapack.cc")
set(found ON)
foreach(part calib3d features2d flann imgproc core)
  find_library(OPENCV_${part}_ARCHIVE libopencv_${part}.a)
  list(APPEND archives "${OPENCV_${part}_ARCHIVE}")
  if(NOT OPENCV_${part}_ARCHIVE)
    set(found OFF)
  endif()
endforeach()
list(APPEND archives tbb z ${CMAKE_DL_LIBS} -Wl,--gc-sections)
if(found)
  try_compile(
    OPENCV_ARCHIVES_LINK SOURCES
    "${PROJECT_SOURCE_DIR}/cmake/opencv_archives_check.cxx"
    "${OPENCV_ARCHIVES_SOURCE}"
    CMAKE_FLAGS
      "-DINCLUDE_DIRECTORIES=${OPENCV_INCLUDE_DIR};${PROJECT_SOURCE_DIR}/core/include"
    LINK_LIBRARIES ${archives}
    CXX_STANDARD 20
    OUTPUT_VARIABLE said)
  if(OPENCV_ARCHIVES_LINK)
    set(OPENCV_ARCHIVES ${archives})
  else()
    # Every command starts 9 ms later then, and nothing else shows it.
    message(WARNING "OpenCV's archives are there and do not link:\n${said}")
  endif()
endif()
if(NOT OPENCV_ARCHIVES)
  message(STATUS "OpenCV's shared libraries are linked: no archives that link")
endif()
