#include "soapfilm/io/sets/file_pattern.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The digits from `at` on without leading zeros; `at` moves behind them.
std::string number_at(const std::string& text, size_t& at) {
  size_t begin = at, end = at;
  while (end < text.size() && is_digit(text[end])) ++end;
  while (begin + 1 < end && text[begin] == '0') ++begin;
  at = end;
  return text.substr(begin, end - begin);
}

/// The character of UTF-8 that `text` begins with, as a number that orders it; it is taken off. A byte that begins none
/// is a character.
uint32_t take_character(std::string_view& text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  size_t length = 1;
  uint32_t character = byte(0);
  for (const size_t most = character < 0xC0 ? 1 : 4; length < std::min(most, text.size()) && (byte(length) >> 6) == 2;)
    character = character << 8 | byte(length++);
  text.remove_prefix(length);
  return character;
}

/// Whether `set`, what stands between brackets, has the character.
bool has(std::string_view set, uint32_t character) {
  const bool others = set.front() == '!' || set.front() == '^';
  if (others) set.remove_prefix(1);
  bool found = false;
  while (!set.empty()) {
    const uint32_t first = take_character(set);
    uint32_t last = first;
    if (set.size() > 1 && set.front() == '-') {
      set.remove_prefix(1);
      last = take_character(set);
    }
    found = found || (first <= character && character <= last);
  }
  return found != others;
}

/// What stands between the bracket that `pattern` begins with and the one that closes it; empty if none does.
std::string_view set_at(std::string_view pattern) {
  const size_t first = pattern.size() > 1 && (pattern[1] == '!' || pattern[1] == '^') ? 2 : 1;
  const size_t end = pattern.find(']', first + 1);  // a bracket that comes first is one of the set
  return end == std::string_view::npos ? std::string_view() : pattern.substr(1, end - 1);
}

/// Takes one character off both, if they agree on it.
bool take_one(std::string_view& name, std::string_view& pattern) {
  if (name.empty() || pattern.empty()) return false;
  std::string_view rest = pattern;
  const char kind = pattern.front();
  const std::string_view set = kind == '[' ? set_at(pattern) : std::string_view();
  const uint32_t wanted = set.empty() ? take_character(rest) : 0, found = take_character(name);
  if (!set.empty()) rest.remove_prefix(set.size() + 2);
  if (set.empty() ? kind != '?' && found != wanted : !has(set, found)) return false;
  pattern = rest;
  return true;
}

bool has_wildcard(std::string_view text) { return text.find_first_of("*?[") != std::string_view::npos; }

bool exists(const std::string& path) {
  std::error_code unknown;
  return fs::exists(fs::symlink_status(path, unknown));
}

/// Adds the names in `folder`, which ends in a slash or is empty, that match.
void add_matches(const std::string& folder, const std::string& part, std::vector<std::string>& paths) {
  const std::string opened = folder.empty() ? "." : folder;
  std::error_code error;
  if (!fs::is_directory(opened, error)) return;
  for (fs::directory_iterator at(opened, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (matches(name, part)) paths.push_back(folder + name);
  }
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", opened, error.message()));
}

}  // namespace

bool comes_before(const std::string& a, const std::string& b) {
  for (size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string x = number_at(a, i), y = number_at(b, k);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else if (a[i] != b[k]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[k]);
    } else {
      ++i, ++k;
    }
  }
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

bool matches(std::string_view name, std::string_view pattern) {
  if (name.starts_with('.') && !pattern.starts_with('.')) return false;
  // Where the last * stands, and what is left of the name behind what it has met so far.
  std::string_view star, behind;
  bool starred = false;
  while (!name.empty()) {
    if (pattern.starts_with('*')) {
      pattern.remove_prefix(1);
      star = pattern, behind = name, starred = true;
    } else if (!take_one(name, pattern)) {
      if (!starred) return false;
      take_character(behind);
      name = behind, pattern = star;
    }
  }
  return pattern.find_first_not_of('*') == std::string_view::npos;
}

bool is_pattern(const std::string& path) { return has_wildcard(path) && !exists(path); }

std::vector<std::string> paths_of_pattern(const std::string& pattern) {
  std::vector<std::string> found{""};
  for (size_t begin = 0; begin < pattern.size() && !found.empty();) {
    const size_t end = std::min(pattern.find('/', begin), pattern.size());
    const size_t next = std::min(pattern.find_first_not_of('/', end), pattern.size());
    const std::string part = pattern.substr(begin, end - begin), slashes = pattern.substr(end, next - end);
    std::vector<std::string> longer;
    for (const std::string& folder : found) {
      const size_t before = longer.size();
      if (part.empty() || exists(folder + part))
        longer.push_back(folder + part);
      else if (has_wildcard(part))
        add_matches(folder, part, longer);
      for (size_t i = before; i < longer.size(); ++i) longer[i] += slashes;
    }
    found = std::move(longer);
    begin = next;
  }
  const auto gone = [](const std::string& path) { return !exists(path); };  // a file before a slash
  found.erase(std::remove_if(found.begin(), found.end(), gone), found.end());
  std::sort(found.begin(), found.end(), comes_before);
  return found;
}

}  // namespace soapfilm::io
