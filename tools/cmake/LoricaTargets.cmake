# One way to declare a folder's library and a folder's tests, so that flags and include paths are said once.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
set(CMAKE_BUILD_RPATH ${CMAKE_BINARY_DIR}/lib/lorica)  # of modules, see lorica_module
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# ccache makes a second build of the same files fast, in another folder too: paths below the root are hashed as relative
# ones, the compiler by its content, and all compile in one locale. Off with LORICA_NO_CCACHE in the environment. A launcher
# that was named on the command line wins.
find_program(LORICA_CCACHE ccache)
mark_as_advanced(LORICA_CCACHE)
if(LORICA_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER AND NOT DEFINED ENV{LORICA_NO_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER
      env --unset=LC_ALL --unset=LC_CTYPE --unset=LC_MESSAGES LANG=C.UTF-8
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true CCACHE_COMPILERCHECK=content
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${LORICA_CCACHE})
  set(LORICA_USES_CCACHE TRUE)
endif()

# Everything is compiled and linked with the sanitizers or nothing is: see the presets asan-ubsan and tsan.
set(LORICA_SANITIZE "" CACHE STRING "Sanitizers for the whole build, as for -fsanitize=: address,undefined or thread")
if(LORICA_SANITIZE)
  add_compile_options(-fsanitize=${LORICA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${LORICA_SANITIZE})
endif()
# Then clang also calls a function at each branch, which does nothing but where a test counts the work of readers
# (tests/export/robots/reader_work_test.cpp). That takes up to as long again, so not in what is HOT and only computes. Not beside
# libFuzzer's own counters.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND LORICA_SANITIZE MATCHES "address" AND NOT LORICA_SANITIZE MATCHES "fuzzer")
  set(LORICA_COUNTS_WORK ON)
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fsanitize-coverage=trace-pc-guard>)
endif()

# The headers that nearly every file includes take longer than most files themselves: they are compiled once for all
# targets of a kind (library, tests, apps), with the flags of that kind. Not with clang and ccache: clang's precompiled
# headers hold paths, so that no other folder could use what is cached.
function(lorica_precompile target kind)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINKS" ${ARGN})
  if(CMAKE_CXX_COMPILER_LAUNCHER AND NOT (LORICA_USES_CCACHE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU"))
    return()
  endif()
  set(precompiled lorica_precompiled_${kind})
  if(NOT TARGET ${precompiled})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp CONTENT "// Holds the precompiled headers.\n")
    add_library(${precompiled} OBJECT ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp)
    target_link_libraries(${precompiled} PRIVATE ${ARG_LINKS})
    target_precompile_headers(${precompiled} PRIVATE ${ARG_HEADERS})
    get_target_property(position_independent ${target} POSITION_INDEPENDENT_CODE)
    set_target_properties(${precompiled} PROPERTIES POSITION_INDEPENDENT_CODE ${position_independent})
    lorica_flags(${precompiled})
    if(NOT kind STREQUAL "library")
      lorica_optimise(${precompiled} -O1)
    endif()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
endfunction()

# Batches: some twelve files of a library are compiled as one, so that what they include is read once: the first build takes
# clearly less time. Therefore names in unnamed namespaces are unique in a folder, or mean the same. Off
# in the preset `dev`, for those who change one file again and again, and under sanitizers, so that every file is also compiled
# by itself. Files with vector instructions (Highway) include themselves once for each instruction set and stay single, as
# do those with compile options of their own (SINGLE).
# A function in an unnamed namespace must not have the name of one in a header either: it hides that for all other files of
# its batch, and where an argument converts, as anything does to JSON, the wrong one is called without a warning.
option(LORICA_BATCHES "Compile several files of a folder as one" ON)
function(lorica_batches target)
  if(NOT LORICA_BATCHES OR LORICA_SANITIZE)
    return()
  endif()
  # What files compiled one by one are warned of: a local name like one of another file, and members whose type is in an
  # unnamed namespace, which g++ allows in the main file only.
  target_compile_options(${target} PRIVATE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(FILTER sources EXCLUDE REGEX "_kernel\\.cpp$")
  list(REMOVE_ITEM sources "" ${ARGN})
  set_source_files_properties(${sources} PROPERTIES HEADER_FILE_ONLY ON)
  # CMake's own batches name files by absolute paths, which ccache cannot know again in another folder.
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(number 0)
  while(sources)
    list(SUBLIST sources 0 12 batch)
    list(REMOVE_ITEM sources ${batch})
    list(TRANSFORM batch REPLACE "(.+)" "#include \"${folder}/\\1\"\n" OUTPUT_VARIABLE text)
    string(JOIN "" text ${text})
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${target}_batch_${number}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}")
    target_sources(${target} PRIVATE ${file})
    math(EXPR number "${number} + 1")
  endwhile()
endfunction()

# Fused multiply-add is off everywhere: results must not depend on the compiler's taste. On arm64 Eigen's vectors fuse them,
# whatever the compiler is told.
set(LORICA_EXACT -ffp-contract=off)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  list(APPEND LORICA_EXACT -U__ARM_FEATURE_FMA)
endif()
function(lorica_flags target)
  if(LORICA_USES_CCACHE)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)  # so that ccache sees them
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor ${LORICA_EXACT}
                                           $<$<BOOL:${LORICA_WERROR}>:-Werror>)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    # g++ 12 crashes on arm_sve.h; NEON is what every arm64 has.
    target_compile_options(${target} PRIVATE -Wno-psabi)
    target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
  endif()
  # With precompiled headers g++ 12 does not see that code is the standard library's and reports false alarms there.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread>)
