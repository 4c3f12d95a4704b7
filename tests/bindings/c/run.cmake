# cmake -D COMPILER=<C compiler> -D SOURCE=<repository> -D LIB=<folder of liblorica_c.so> -D FILES=<folder> -D WORK=<folder>
#       -P run.cmake
# Compiles the program in C11 and runs it.
file(MAKE_DIRECTORY ${WORK})
set(program ${WORK}/consumer-${COMPILER})
foreach(command
    "${COMPILER} -std=c11 -D_GNU_SOURCE -O1 -Wall -Wextra -Wpedantic -Werror -I${SOURCE}/bindings/c ${SOURCE}/tests/bindings/c/consumer.c -o ${program} -L${LIB} -llorica_c -lm -Wl,-rpath,${LIB}"
    "${program} ${FILES}")
  separate_arguments(arguments UNIX_COMMAND "${command}")
  execute_process(COMMAND ${arguments} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
endforeach()
