# cmake -D BUILD=<build folder> -D CXX=<compiler> -D CONFIG=<build type> -D LAUNCHER=<compiler launcher> -P run.cmake
# Installs Lorica to a fresh prefix, builds the samples and the consumer against it, and runs them and the command from
# there: `walk` is one of the installed recordings.

set(trial ${BUILD}/tests/consumer/trial)
file(REMOVE_RECURSE ${trial})
set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed with ${status}: ${command}\n${output}")
  endif()
  message("${output}")
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${trial}/prefix)
# expect(PATTERN COMMAND...): runs it; its output must match.
function(expect pattern)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0 OR NOT output MATCHES "${pattern}")
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: exit status ${status}, expected output that matches ${pattern}, found\n${output}")
  endif()
endfunction()

foreach(project consumer samples)
  set(source ${CMAKE_CURRENT_LIST_DIR})
  set(without)
  if(project STREQUAL "samples")
    set(source ${CMAKE_CURRENT_LIST_DIR}/../../docs/samples)
    set(without -DCMAKE_DISABLE_FIND_PACKAGE_glfw3=ON)  # the components that it asks for show nothing
  endif()
  run(${CMAKE_COMMAND} -G Ninja -S ${source} -B ${trial}/${project} -DCMAKE_CXX_COMPILER=${CXX}
      -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_PREFIX_PATH=${trial}/prefix ${without})
  run(${CMAKE_COMMAND} --build ${trial}/${project})
endforeach()
# What reads no character files needs none of the packages that do.
file(WRITE ${trial}/lean/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(lean LANGUAGES CXX)\n"
     "find_package(lorica CONFIG REQUIRED COMPONENTS acd files live world session mannequin tracking)\n")
set(without)
foreach(package glfw3 PNG ZLIB assimp TinyGLTF)
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
run(${CMAKE_COMMAND} -G Ninja -S ${trial}/lean -B ${trial}/lean/build -DCMAKE_CXX_COMPILER=${CXX}
    -DCMAKE_PREFIX_PATH=${trial}/prefix ${without})
# A project may also build Lorica as a part of itself, as docs/LIBRARY.md says; compiling what only links takes minutes.
file(READ ${CMAKE_CURRENT_LIST_DIR}/../../docs/LIBRARY.md page)
string(REGEX MATCH "```cmake\n(include\\(FetchContent[^`]+)```" found "${page}")
file(WRITE ${trial}/fetched/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(fetched LANGUAGES CXX)\n"
     "add_executable(game ${CMAKE_CURRENT_LIST_DIR}/../../docs/samples/decompose_mesh.cpp)\n${CMAKE_MATCH_1}")
run(${CMAKE_COMMAND} -G Ninja -S ${trial}/fetched -B ${trial}/fetched/build -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Debug
    -DFETCHCONTENT_SOURCE_DIR_LORICA=${CMAKE_CURRENT_LIST_DIR}/../..)
execute_process(COMMAND ninja -C ${trial}/fetched/build -t targets all OUTPUT_VARIABLE targets)
string(REGEX MATCH "CMakeFiles/game.dir/[^:\n]*\\.o" object "${targets}")
run(ninja -C ${trial}/fetched/build ${object})
run(${trial}/consumer/consumer)
expect("2 parts, volume 3" ${trial}/samples/decompose_mesh)
expect("frame 20, part 7: .*8 parts, mean time per frame [0-9]+ us" ${trial}/samples/character_hulls)
expect("[1-9][0-9]+ contacts of 200 balls with 12 parts\n0\\.[0-9]+ % of the positions overlap"
       ${trial}/samples/own_physics)
expect("time,user,.*7[0-9] of 80 frames show a person" ${trial}/samples/depth_to_joints)
execute_process(COMMAND ${trial}/samples/watch_session 127.0.0.1:1 ERROR_VARIABLE output)
if(NOT output MATCHES "^127.0.0.1:1: connect: ")
  message(FATAL_ERROR "watch_session: ${output}")
endif()
run(${trial}/prefix/bin/lorica info walk)
file(REMOVE_RECURSE ${trial})
