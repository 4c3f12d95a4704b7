# cmake -D SOURCE=<repository> -D LIB=<liblorica_c.so> -D WORK=<folder> -P interface.cmake
# Compares the binary interface with interface.txt, which programs that are already compiled rely on: symbols that the
# library exports, prototypes, layouts of structs, values of enums. After a change that keeps such programs running, such as
# a new function, copy what the message names over interface.txt; else raise SOVERSION first.
file(MAKE_DIRECTORY ${WORK})
set(found ${WORK}/interface.txt)

function(run variable)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE error)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed with ${status}: ${ARGN}\n${output}${error}")
  endif()
  set(${variable} "${output}" PARENT_SCOPE)
endfunction()

run(symbols nm -D --defined-only --format=posix ${LIB})
string(REGEX REPLACE " [A-Z] [^\n]*\n" "\n" symbols "${symbols}")
run(ignored gcc -std=c11 -aux-info ${WORK}/prototypes -c -o /dev/null -x c bindings/c/lorica.h)
file(STRINGS ${WORK}/prototypes prototypes REGEX "lorica\\.h")
list(TRANSFORM prototypes REPLACE "^/\\*[^*]*\\*/ " "")
list(TRANSFORM prototypes REPLACE ";$" "")
list(SORT prototypes)
list(JOIN prototypes "\n" prototypes)
run(ignored gcc -std=c11 -Wall -Werror -Ibindings/c tests/bindings/c/layout.c -o ${WORK}/layout)
run(layouts ${WORK}/layout)
file(WRITE ${found} "${symbols}\n${prototypes}\n\n${layouts}")

execute_process(COMMAND diff -u ${SOURCE}/tests/bindings/c/interface.txt ${found} RESULT_VARIABLE differs OUTPUT_VARIABLE difference)
if(differs)
  message(FATAL_ERROR "The binary interface changed; the new one is ${found}:\n${difference}")
endif()
