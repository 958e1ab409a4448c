#include "soapfilm/io/bytes/staged_files.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/file_descriptor.h"

namespace soapfilm::io {

StagedFiles::~StagedFiles() { remove_all(); }

std::string StagedFiles::add(const std::string& target) {
  Staged file;
  file.target = resolve_links(target);
  struct stat status {};
  if (::stat(file.target.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode)) throw OutputError(target + ": exists and is no file, must be a file");
    if (::access(file.target.c_str(), W_OK) != 0)
      throw OutputError(target + ": cannot be written: " + error_text(errno));
  }
  const std::filesystem::path path(file.target);
  file.temporary = (path.parent_path() / fmt::format(".{}-{}", ::getpid(), path.filename().string())).string();
  file.slot = remember_temporary(file.temporary);
  files_.push_back(std::move(file));
  return files_.back().temporary;
}

void StagedFiles::commit() {
  if (!files_.empty()) ::unlink(files_.back().target.c_str());
  for (const Staged& file : files_) {
    if (std::rename(file.temporary.c_str(), file.target.c_str()) != 0) {
      const OutputError error(file.target + ": cannot be written: " + error_text(errno));
      remove_all();
      throw error;
    }
    ++renamed_;
  }
  for (const Staged& file : files_) forget_temporary(file.slot);
  files_.clear();
}

void StagedFiles::remove_all() noexcept {
  for (size_t i = 0; i < files_.size(); ++i) {
    ::unlink((i < renamed_ ? files_[i].target : files_[i].temporary).c_str());
    forget_temporary(files_[i].slot);
  }
  files_.clear();
  renamed_ = 0;
}

}  // namespace soapfilm::io
