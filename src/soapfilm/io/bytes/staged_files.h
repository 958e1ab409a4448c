// Several output files that appear together, or not at all.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/io/bytes/temporary_names.h"

namespace soapfilm::io {

/// Files are written under temporary names in their folders; commit() renames them, in order. The last one tells what
/// the others are: an old one goes before they are replaced. The destructor removes what is not committed.
class StagedFiles {
 public:
  StagedFiles() = default;
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  /// Where to write the next file, which is to be `target`; it ends as `target` does. Throws OutputError for a target
  /// that exists and is no file, or must not be written.
  std::string add(const std::string& target);
  /// Throws OutputError; then none of the new files is left.
  void commit();

 private:
  struct Staged {
    std::string target, temporary;
    TemporaryName* slot = nullptr;
  };
  void remove_all() noexcept;

  std::vector<Staged> files_;
  size_t renamed_ = 0;
};

}  // namespace soapfilm::io
