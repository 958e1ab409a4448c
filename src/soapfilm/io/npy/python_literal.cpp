#include "soapfilm/io/npy/python_literal.h"

#include <fmt/format.h>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

char PythonLiteral::peek() {
  while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  return at_ < text_.size() ? text_[at_] : '\0';
}

bool PythonLiteral::accept(char c) {
  const bool here = peek() == c && at_ < text_.size();
  if (here) ++at_;
  return here;
}

void PythonLiteral::expect(char c) {
  if (!accept(c)) fail(fmt::format("must have '{}' here", c));
}

std::string PythonLiteral::string() {
  const char quote = peek();
  if (quote != '\'' && quote != '"') fail("must have a string here");
  std::string value;
  for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
    if (text_[at_] == '\\' && ++at_ == text_.size()) break;
    value += text_[at_];
  }
  if (at_ >= text_.size()) fail("a string without an end");
  ++at_;
  return value;
}

bool PythonLiteral::boolean() {
  peek();
  for (const bool value : {true, false}) {
    const std::string_view word = value ? "True" : "False";
    if (text_.substr(at_, word.size()) != word) continue;
    at_ += word.size();
    return value;
  }
  fail("must have True or False here");
}

uint64_t PythonLiteral::number() {
  constexpr uint64_t most = UINT64_MAX / 10 - 1;
  peek();
  const size_t begin = at_;
  uint64_t value = 0;
  for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
    if (value > most) fail("a number that is too large");
    value = 10 * value + static_cast<uint64_t>(text_[at_] - '0');
  }
  if (at_ == begin) fail("must have a whole number >= 0 here");
  if (at_ < text_.size() && text_[at_] == 'L') ++at_;  // as Python 2 wrote it
  return value;
}

void PythonLiteral::expect_end() {
  if (peek() != '\0' || at_ < text_.size()) fail("must end here");
}

void PythonLiteral::fail(const std::string& message) const {
  throw InputError(fmt::format("{}: byte {}: head of the array: {}, {}", path_, offset_ + at_,
                               in_quotes(text_.substr(at_, 20)), message));
}

}  // namespace soapfilm::io
