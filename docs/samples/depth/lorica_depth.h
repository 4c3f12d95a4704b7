/* Sends depth images to `lorica live --depth`, from C or C++; no dependencies. docs/FORMATS.md has the header.
 * Never tried with a camera. Of a pipe or socket `fd`:
 *
 *   struct lorica_lens lens = {640, 480, 0.001, 575.8, 575.8, 319.5, 239.5, {0}};
 *   lorica_send_depth(fd, &lens, seconds, pixels);
 */
#ifndef LORICA_DEPTH_H
#define LORICA_DEPTH_H

#include <stdint.h>
#include <string.h>
#include <unistd.h>

struct lorica_lens {
  uint32_t width, height;
  double metres_per_unit;
  double fx, fy, cx, cy; /* pixels; the first one's centre is 0, 0 */
  double distortion[8];  /* k1 k2 p1 p2 k3 k4 k5 k6 of OpenCV */
};

/* Returns 0, or -1 if nobody reads any more: see errno. A socket's reader that leaves ends the program with SIGPIPE,
 * unless that is ignored. For machines whose numbers are little-endian. */
static inline int lorica_send_depth(int fd, const struct lorica_lens* lens, double seconds, const uint16_t* pixels) {
  char header[136];
  const uint32_t bytes = 2 * lens->width * lens->height;
  const uint32_t sizes[4] = {1, bytes, lens->width, lens->height};
  memcpy(header, "LORDEPTH", 8);
  memcpy(header + 8, sizes, sizeof sizes);
  memcpy(header + 24, &seconds, 8);
  memcpy(header + 32, (const char*)lens + 8, 8 * 13); /* all of its doubles */
  const char* parts[2] = {header, (const char*)pixels};
  size_t left[2] = {sizeof header, bytes};
  for (int part = 0; part < 2; ++part) {
    while (left[part] > 0) {
      const ssize_t count = write(fd, parts[part], left[part]);
      if (count < 0) return -1;
      parts[part] += count;
      left[part] -= (size_t)count;
    }
  }
  return 0;
}

#endif
