// Files that have no name until they are complete: nothing is left of them if the process is killed before.
#pragma once

#include <string>

namespace soapfilm {

/// Opens a file without a name in this folder, for reading and writing; `mode` is that of open(2). Returns -1 with
/// errno, EOPNOTSUPP where the file system or the platform has no such files.
int open_unnamed_file(const std::string& folder, unsigned mode);

/// Another name of such a file, while it is open, for other processes of the same user on this machine; empty where
/// there is none.
std::string name_for_others(int file);

/// Gives it a name in its folder. Where the name exists, it has at every moment the old contents or all of the new.
/// Returns 0 or an error number. Contents that must survive a power failure are to be stored before.
int name_file(int file, const std::string& name);

/// Waits until the contents of an open file are on its disk. Returns 0 or an error number: the system takes bytes
/// before it writes them, and only says here that it could not.
int store_file(int file);

/// A file that is written by its path() and gets its name once it is complete; without complete() nothing is left.
class NewFile {
 public:
  explicit NewFile(std::string name);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::string& path() const { return path_; }
  /// Stores it and gives it its name, such that after a power failure the name has all of the contents or what it had.
  /// Returns whether it could.
  bool complete();

 private:
  std::string name_, path_;
  int file_ = -1;  ///< without a name; -1: path_ is another name
};

}  // namespace soapfilm
