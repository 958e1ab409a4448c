#include "cli/program.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // Large arrays get pages of their own, and give them back. By default the allocator, once it has freed some, keeps
  // later ones on its heap, where what stays between them holds up to a fifth of the peak.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
  return soapfilm::cli::program(argc, argv);
}
