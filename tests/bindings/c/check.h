/* What the tests in C share: checks, and counted allocations. For one source file. */
#ifndef LORICA_TESTS_BINDINGS_C_CHECK_H
#define LORICA_TESTS_BINDINGS_C_CHECK_H

#include "lorica.h"

#include <stdio.h>
#include <string.h>

static int failures = 0;
#define CHECK(condition)                                                                    \
  do {                                                                                      \
    if (!(condition)) {                                                                     \
      ++failures;                                                                           \
      printf("line %d: %s\n  last error: %s\n", __LINE__, #condition, lorica_last_error()); \
    }                                                                                       \
  } while (0)
#define FAILS(status, sentence, call)                       \
  do {                                                      \
    CHECK((call) == (status));                              \
    CHECK(strstr(lorica_last_error(), (sentence)) != NULL); \
  } while (0)

/* Every allocation of the program goes through these. */
static long allocations = 0;
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* malloc(size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, size_t size) {
  ++allocations;
  return __libc_realloc(block, size);
}

#endif
