// The few kinds of Python literals that the head of a NumPy file has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace soapfilm::io {

/// Reads a literal token by token. All functions skip blanks before a token, and throw InputError where the text is
/// something else.
class PythonLiteral {
 public:
  /// `offset`: where `text` begins in the file, for messages.
  PythonLiteral(std::string_view text, size_t offset, const std::string& path)
      : text_(text), offset_(offset), path_(path) {}

  /// The next character that is no blank; '\0' at the end.
  char peek();
  /// Passes over this character if it comes next.
  bool accept(char c);
  void expect(char c);
  std::string string();
  bool boolean();
  uint64_t number();
  void expect_end();

  /// Throws InputError.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view text_;
  size_t at_ = 0;
  size_t offset_;
  const std::string& path_;
};

}  // namespace soapfilm::io
