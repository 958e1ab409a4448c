#include "soapfilm/io/bytes/atomic_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/platform/new_file.h"

namespace soapfilm::io {

AtomicFile::AtomicFile(const std::string& path, Ranks* ranks)
    : path_(path), target_(resolve_links(path)), buffer_(new char[capacity]) {
  struct stat status {};
  const bool exists = ::stat(target_.c_str(), &status) == 0;
  if (!exists && errno != ENOENT) fail(errno);
  if (exists && S_ISDIR(status.st_mode)) throw OutputError(path + ": is a directory, must be a file");
  is_direct_ = exists && !S_ISREG(status.st_mode);
  if (is_direct_) {
    file_.reset(::open(target_.c_str(), O_WRONLY | O_CLOEXEC));
  } else {
    if (exists && ::access(target_.c_str(), W_OK) != 0) fail(errno);
    file_.reset(open_unnamed_file(std::filesystem::path(target_).parent_path().string(), 0666));
    if (!file_.is_open() && errno == EOPNOTSUPP) open_temporary(ranks);
  }
  if (!file_.is_open()) fail(errno);
  if (ranks && !is_direct_) share(*ranks);
}

AtomicFile::~AtomicFile() {
  file_.close();
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  forget_temporary(slot_);
}

std::string AtomicFile::temporary_name(int attempt) const {
  const std::filesystem::path target(target_);
  const std::string name = fmt::format(".{}.{}-{}.tmp", target.filename().string(), ::getpid(), attempt);
  return (target.parent_path() / name).string();
}

void AtomicFile::open_temporary(Ranks* ranks) {
  constexpr int attempts = 1000;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const std::string name = temporary_name(attempt);
    if (::access(name.c_str(), F_OK) == 0) continue;
    if (ranks) tell_temporary(*ranks, std::filesystem::absolute(name).string());
    file_.reset(::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (!file_.is_open() && errno == EEXIST) continue;
    if (!file_.is_open()) return;
    temporary_ = name;
    slot_ = remember_temporary(name);
    return;
  }
  errno = EEXIST;
}

void AtomicFile::share(Ranks& ranks) {
  const bool has_name = !temporary_.empty();
  std::string path = has_name ? std::filesystem::absolute(temporary_).string() : name_for_others(file_.get());
  if (!path.empty()) blocks_ = std::make_unique<RankBlocks>(ranks, file_.get(), std::move(path), has_name);
}

void AtomicFile::finish() {
  flush();
  buffer_.reset();
  if (is_direct_) return;
  if (const int error = blocks_ ? blocks_->finish() : store_file(file_.get())) fail(error);
  blocks_.reset();
}

void AtomicFile::close_until_commit() {
  if (temporary_.empty() && !is_direct_) {
    const std::string name = temporary_name(0);
    if (const int error = name_file(file_.get(), name)) fail(error);
    temporary_ = name;
    slot_ = remember_temporary(name);
  }
  if (file_.close() != 0) fail(errno);
}

void AtomicFile::commit() {
  if (buffer_) finish();
  if (temporary_.empty() && !is_direct_)
    if (const int error = name_file(file_.get(), target_)) fail(error);
  if (file_.close() != 0) fail(errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void AtomicFile::flush() {
  const size_t used = used_;
  used_ = 0;
  write_out({buffer_.get(), used});
}

void AtomicFile::write_out(std::string_view bytes) {
  if (const int error = blocks_ ? blocks_->append(bytes) : write_all(file_.get(), bytes)) fail(error);
}

void AtomicFile::fail(int error) const { throw OutputError(path_ + ": cannot be written: " + error_text(error)); }

}  // namespace soapfilm::io

namespace soapfilm {

void write_text_file(const std::string& path, const std::string& text) {
  io::AtomicFile file(path);
  file.append(text);
  file.commit();
}

void check_output(const std::string& path) {
  // Who reads from a pipe would take the end of this look for the end of the file.
  struct stat status {};
  const bool is_pipe = ::stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
  if (is_pipe && ::access(path.c_str(), W_OK) == 0) return;
  const io::AtomicFile file(path);
}

}  // namespace soapfilm
