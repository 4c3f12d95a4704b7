# cmake -DCMAKE_TOOLCHAIN_FILE=tools/cmake/systems/web.cmake -DLORICA_CORE=ON: the core as WebAssembly, by emscripten.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
set(CMAKE_CXX_COMPILER_LAUNCHER "")
# Eigen's and Highway's vectors: SSE2's, which emscripten has on those of WebAssembly, and Highway's own for any compiler.
# Eigen would choose assembly for x86 by the version of the compiler.
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -msse2 -fgnuc-version=5.99 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 -DHWY_COMPILE_ONLY_EMU128 -include ${CMAKE_CURRENT_LIST_DIR}/old_libcxx.h")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-sALLOW_MEMORY_GROWTH=1 -sTOTAL_STACK=4194304 -sENVIRONMENT=node -sNODERAWFS=1 -sEXIT_RUNTIME=1")
