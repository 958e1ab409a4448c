// No files in place of memory.
#include "soapfilm/platform/scratch.h"

#include "soapfilm/error.h"

namespace soapfilm {

bool has_scratch_files() { return false; }

uint64_t free_disk_bytes(const std::string&) { return UINT64_MAX; }

void check_scratch_folder(const std::string& folder) {
  throw OutputError(folder + ": arrays in files are not built into this program");
}

int make_scratch_file(const std::string& folder, size_t) {
  check_scratch_folder(folder);
  return -1;
}

void close_scratch_file(int) {}

void check_scratch_files(const std::string&) {}

}  // namespace soapfilm
