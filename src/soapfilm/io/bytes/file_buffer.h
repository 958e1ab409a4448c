// What other libraries write to a C++ stream, into an atomic file.
#pragma once

#include <streambuf>
#include <string>

#include "soapfilm/io/bytes/atomic_file.h"

namespace soapfilm::io {

class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(AtomicFile& file) : file_(file) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    file_.append({bytes, static_cast<size_t>(count)});
    return count;
  }
  int overflow(int c) override {
    if (c != traits_type::eof()) file_.append(std::string(1, static_cast<char>(c)));
    return c;
  }

 private:
  AtomicFile& file_;
};

}  // namespace soapfilm::io
