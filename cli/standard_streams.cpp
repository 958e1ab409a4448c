#include "cli/standard_streams.h"

#include <fmt/format.h>
#include <stdlib.h>  // mkdtemp is POSIX's

#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/formats.h"

namespace soapfilm::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* input_name = "standard_input";

/// The folder of this process, gone or not; empty: there was none.
std::string& folder_in_use() {
  static std::string folder;
  return folder;
}

std::string with_dot(const std::string& format) { return format.empty() || format[0] == '.' ? format : "." + format; }

/// All of `from`, in pieces. Returns how many bytes; throws Error where one of the two fails.
template <class Error>
size_t copy(std::FILE* from, std::FILE* to, const char* what) {
  std::array<char, size_t{1} << 16> piece;
  size_t sum = 0;
  for (size_t got; (got = std::fread(piece.data(), 1, piece.size(), from)) > 0; sum += got)
    if (std::fwrite(piece.data(), 1, got, to) != got)
      throw Error(fmt::format("{}: cannot be written: {}", what, std::strerror(errno)));
  if (std::ferror(from)) throw Error(fmt::format("{}: cannot be read: {}", what, std::strerror(errno)));
  return sum;
}

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

StandardStreams::StandardStreams(const std::string& formats, const Context& context) : context_(context) {
  const size_t comma = formats.find(',');
  input_format_ = output_format_ = with_dot(formats.substr(0, comma));
  if (comma == std::string::npos) return;
  output_format_ = with_dot(formats.substr(comma + 1));
}

StandardStreams::~StandardStreams() {
  if (folder_.empty()) return;
  std::error_code ignored;
  fs::remove_all(folder_, ignored);  // messages about it may follow
}

std::string StandardStreams::in_folder(const std::string& name) {
  if (folder_.empty()) {
    std::string made = (fs::path(context_.scratch_folder()) / "soapfilm-XXXXXX").string();
    if (!mkdtemp(made.data())) throw OutputError(fmt::format("{}: cannot be made: {}", made, std::strerror(errno)));
    folder_ = folder_in_use() = made;
  }
  return (fs::path(folder_) / name).string();
}

void StandardStreams::take_input(std::vector<std::string>& inputs) {
  bool taken = false;
  for (std::string& input : inputs) {
    if (input != "-") continue;
    if (std::exchange(taken, true)) throw ParameterError("input '-': standard input can be read once");
    std::string file = in_folder(input_name + input_format_);
    const File to(std::fopen(file.c_str(), "wb"));
    if (!to) throw OutputError(fmt::format("{}: cannot be made: {}", file, std::strerror(errno)));
    const size_t bytes = copy<InputError>(stdin, to.get(), "standard input");
    if (std::fflush(to.get()) != 0)
      throw OutputError(fmt::format("{}: cannot be written: {}", file, std::strerror(errno)));
    if (bytes == 0) throw InputError("standard input: 0 bytes, must hold samples");
    if (input_format_.empty() && !io::format_of(io::ByteSource(file))) {
      const std::string text = file + ".xyz";
      fs::rename(file, text);
      file = text;
    }
    input = file;
  }
}

void StandardStreams::take_output(std::string& output) {
  if (output != "-") return;
  output = output_ = in_folder("standard_output" + (output_format_.empty() ? ".ply" : output_format_));
}

void StandardStreams::give_output() const {
  const File from(std::fopen(output_.c_str(), "rb"));
  if (!from) throw OutputError("standard output: its temporary file is gone");
  copy<OutputError>(from.get(), stdout, "standard output");
}

std::string with_known_names(std::string text) {
  const std::string& folder = folder_in_use();
  if (folder.empty()) return text;
  for (size_t at; (at = text.find(folder)) != std::string::npos;) {
    size_t end = at + folder.size() + 1;
    const bool is_input = text.compare(end, std::strlen(input_name), input_name) == 0;
    while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_')) ++end;
    while (end + 1 < text.size() && text[end] == '.' && std::isalnum(static_cast<unsigned char>(text[end + 1])))
      for (++end; end < text.size() && std::isalnum(static_cast<unsigned char>(text[end]));) ++end;
    text.replace(at, end - at, is_input ? "standard input" : "standard output");
  }
  return text;
}

}  // namespace soapfilm::cli
