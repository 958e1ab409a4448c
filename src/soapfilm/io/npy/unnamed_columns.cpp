#include "soapfilm/io/npy/unnamed_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace soapfilm::io {

namespace {

constexpr size_t most_judged_rows = 20'000;
constexpr double most_of_rows = 0.95;  // some have no color or no normal, which programs mark by odd numbers

enum class TripleKind { other, normals, unit_colors, byte_colors };

bool is_color(TripleKind kind) { return kind == TripleKind::unit_colors || kind == TripleKind::byte_colors; }

/// What is counted of the rows of three columns.
class TripleJudge {
 public:
  void add(const std::array<double, 3>& v) {
    constexpr double tolerance = 0.01;
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const auto all = [&](auto holds) { return std::all_of(v.begin(), v.end(), holds); };
    const bool is_unit = std::abs(length - 1) < tolerance;
    const bool is_whole = all([](double c) { return c == std::floor(c); });
    ++rows_;
    zeros_ += length == 0;
    units_ += is_unit;
    equal_units_ += is_unit && (units_ == 1 || v == first_unit_);
    if (is_unit && units_ == 1) first_unit_ = v;
    to_one_ += all([](double c) { return c >= 0 && c <= 1; });
    to_255_ += is_whole && all([](double c) { return c >= 0 && c <= 255; });
    directed_ += is_unit && (!is_whole || !all([](double c) { return c >= 0; }));
  }

  /// Ones of whole numbers are flags, or the faces of a box that happen to be colors.
  TripleKind kind(bool integers) const {
    const auto most = [](size_t part, size_t of) {
      return part > 0 && static_cast<double>(part) >= most_of_rows * static_cast<double>(of);
    };
    if (rows_ == zeros_) return TripleKind::other;
    if (most(units_, rows_ - zeros_) && (directed_ > 0 || equal_units_ == units_)) return TripleKind::normals;
    if (most(to_one_, rows_)) return integers ? TripleKind::other : TripleKind::unit_colors;
    return most(to_255_, rows_) ? TripleKind::byte_colors : TripleKind::other;
  }

 private:
  size_t rows_ = 0, zeros_ = 0, units_ = 0, equal_units_ = 0, directed_ = 0, to_one_ = 0, to_255_ = 0;
  std::array<double, 3> first_unit_{};
};

class ColumnsJudge {
 public:
  ColumnsJudge(std::string_view bytes, const std::vector<BinaryField>& fields, size_t rows)
      : bytes_(bytes), fields_(fields), rows_(rows), step_(std::max<size_t>(1, rows / most_judged_rows)) {}

  JudgedColumns judge() {
    judged_.names = {"x", "y", "z"};
    const size_t further = fields_.size() - 3;
    if (further == 1) {
      judged_.names.emplace_back("intensity");
    } else if (further % 3 == 1 && odd_one_is_first(further)) {
      judged_.names.emplace_back("intensity");
      name_triples();
    } else {
      name_triples();
    }
    name_rest();
    return std::move(judged_);
  }

 private:
  TripleKind kind(size_t first) const {
    TripleJudge judge;
    for (size_t row = 0; row < rows_; row += step_) {
      std::array<double, 3> v{};
      for (size_t k = 0; k < 3; ++k) read_field(bytes_, fields_[first + k], row, 1, &v[k]);
      judge.add(v);
    }
    bool integers = true;
    for (size_t k = first; k < first + 3; ++k) integers = integers && is_integer(fields_[k].type);
    return judge.kind(integers);
  }

  bool are_known(size_t first, size_t count) const {
    for (size_t at = first; at < first + count; at += 3)
      if (kind(at) == TripleKind::other) return false;
    return true;
  }

  double largest(size_t column) const {
    double most = 0, value = 0;
    for (size_t row = 0; row < rows_; row += step_) {
      read_field(bytes_, fields_[column], row, 1, &value);
      if (std::isfinite(value)) most = std::max(most, value);
    }
    return most;
  }

  /// x y z intensity r g b, or x y z r g b label? If both fit, the column whose largest number differs more from those
  /// of the columns between is the odd one.
  bool odd_one_is_first(size_t further) {
    constexpr size_t first = 3;
    const size_t last = first + further - 1;
    if (!are_known(first + 1, further - 1)) return false;
    if (!are_known(first, further - 1)) return true;
    const double middle = std::log1p(std::max(largest(first + 1), largest(first + 2)));
    const bool is_first = std::abs(std::log1p(largest(first)) - middle) >= std::abs(std::log1p(largest(last)) - middle);
    judged_.warnings.push_back(
        fmt::format("column {}, not {}, is taken for the one beside colors or normals: fields with names would say it",
                    is_first ? first + 1 : last + 1, is_first ? last + 1 : first + 1));
    return is_first;
  }

  /// From the first column without a name: normals once, colors once.
  void name_triples() {
    bool has_normals = false, has_colors = false;
    while (judged_.names.size() + 3 <= fields_.size()) {
      const TripleKind found = kind(judged_.names.size());
      if (found == TripleKind::normals && !has_normals) {
        has_normals = true;
        judged_.names.insert(judged_.names.end(), {"nx", "ny", "nz"});
      } else if (is_color(found) && !has_colors) {
        has_colors = true;
        judged_.largest_color = found == TripleKind::unit_colors ? 1 : 255;
        judged_.names.insert(judged_.names.end(), {"red", "green", "blue"});
      } else {
        return;
      }
    }
  }

  void name_rest() {
    const size_t known = judged_.names.size();
    for (size_t k = known; k < fields_.size(); ++k) judged_.names.push_back(fmt::format("column {}", k + 1));
    if (known == fields_.size()) return;
    judged_.warnings.push_back(fmt::format(
        "{} have no names and are neither normals nor colors: carried as further values",
        known + 1 == fields_.size() ? fmt::format("numbers in column {}", known + 1)
                                    : fmt::format("numbers in columns {} to {}", known + 1, fields_.size())));
  }

  std::string_view bytes_;
  const std::vector<BinaryField>& fields_;
  size_t rows_;
  size_t step_;
  JudgedColumns judged_;
};

}  // namespace

JudgedColumns judge_columns(std::string_view bytes, const std::vector<BinaryField>& fields, size_t rows) {
  return ColumnsJudge(bytes, fields, rows).judge();
}

}  // namespace soapfilm::io
