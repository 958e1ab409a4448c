// Files that know whether they are whole.
#pragma once

#include <fstream>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/hash.h"

namespace soapfilm {

/// A stream into a file, whose last eight bytes follow from all bytes that went into the stream: what was lost on the
/// way, or later, is found by is_whole().
class CheckedFile : private std::streambuf {
 public:
  explicit CheckedFile(const std::string& path);

  std::ostream& stream() { return stream_; }
  /// Call when all is written. Returns whether it could be.
  bool close();

 private:
  int_type overflow(int_type next) override;
  void pass_block();

  std::ofstream file_;
  std::vector<char> block_;
  Hash hash_;
  std::ostream stream_;
};

/// Reads all of it. Throws Cancelled.
bool is_whole(const std::string& path, const Context& context);

}  // namespace soapfilm
