# What makes an error of the program harder to use. Always: addresses that nobody
# knows (PIE), tables of functions that cannot be overwritten (full RELRO), a
# stack that is not executed. With TOUCHDOWN_HARDENED, the default, in builds of
# release: stacks and buffers that are checked, and jumps that land where they
# may (CET; in force only where every archive and library has it, which Debian
# 12's have not). tests/app/hardening_test.cc reads it from the program;
# docs/hardening.md has the table of what is static, and what it costs.
include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
add_link_options(LINKER:-z,relro LINKER:-z,now LINKER:-z,noexecstack)

option(TOUCHDOWN_HARDENED
       "Stack protector, FORTIFY_SOURCE=2 and CET in builds of release" ON)
if(TOUCHDOWN_HARDENED)
  add_compile_options(
    $<$<CONFIG:Release>:-fstack-protector-strong>
    $<$<CONFIG:Release>:-U_FORTIFY_SOURCE>
    $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    add_compile_options($<$<CONFIG:Release>:-fcf-protection=full>)
  endif()
endif()
