# The target frm_zstd: the system's zstd, or one built from FRM_ZSTD_SOURCE, its source tree, where the target system has
# no package of it (a cross build for Windows or WebAssembly). `apt-get source libzstd` gives such a tree.
if(NOT FRM_ZSTD_SOURCE)
  if(NOT PKG_CONFIG_FOUND)
    message(FATAL_ERROR "zstd is found by pkg-config, which is not there; or set FRM_ZSTD_SOURCE to zstd's source tree")
  endif()
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
  add_library(frm_zstd INTERFACE)
  target_link_libraries(frm_zstd INTERFACE PkgConfig::ZSTD)
  return()
endif()

if(NOT EXISTS ${FRM_ZSTD_SOURCE}/lib/zstd.h)
  message(FATAL_ERROR "FRM_ZSTD_SOURCE: ${FRM_ZSTD_SOURCE} is not zstd's source tree: it has no lib/zstd.h")
endif()
file(GLOB frm_zstd_sources ${FRM_ZSTD_SOURCE}/lib/common/*.c ${FRM_ZSTD_SOURCE}/lib/compress/*.c
  ${FRM_ZSTD_SOURCE}/lib/decompress/*.c)
add_library(frm_zstd STATIC ${frm_zstd_sources})
target_include_directories(frm_zstd SYSTEM INTERFACE $<BUILD_INTERFACE:${FRM_ZSTD_SOURCE}/lib>)
# One file of it is assembly, for another language of CMake's. Hidden, so that libfrm does not give it to others.
target_compile_definitions(frm_zstd PRIVATE ZSTD_DISABLE_ASM=1 ZSTDLIB_VISIBLE= ZSTDERRORLIB_VISIBLE=)
set_target_properties(frm_zstd PROPERTIES C_EXTENSIONS ON)
