// A file that ranks (core/ranks.h) write together. Rank 0 has its bytes in order and sends them away in blocks; each
// rank writes those that it gets at their places in the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/core/ranks.h"

namespace soapfilm::io {

/// Rank 0's side of one file, while the other ranks are in write_blocks(). A rank that cannot open the file by its path
/// takes no part, such as one on another machine that does not share the folder. A file with fewer blocks than there
/// may be writers, at most 16, is written by rank 0 alone. If finish() is not called the run must end: the others wait
/// for it.
class RankBlocks {
 public:
  static constexpr size_t block_bytes = size_t{1} << 20;

  /// `file` is open and empty. `path`: by which others can open it; `has_name`: it is a name in its folder, such as
  /// every file has on a network's file system.
  RankBlocks(Ranks& ranks, int file, std::string path, bool has_name);

  /// The next bytes. Returns 0 or an error number.
  int append(std::string_view bytes);
  /// Waits until all is written, and stored by all ranks. Returns 0 or an error number, of any of them.
  int finish();

  /// How many ranks write it; 0 while that is not known.
  size_t writers() const { return writers_.size(); }

 private:
  std::string_view block(size_t k) const;
  int find_writers();
  int write_round();
  int write_own(std::string_view bytes);

  Ranks& ranks_;
  int file_;
  std::string path_;
  bool has_name_;
  std::vector<int> writers_;                     // rank 0 first; empty: not known yet
  std::vector<int> have_file_;                   // ranks that have opened it
  std::vector<std::unique_ptr<char[]>> blocks_;  // of a round: as many as there may be writers, made when needed
  size_t used_ = 0;                              // bytes in them
  uint64_t written_ = 0;                         // bytes of the file before those
};

/// The other ranks: write what rank 0 sends, until end_blocks(). Throws Cancelled.
void write_blocks(Ranks& ranks);
/// Rank 0, before it makes a file with a name that is to go if the run fails: it may be killed, and then the others
/// remove the file.
void tell_temporary(Ranks& ranks, const std::string& path);
/// Rank 0, when all files are complete.
void end_blocks(Ranks& ranks);

}  // namespace soapfilm::io
