# cmake -DCMAKE_TOOLCHAIN_FILE=tools/cmake/systems/web.cmake -DLORICA_CORE=ON: the core as WebAssembly, by emscripten.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/llvm)
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
# Debian 12's emscripten calls LLVM 14, which writes wrong code: a number that is used alone and for all lanes of a vector is
# loaded twice, the second time after it was written (v = isometry * v). LLVM 16 by the names of 14 does it right.
set(run env NODE_PATH=/usr/share/nodejs)
if(EXISTS /usr/lib/llvm-16/bin/clang)
  foreach(tool clang clang++ wasm-ld llvm-ar llvm-nm llvm-objcopy llvm-ranlib)
    file(CREATE_LINK /usr/lib/llvm-16/bin/${tool} ${CMAKE_BINARY_DIR}/llvm/${tool}-14 SYMBOLIC)
  endforeach()
  list(APPEND run EM_LLVM_ROOT=${CMAKE_BINARY_DIR}/llvm)
endif()
set(CMAKE_CXX_LINKER_LAUNCHER ${run})
# As in LoricaTargets.cmake; em++ is a script, so what it calls is named.
find_program(LORICA_CCACHE ccache)
if(LORICA_CCACHE AND NOT DEFINED ENV{LORICA_NO_CCACHE})
  get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
  list(APPEND run CCACHE_BASEDIR=${root} CCACHE_NOHASHDIR=true CCACHE_COMPILERCHECK=content CCACHE_COMPILERTYPE=clang
       CCACHE_EXTRAFILES=/usr/share/emscripten/emscripten-version.txt:/usr/lib/llvm-16/bin/clang ${LORICA_CCACHE})
endif()
set(CMAKE_CXX_COMPILER_LAUNCHER ${run})
# Eigen's vectors are SSE2's, which emscripten has on those of WebAssembly, so that its sums have the order that they have
# elsewhere; its small functions would stay calls. It would choose assembly for x86 by the version of the compiler. Highway's
# are those of WebAssembly, with what web/hwy/highway.h adds.
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -msse2 -fgnuc-version=5.99 -DEIGEN_MAX_STATIC_ALIGN_BYTES=16 \"-DEIGEN_STRONG_INLINE=inline __attribute__((always_inline))\" -I${CMAKE_CURRENT_LIST_DIR}/web -include ${CMAKE_CURRENT_LIST_DIR}/old_libcxx.h")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-sALLOW_MEMORY_GROWTH=1 -sMAXIMUM_MEMORY=4GB -sTOTAL_STACK=4194304")
