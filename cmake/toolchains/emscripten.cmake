# WebAssembly, by Emscripten (Debian's package, or one that the variable EMSDK of the environment names): one static
# library, and programs that run under node. zstd from FRM_ZSTD_SOURCE; FRM_OPENMP must be OFF. With Debian's package the
# environment needs NODE_PATH=/usr/share/nodejs, and no EM_CACHE.
if(DEFINED ENV{EMSDK})
  set(frm_emscripten $ENV{EMSDK}/upstream/emscripten)
else()
  set(frm_emscripten /usr/share/emscripten)
endif()
if(NOT EXISTS ${frm_emscripten}/cmake/Modules/Platform/Emscripten.cmake)
  message(FATAL_ERROR "Emscripten is not in ${frm_emscripten}: install it, or set EMSDK in the environment")
endif()
# Errors are exceptions inside the library.
set(CMAKE_C_FLAGS_INIT "-fexceptions")
set(CMAKE_CXX_FLAGS_INIT "-fexceptions")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fexceptions -sALLOW_MEMORY_GROWTH=1 -sNODERAWFS=1 -sEXIT_RUNTIME=1")
if(NOT EXISTS ${frm_emscripten}/system/lib/libcxx/include/memory_resource)
  string(APPEND CMAKE_CXX_FLAGS_INIT " -isystem ${CMAKE_CURRENT_LIST_DIR}/emscripten")
endif()
include(${frm_emscripten}/cmake/Modules/Platform/Emscripten.cmake)
