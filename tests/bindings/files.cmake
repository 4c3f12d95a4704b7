# cmake -D FILES=<folder> -D TRUTH=<program> -D LORICA=<command> -D RECORDINGS=<folder> -P files.cmake
# Makes the files that the tests of the bindings share.
file(REMOVE_RECURSE ${FILES})
file(MAKE_DIRECTORY ${FILES})
set(ENV{XDG_CACHE_HOME} ${FILES}/cache)
set(commands
  "${LORICA} decompose mannequin --parts 4 -o ${FILES}/body.lorica"
  "${LORICA} convert walk ${FILES}/walk.bvh"
  "${TRUTH} glb ${FILES}/hero.glb"
  "${TRUTH} hulls ${FILES}/body.lorica ${RECORDINGS}/walk.csv 40 ${FILES}/walk_csv.hulls"
  "${TRUTH} hulls ${FILES}/body.lorica ${FILES}/walk.bvh 40 ${FILES}/walk_bvh.hulls"
  "${TRUTH} touches ${FILES}/body.lorica ${RECORDINGS}/walk.csv 40 ${FILES}/walk_csv.touches"
  "${TRUTH} depth ${RECORDINGS}/wave_depth.oni 20 ${FILES}/depth")
foreach(command ${commands})
  separate_arguments(arguments UNIX_COMMAND "${command}")
  execute_process(COMMAND ${arguments} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed with ${status}: ${command}\n${output}")
  endif()
endforeach()
