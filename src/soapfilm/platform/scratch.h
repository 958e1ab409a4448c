// Memory whose contents are in a file without a name: arrays larger than the machine's memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace soapfilm {

/// Whether this platform can hold arrays in files.
bool has_scratch_files();

/// Bytes that this user can still write into files of the folder; UINT64_MAX if unknown.
uint64_t free_disk_bytes(const std::string& folder);

/// Throws OutputError, which names the folder, unless files can be made in it. Leaves none.
void check_scratch_folder(const std::string& folder);

/// An open file without a name, all of whose `bytes` are reserved: using it cannot fail because the disk is full. When
/// it is closed, and no longer mapped, nothing is left of it. Throws OutputError that names the folder, the bytes
/// needed and those that are free; or says that check_scratch_files() would throw.
int make_scratch_file(const std::string& folder, size_t bytes);
void close_scratch_file(int file);

/// Throws OutputError, once, where the disk did not take what memory had no room for, so that contents of a file of
/// this folder, open or closed since, are lost.
void check_scratch_files(const std::string& folder);

}  // namespace soapfilm
