// All output files are written here: complete or not at all.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <string_view>

#include "soapfilm/core/ranks.h"
#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/bytes/file_descriptor.h"
#include "soapfilm/io/bytes/rank_blocks.h"
#include "soapfilm/io/bytes/temporary_names.h"

namespace soapfilm::io {

/// Buffered output to a file in the target's folder that has no name, or where the file system has no such files a
/// temporary one; commit() gives it its own. Of an uncommitted file nothing is left, even if the process is killed
/// while it has no name. A target that exists and is no regular file (a pipe, a terminal) is written to directly.
class AtomicFile {
 public:
  /// `ranks` write it together, if there are some: this is rank 0, the others are in write_blocks(). Throws OutputError
  /// when the folder is missing or not writable, or the target is a directory.
  explicit AtomicFile(const std::string& path, Ranks* ranks = nullptr);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::string& path() const { return path_; }
  /// The same with symbolic links resolved.
  const std::string& target() const { return target_; }
  bool is_direct() const { return is_direct_; }

  void append(std::string_view bytes) {
    if (bytes.size() > capacity - used_) {
      flush();
      if (bytes.size() > capacity) return write_out(bytes);
    }
    std::memcpy(buffer_.get() + used_, bytes.data(), bytes.size());
    used_ += bytes.size();
  }

  /// One value, little-endian.
  template <class T>
  void append_binary(T value) {
    if (sizeof(T) > capacity - used_) flush();
    used_to(put_binary(buffer_.get() + used_, value));
  }

  /// One number as the shortest text that reads back as the same value.
  template <class T>
  void append_text(T value) {
    if (longest_number > capacity - used_) flush();
    used_to(put_text(buffer_.get() + used_, value));
  }

  /// Writes the rest of the buffer, and waits until all of it is on the disk. Nothing can be appended then. Throws
  /// OutputError.
  void finish();
  /// Of a finished file, if many are: it takes a temporary name and is closed. Throws OutputError.
  void close_until_commit();
  /// Finishes the file, if it is not, and gives it its name. Throws OutputError.
  void commit();

 private:
  static constexpr size_t capacity = size_t{1} << 18;
  void used_to(const char* end) { used_ = static_cast<size_t>(end - buffer_.get()); }
  std::string temporary_name(int attempt) const;
  void open_temporary(Ranks* ranks);
  void share(Ranks& ranks);
  void flush();
  void write_out(std::string_view bytes);
  [[noreturn]] void fail(int error) const;

  std::string path_;
  std::string target_;
  bool is_direct_ = false;
  std::string temporary_;          // empty: there is none
  TemporaryName* slot_ = nullptr;  // its place in the table of remove_temporary_files()
  FileDescriptor file_;
  std::unique_ptr<RankBlocks> blocks_;
  std::unique_ptr<char[]> buffer_;
  size_t used_ = 0;
};

}  // namespace soapfilm::io
