# cmake -D BUILD=<build folder> -D CXX=<compiler> -D LAUNCHER=<compiler launcher> -D HASHES=<program> -P run_core.cmake
# Builds the core alone, with none of the packages that only the rest needs: what it makes is what the whole library
# makes, bit for bit, with and without threads.
set(trial ${BUILD}/tests/consumer/core_trial)
file(REMOVE_RECURSE ${trial})
set(without)
foreach(package nlohmann_json CLI11 TBB PNG ZLIB OpenCV glfw3 assimp TinyGLTF draco meshoptimizer pugixml OpenSSL)
  list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
foreach(step "-G;Ninja;-S;${CMAKE_CURRENT_LIST_DIR}/core;-B;${trial};-DCMAKE_CXX_COMPILER=${CXX};-DCMAKE_BUILD_TYPE=Release;-DWITH_INTERFACE=OFF;-DLORICA_SOURCE=${CMAKE_CURRENT_LIST_DIR}/../..;${without}"
             "--build;${trial}")
  execute_process(COMMAND ${CMAKE_COMMAND} ${step} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${step}: ${output}")
  endif()
endforeach()
execute_process(COMMAND ${trial}/core_hashes OUTPUT_VARIABLE alone COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${HASHES} OUTPUT_VARIABLE whole COMMAND_ERROR_IS_FATAL ANY)
if(NOT alone STREQUAL whole OR NOT alone MATCHES "parts [0-9a-f]+\nhulls [0-9a-f]+\n")
  message(FATAL_ERROR "the core alone makes\n${alone}the whole library\n${whole}")
endif()
message("${alone}")
file(REMOVE_RECURSE ${trial})
