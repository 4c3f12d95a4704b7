# cmake -D BUILD=<build folder> -D CXX=<compiler> -D CONFIG=<build type> -P run.cmake
# Installs Lorica to a fresh prefix, builds the samples and the consumer against it, and runs them and the command from
# there: `walk` is one of the installed recordings.

set(work ${BUILD}/tests/consumer/work)
file(REMOVE_RECURSE ${work})

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed with ${status}: ${command}\n${output}")
  endif()
  message("${output}")
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${work}/prefix)
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
    set(source ${CMAKE_CURRENT_LIST_DIR}/../../samples)
    # The components that it asks for need none of these packages.
    foreach(package glfw3 GIF PNG ZLIB assimp TinyGLTF)
      list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
    endforeach()
  endif()
  run(${CMAKE_COMMAND} -G Ninja -S ${source} -B ${work}/${project} -DCMAKE_CXX_COMPILER=${CXX}
      -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_PREFIX_PATH=${work}/prefix ${without})
  run(${CMAKE_COMMAND} --build ${work}/${project})
endforeach()
run(${work}/consumer/consumer)
expect("2 parts, volume 3\\.000" ${work}/samples/decompose_mesh)
expect("frame 20, part 7: .*8 parts, mean time per frame [0-9]+ us" ${work}/samples/character_hulls)
expect("[1-9][0-9]+ contacts of 200 balls with 12 parts\n0\\.[0-9]+ % of the positions overlap"
       ${work}/samples/own_physics)
expect("time,user,.*7[0-9] of 80 frames show a person" ${work}/samples/depth_to_joints)
run(${work}/prefix/bin/lorica info walk)
file(REMOVE_RECURSE ${work})
