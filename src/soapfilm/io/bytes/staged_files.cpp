#include "soapfilm/io/bytes/staged_files.h"

#include <unistd.h>

#include <utility>

#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

/// A process may have some thousand open files.
constexpr size_t most_open = 256;

}  // namespace

StagedFiles::~StagedFiles() { remove_committed(); }

void StagedFiles::write(const std::string& target, const std::function<void(AtomicFile&)>& write) {
  auto file = std::make_unique<AtomicFile>(target, ranks_);
  if (file->is_direct()) throw OutputError(target + ": exists and is no file, must be a file");
  write(*file);
  file->finish();
  if (files_.size() >= most_open) file->close_until_commit();
  files_.push_back(std::move(file));
}

void StagedFiles::commit() {
  if (files_.size() > 1) ::unlink(files_.back()->target().c_str());
  try {
    for (; committed_ < files_.size(); ++committed_) files_[committed_]->commit();
  } catch (const OutputError&) {
    remove_committed();
    throw;
  }
  files_.clear();
  committed_ = 0;
}

void StagedFiles::remove_committed() noexcept {
  for (size_t k = 0; k < committed_; ++k) ::unlink(files_[k]->target().c_str());
  committed_ = 0;
}

}  // namespace soapfilm::io
