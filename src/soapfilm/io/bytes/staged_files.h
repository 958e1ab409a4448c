// Several output files that appear together, or not at all.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "soapfilm/io/bytes/atomic_file.h"

namespace soapfilm::io {

/// Files are written without their names; commit() gives them, in order. The last one tells what the others are: an old
/// one goes before they are replaced. Of what is not committed nothing is left.
class StagedFiles {
 public:
  /// `ranks` write each file together, if there are some, as in AtomicFile.
  explicit StagedFiles(Ranks* ranks = nullptr) : ranks_(ranks) {}
  ~StagedFiles();
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;

  /// Adds `target`: write(file) gives its contents. Throws OutputError, also for a target that exists and is no file.
  void write(const std::string& target, const std::function<void(AtomicFile&)>& write);
  /// Throws OutputError; then none of the new files is left.
  void commit();

 private:
  void remove_committed() noexcept;

  Ranks* ranks_;
  std::vector<std::unique_ptr<AtomicFile>> files_;
  size_t committed_ = 0;
};

}  // namespace soapfilm::io
