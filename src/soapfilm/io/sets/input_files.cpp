#include "soapfilm/io/sets/input_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/text/text.h"

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

/// In order of their names, where numbers count as numbers.
bool comes_before(const std::string& a, const std::string& b) {
  for (size_t i = 0, k = 0; i < a.size() && k < b.size();) {
    if (is_digit(a[i]) && is_digit(b[k])) {
      const std::string x = number_at(a, i), y = number_at(b, k);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else if (a[i] != b[k]) {
      return a[i] < b[k];
    } else {
      ++i, ++k;
    }
  }
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

std::vector<std::string> scans_in(const std::string& folder) {
  std::vector<std::string> sets, scans, texts;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (!at->is_regular_file(unknown) || at->path().filename().string().starts_with('.')) continue;
    const std::string path = at->path().string();
    const Format* format = format_of_extension(path);
    if (!format || !format->reads_points() || is_own_mesh(path)) continue;
    (format->names_files() ? sets : format->takes("columns") ? texts : scans).push_back(path);
  }
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder, error.message()));
  if (sets.size() == 1) return sets;
  std::vector<std::string>& found = scans.empty() ? texts : scans;
  if (found.empty())
    throw InputError(fmt::format("{}: a folder without scans, must hold files that end in {}", folder,
                                 extensions_of([](const Format& f) { return f.reads_points(); })));
  std::sort(found.begin(), found.end(), comes_before);
  return std::move(found);
}

}  // namespace

bool is_own_mesh(const std::string& path) {
  const std::string kind = fs::path(path).stem().extension().string();
  std::error_code error;
  return (kind == ".mesh" || kind == ".preview") && lower_case(fs::path(path).extension().string()) == ".ply" &&
         fs::is_regular_file(path, error) && file_kind(path) == FileKind::mesh;
}

std::vector<std::string> input_files(const std::vector<std::string>& given, std::vector<std::string>& warnings) {
  std::vector<std::string> files;
  for (const std::string& path : given) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    for (std::string& scan : scans_in(path)) files.push_back(std::move(scan));
  }
  const auto own = std::stable_partition(files.begin(), files.end(), [](const auto& f) { return !is_own_mesh(f); });
  if (own == files.begin() || own == files.end()) return files;
  for (auto mesh = own; mesh != files.end(); ++mesh)
    warnings.push_back(fmt::format("{}: left out, a mesh made by an earlier run; alone it is read", *mesh));
  files.erase(own, files.end());
  return files;
}

}  // namespace soapfilm::io