endfunction()

# Release builds optimise with -O3 what spends most of the time: libraries that are declared HOT. It takes g++ four times as
# long as -O2, which the other libraries are compiled with. Tests and the command spend their time in the libraries: -O1.
function(lorica_optimise target level)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()

# In another project's build (FetchContent) headers are named as installed ones are, <lorica/acd/decompose.h>.
set(lorica_as_installed)
if(NOT PROJECT_IS_TOP_LEVEL)
  set(lorica_as_installed ${PROJECT_BINARY_DIR}/as_installed)
  file(MAKE_DIRECTORY ${lorica_as_installed})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR} ${lorica_as_installed}/lorica SYMBOLIC)
endif()

# lorica_library(acd SOURCES a.cpp b.cpp HEADERS a.h LINKS lorica::geometry PRIVATE_LINKS TBB::tbb)
# HEADERS are the public ones: they are installed, and include each other as <lorica/acd/a.h> there. Internal headers are
# not listed. SINGLE sources are in no batch. HOT: see lorica_optimise. ONCE: its sources that are small rather than quick in a
# page, which loads them.
function(lorica_library name)
  cmake_parse_arguments(ARG "HOT" "" "SOURCES;HEADERS;LINKS;PRIVATE_LINKS;SINGLE;ONCE" ${ARGN})
  add_library(lorica_${name} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
  add_library(lorica::${name} ALIAS lorica_${name})
  set_target_properties(lorica_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(lorica_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> "$<BUILD_INTERFACE:${lorica_as_installed}>" $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(lorica_${name} PUBLIC cxx_std_20)  # for those who use the installed headers
  # A library of headers is not needed by those who link the result.
  list(TRANSFORM ARG_PRIVATE_LINKS REPLACE "^(nlohmann_json::.*)$" "$<BUILD_INTERFACE:\\1>")
  target_link_libraries(lorica_${name} PUBLIC ${ARG_LINKS} PRIVATE ${ARG_PRIVATE_LINKS})
  lorica_flags(lorica_${name})
  if(EMSCRIPTEN AND NOT name MATCHES "^(geometry|acd|live|hulls)$")
    lorica_optimise(lorica_${name} -Oz)  # what a page loads
  elseif(EMSCRIPTEN)
    set_source_files_properties(${ARG_ONCE} PROPERTIES COMPILE_OPTIONS -Oz)
    list(APPEND ARG_SINGLE ${ARG_ONCE})
  elseif(NOT ARG_HOT)
    lorica_optimise(lorica_${name} -O2)
  elseif(LORICA_COUNTS_WORK AND NOT name STREQUAL "geometry")
    target_compile_options(lorica_${name} PRIVATE -fno-sanitize-coverage=trace-pc-guard)  # it computes
  endif()
  lorica_batches(lorica_${name} ${ARG_SINGLE})
  lorica_precompile(lorica_${name} library LINKS Eigen3::Eigen fmt::fmt
    HEADERS <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <algorithm> <filesystem> <functional> <memory> <optional> <string> <variant> <vector>)
  set_property(GLOBAL APPEND PROPERTY LORICA_COMPONENTS ${name})
  set_property(GLOBAL PROPERTY LORICA_LINKS_${name} ${ARG_LINKS} ${ARG_PRIVATE_LINKS})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  list(TRANSFORM ARG_HEADERS PREPEND ${folder}/ OUTPUT_VARIABLE installed)
  set_property(GLOBAL APPEND PROPERTY LORICA_HEADERS ${installed})
  install(CODE "
    foreach(header ${ARG_HEADERS})
      file(READ \"${CMAKE_CURRENT_SOURCE_DIR}/\${header}\" text)
      string(REGEX REPLACE \"#include \\\"([^\\\"]+)\\\"\" \"#include <lorica/\\\\1>\" text \"\${text}\")
      file(WRITE \"${PROJECT_BINARY_DIR}/headers/${folder}/\${header}\" \"\${text}\")
      file(INSTALL \"${PROJECT_BINARY_DIR}/headers/${folder}/\${header}\"
           DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/lorica/${folder}\")
    endforeach()" COMPONENT development)
  install(TARGETS lorica_${name} EXPORT loricaTargets)
endfunction()

# lorica_embed(segmentation person_network.bin personNetworkFile): a file of a library's folder, or one that is built,
# becomes part of the library, as std::span<const std::uint8_t> lorica::personNetworkFile().
function(lorica_embed library file function)
  cmake_path(ABSOLUTE_PATH file)
  cmake_path(GET file FILENAME name)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  add_custom_command(OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -D FILE=${file} -D FUNCTION=${function} -D SOURCE=${source}
            -P ${PROJECT_SOURCE_DIR}/tools/cmake/EmbedFile.cmake
    DEPENDS ${file} ${PROJECT_SOURCE_DIR}/tools/cmake/EmbedFile.cmake VERBATIM)
  set_source_files_properties(${source} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
  target_sources(lorica_${library} PRIVATE ${source})
endfunction()

# lorica_module(level_set FOR body SOURCES level_set_module.cpp LINKS ...): a shared library that a folder's library loads
# when it is first needed (geometry/module.h). It lies in lib/lorica, and the run path of whatever links the folder's
# library leads there: of a program of this build by CMAKE_BUILD_RPATH, of one outside by the exported target.
# Symbols stay visible: OpenVDB keeps statics in templates, which must be the same for its library and for the module.
function(lorica_module name)
  cmake_parse_arguments(ARG "" "FOR" "SOURCES;LINKS" ${ARGN})
  add_library(lorica_${name}_module MODULE ${ARG_SOURCES})
  set_target_properties(lorica_${name}_module PROPERTIES
    OUTPUT_NAME lorica_${name} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/lorica)
  target_include_directories(lorica_${name}_module PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(lorica_${name}_module PRIVATE ${ARG_LINKS})
  lorica_flags(lorica_${name}_module)
  add_dependencies(lorica_${ARG_FOR} lorica_${name}_module)
  target_link_options(lorica_${ARG_FOR} INTERFACE
    $<INSTALL_INTERFACE:LINKER:-rpath,$<INSTALL_PREFIX>/${CMAKE_INSTALL_LIBDIR}/lorica>)
  install(TARGETS lorica_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lorica
          COMPONENT command)
endfunction()

# lorica_tests(acd SOURCES a_test.cpp LINKS lorica::acd): one test program a folder; ctest runs each test by itself.
#   ALONE Suite.*   tests with windows, cameras or networks: ctest runs one of them at a time, and others in parallel, since
#                   they wait for what they need to see and never for a time. It starts with them, so that none is left
#                   for the end, where nothing runs beside them
#   SANITIZED *     .ci/run also runs these tests, built by clang under sanitizers (target sanitized_tests, label
#                   sanitized): those of code that reads data from outside. Sessions use nearly all the rest, which takes as
#                   long again to build: scripts/check --thorough has them
#   SLOW Suite.*    too slow for that: label slow
#   LABEL peers     tests that need more than the libraries, to be run by themselves too; else the label is release
function(lorica_tests name)
  cmake_parse_arguments(ARG "" "LABEL" "SOURCES;LINKS;ALONE;SANITIZED;SLOW" ${ARGN})
  add_executable(${name}_tests ${ARG_SOURCES})
  target_link_libraries(${name}_tests PRIVATE ${ARG_LINKS} lorica_test_support GTest::gtest_main)
  lorica_flags(${name}_tests)
  lorica_optimise(${name}_tests -O1)
  lorica_precompile(${name}_tests tests LINKS Eigen3::Eigen GTest::gtest
    HEADERS <gtest/gtest.h> <Eigen/Core> <Eigen/Geometry> <algorithm> <filesystem> <functional>)
  set(timeout 300)
  # A browser that draws in software takes minutes where it is not alone.
  if(CMAKE_BUILD_TYPE STREQUAL "Debug" OR ARG_LABEL STREQUAL "peers")
    set(timeout 1500)
  endif()
  set(label release)
  if(ARG_LABEL)
    set(label ${ARG_LABEL})
  endif()
  list(JOIN ARG_ALONE ":" alone)
  list(JOIN ARG_SLOW ":" slow)
  if(ARG_SANITIZED)
    add_dependencies(sanitized_tests ${name}_tests)
  endif()
  # Under sanitizers one process runs all tests of a program: what they share is prepared once, which takes most of the time.
  if(LORICA_SANITIZE)
    set(chosen "*")
    if(ARG_SANITIZED AND NOT LORICA_SANITIZE STREQUAL "thread")
      list(JOIN ARG_SANITIZED ":" chosen)
      set(label sanitized)
    else()
      set(timeout 7200)
    endif()
    add_test(NAME ${name} COMMAND ${name}_tests "--gtest_filter=${chosen}-${slow}")
    set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout} LABELS ${label})
    if(alone)
      set_tests_properties(${name} PROPERTIES RESOURCE_LOCK devices)
    endif()
    if(NOT chosen STREQUAL "*")
      add_test(NAME ${name}.rest COMMAND ${name}_tests "--gtest_filter=-${chosen}:${slow}")
      set_tests_properties(${name}.rest PROPERTIES TIMEOUT 7200 LABELS slow)
    endif()
    if(slow)
      add_test(NAME ${name}.slow COMMAND ${name}_tests "--gtest_filter=${slow}")
      set_tests_properties(${name}.slow PROPERTIES TIMEOUT 7200 LABELS slow)
    endif()
    return()
  endif()
  set(discovery TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60)
  gtest_discover_tests(${name}_tests ${discovery} TEST_FILTER "-${alone}:${slow}"
                       PROPERTIES TIMEOUT ${timeout} LABELS ${label})
  if(alone)
    gtest_discover_tests(${name}_tests ${discovery} TEST_FILTER "${alone}" TEST_LIST ${name}_tests_alone
                         PROPERTIES TIMEOUT ${timeout} LABELS ${label} RESOURCE_LOCK devices COST 100)
  endif()
  if(slow)
    gtest_discover_tests(${name}_tests ${discovery} TEST_FILTER "${slow}" TEST_LIST ${name}_tests_slow
                         PROPERTIES TIMEOUT ${timeout} LABELS slow)
  endif()
endfunction()
