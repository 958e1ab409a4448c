#include "soapfilm/io/ply/ply_scans.h"

#include <fmt/format.h>

#include <filesystem>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

std::optional<Vec3d> parse_vector(std::string_view text) {
  Vec3d v;
  std::string_view field;
  for (int axis = 0; axis < 3; ++axis)
    if (!next_field(text, field) || !parse_number(field, v[axis])) return std::nullopt;
  if (next_field(text, field) || !is_finite(v)) return std::nullopt;
  return v;
}

/// 0 when it is not a valid size of a range grid.
int64_t parse_size(std::string_view text) {
  std::string_view field;
  int64_t size = 0;
  const bool valid = next_field(text, field) && parse_integer(field, size) && size > 0 && size <= INT32_MAX;
  return valid ? size : 0;
}

std::string trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

uint64_t parse_samples(const PlyNote& note, std::string_view text, const std::string& path) {
  std::string_view field;
  int64_t count = 0;
  if (!next_field(text, field) || !parse_integer(field, count) || count <= 0)
    throw InputError(
        fmt::format("{}:{}: scan_samples = {}, must be an integer > 0", path, note.line, in_quotes(field)));
  return static_cast<uint64_t>(count);
}

void apply_note(std::string_view keyword, std::string_view text, PlyScan& to) {
  if (keyword == "scan_name") {
    to.scan.name = trimmed(text);
  } else if (keyword == "sensor") {
    if (const auto v = parse_vector(text)) to.scan.sensor = v;
  } else if (keyword == "view_direction") {
    if (const auto v = parse_vector(text); v && norm(*v) > 0) to.scan.view_direction = normalized(*v);
  } else if (keyword == "num_cols") {
    to.columns = parse_size(text);
  } else if (keyword == "num_rows") {
    to.rows = parse_size(text);
  }
}

}  // namespace

std::vector<PlyScan> find_scans(const PlyHeader& header, uint64_t samples, const std::string& path) {
  std::vector<PlyScan> scans;
  PlyScan whole;  // the lines before the first scan_samples line
  uint64_t counted = 0;
  for (const PlyNote& note : header.notes) {
    std::string_view text = note.text;
    std::string_view keyword;
    if (!next_field(text, keyword)) continue;
    if (keyword == "scan_samples") {
      const uint64_t count = parse_samples(note, text, path);
      if (count > samples - counted)
        throw InputError(fmt::format("{}:{}: scan_samples = {}, must be at most {}: the file has {} samples", path,
                                     note.line, count, samples - counted, samples));
      scans.emplace_back();
      scans.back().scan.begin = counted;
      scans.back().scan.end = counted += count;
    } else {
      apply_note(keyword, text, scans.empty() ? whole : scans.back());
    }
  }
  if (scans.empty()) {
    whole.scan.end = counted = samples;
    scans.push_back(std::move(whole));
  }
  if (counted != samples)
    throw InputError(
        fmt::format("{}: the scan_samples lines add up to {}, must be the file's {} samples", path, counted, samples));
  for (PlyScan& scan : scans)
    if (scan.scan.name.empty()) scan.scan.name = std::filesystem::path(path).stem().string();
  return scans;
}

}  // namespace soapfilm::io
