#include "cli/suggest.h"

#include <algorithm>
#include <cctype>

namespace soapfilm::cli {

namespace {

/// In lower case, without dashes in front.
std::string plain(std::string_view word) {
  std::string text(word.substr(std::min(word.find_first_not_of('-'), word.size())));
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

size_t edit_distance(std::string_view a, std::string_view b) {
  // Three rows of the table: row[k] is the distance of the first i letters of a from the first k of b.
  std::vector<size_t> before_last, last, row(b.size() + 1);
  for (size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last = std::move(last);
    last = row;
    row[0] = i;
    for (size_t k = 1; k <= b.size(); ++k) {
      row[k] = std::min({last[k] + 1, row[k - 1] + 1, last[k - 1] + (a[i - 1] != b[k - 1])});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        row[k] = std::min(row[k], before_last[k - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearest(std::string_view typed, const std::vector<std::string>& known) {
  constexpr size_t longest = 64;  // no word that is meant is that long; the table grows with it
  const std::string word = plain(typed);
  if (word.empty() || word.size() > longest) return "";
  std::string best, longer;
  size_t edits = std::max<size_t>(1, word.size() / 3) + 1, begin_so = 0;
  for (const std::string& one : known) {
    const std::string candidate = plain(one);
    if (candidate == word) return one;
    if (word.size() > 1 && candidate.starts_with(word) && ++begin_so == 1) longer = one;
    const size_t distance = edit_distance(word, candidate);
    if (distance >= edits || distance >= std::max(word.size(), candidate.size())) continue;
    edits = distance;
    best = one;
  }
  return begin_so == 1 ? longer : best;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known) {
  const std::string meant = nearest(typed, known);
  return meant.empty() ? "" : ", did you mean '" + meant + "'?";
}

}  // namespace soapfilm::cli
