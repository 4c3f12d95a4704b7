# cmake -D COMPILER=<C compiler> -D SOURCE=<repository> -D LIB=<folder of liblorica_c.so> -D FILES=<folder> -D WORK=<folder>
#       -P run.cmake
# Compiles the program in C11 and runs it, and compiles every example of the documents as printed, in a function that has
# what they name.
file(MAKE_DIRECTORY ${WORK})
set(flags -std=c11 -D_GNU_SOURCE -O1 -Wall -Wextra -Wpedantic -Werror -I${SOURCE}/bindings/c)
list(JOIN flags " " flags)
set(examples)
file(GLOB documents ${SOURCE}/README.md ${SOURCE}/docs/*.md)
foreach(document ${documents})
  file(READ ${document} text)
  string(FIND "${text}" "```c\n" begin)
  while(NOT begin EQUAL -1)
    math(EXPR begin "${begin} + 5")
    string(SUBSTRING "${text}" ${begin} -1 text)
    string(FIND "${text}" "```" end)
    string(SUBSTRING "${text}" 0 ${end} code)
    string(SUBSTRING "${text}" ${end} -1 text)
    string(FIND "${text}" "```c\n" begin)
    list(LENGTH examples number)
    set(file ${WORK}/example_${COMPILER}_${number}.c)
    file(WRITE ${file} "#include <lorica.h>
int complain(const char *message);
void use(const double *vertices, size_t vertex_count, const int32_t *triangles, size_t triangle_count);
int example(const double *world_from_joint, size_t joint_count);
int example(const double *world_from_joint, size_t joint_count) {
${code}}
")
    list(APPEND examples "${COMPILER} ${flags} -fsyntax-only ${file}")
  endwhile()
endforeach()
if(NOT examples)
  message(FATAL_ERROR "no document has an example in C")
endif()
set(program ${WORK}/consumer-${COMPILER})
foreach(command ${examples}
    "${COMPILER} ${flags} ${SOURCE}/tests/bindings/c/consumer.c -o ${program} -L${LIB} -llorica_c -lm -Wl,-rpath,${LIB}"
    "${program} ${FILES}")
  separate_arguments(arguments UNIX_COMMAND "${command}")
  execute_process(COMMAND ${arguments} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${command}: ${status}\n${output}")
  endif()
endforeach()
