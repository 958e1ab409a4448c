#include "cli/coordinate_system.h"

#include <algorithm>
#include <vector>

namespace soapfilm::cli {

namespace {

/// KEYWORD["name", ...]
struct Node {
  std::string_view keyword;
  std::string name;  ///< its first text in quotes
};

bool is_any(std::string_view keyword, std::initializer_list<std::string_view> keywords) {
  return std::find(keywords.begin(), keywords.end(), keyword) != keywords.end();
}

/// x and y are those of the first of these that is met.
bool has_axes(std::string_view keyword) {
  return is_any(keyword, {"PROJCS", "PROJCRS", "PROJECTEDCRS", "GEOGCS", "GEOGCRS", "GEODCRS", "GEOCCS", "LOCAL_CS",
                          "ENGCRS", "ENGINEERINGCRS"});
}

class Reader {
 public:
  CoordinateSystem read(std::string_view text) {
    for (size_t i = 0; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '"') {
        const size_t end = std::min(text.find('"', i + 1), text.size());
        name(text.substr(i + 1, end - i - 1));
        i = end;
      } else if (c == '[' || c == '(') {
        open_.push_back({word_, {}});
        word_ = {};
      } else if (c == ']' || c == ')') {
        close();
      } else if (c == ',' || c == ' ' || c == '\n' || c == '\r' || c == '\t') {
        word_ = {};
      } else {
        word_ = word_.empty() ? text.substr(i, 1) : std::string_view(word_.data(), word_.size() + 1);
      }
    }
    return found_;
  }

 private:
  void name(std::string_view quoted) {
    if (open_.empty() || !open_.back().name.empty()) return;
    open_.back().name = quoted;
    if (found_.name.empty()) found_.name = quoted;
  }

  void close() {
    if (open_.empty()) return;
    const Node node = open_.back();
    open_.pop_back();
    const bool is_unit = is_any(node.keyword, {"UNIT", "LENGTHUNIT", "ANGLEUNIT"});
    if (is_unit && !done_ && !open_.empty() && (has_axes(open_.back().keyword) || open_.back().keyword == "AXIS"))
      found_.unit = node.name;
    // The system that the axes belong to: a geographic one may stand within a projected one, a vertical one behind it.
    const auto outer = [](const Node& n) { return has_axes(n.keyword); };
    if (has_axes(node.keyword) && std::none_of(open_.begin(), open_.end(), outer)) done_ = true;
  }

  CoordinateSystem found_;
  std::vector<Node> open_;
  std::string_view word_;
  bool done_ = false;
};

}  // namespace

CoordinateSystem coordinate_system_of(std::string_view text) {
  CoordinateSystem found = Reader().read(text);
  if (found.name.empty()) found.name = text;
  return found;
}

}  // namespace soapfilm::cli
