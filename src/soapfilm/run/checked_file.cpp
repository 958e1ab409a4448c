#include "soapfilm/run/checked_file.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace soapfilm {

namespace {

constexpr size_t block_bytes = size_t{1} << 20;

}  // namespace

CheckedFile::CheckedFile(const std::string& path)
    : file_(path, std::ios::binary), block_(block_bytes), stream_(static_cast<std::streambuf*>(this)) {
  setp(block_.data(), block_.data() + block_.size());
}

std::streambuf::int_type CheckedFile::overflow(int_type next) {
  pass_block();
  if (!file_) return traits_type::eof();
  if (!traits_type::eq_int_type(next, traits_type::eof())) sputc(traits_type::to_char_type(next));
  return traits_type::not_eof(next);
}

void CheckedFile::pass_block() {
  const std::string_view block(pbase(), static_cast<size_t>(pptr() - pbase()));
  if (block.empty()) return;
  hash_.add(block);
  file_.write(block.data(), static_cast<std::streamsize>(block.size()));
  setp(block_.data(), block_.data() + block_.size());
}

bool CheckedFile::close() {
  pass_block();
  const uint64_t number = hash_.value();
  file_.write(reinterpret_cast<const char*>(&number), sizeof number);
  file_.close();
  return stream_ && file_;
}

bool is_whole(const std::string& path, const Context& context) {
  std::error_code error;
  const uintmax_t bytes = std::filesystem::file_size(path, error);
  uint64_t number = 0;
  if (error || bytes < sizeof number) return false;
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(block_bytes);
  Hash hash;
  for (uintmax_t left = bytes - sizeof number; left > 0;) {
    context.check();
    const auto size = static_cast<size_t>(std::min<uintmax_t>(left, block_bytes));
    if (!file.read(block.data(), static_cast<std::streamsize>(size))) return false;
    hash.add(std::string_view(block.data(), size));
    left -= size;
  }
  return file.read(reinterpret_cast<char*>(&number), sizeof number) && number == hash.value();
}

}  // namespace soapfilm
