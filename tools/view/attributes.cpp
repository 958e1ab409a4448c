#include "tools/view/attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "tools/view/page.h"

namespace soapfilm::view_detail {

namespace {

using nlohmann::ordered_json;

constexpr size_t most_labels = 256;

/// The different values, if they can be labels: few, and whole numbers.
std::set<float> codes_of(const std::vector<float>& finite) {
  std::set<float> codes;
  for (const float value : finite) {
    if (value != std::floor(value) || value < 0) return {};
    codes.insert(value);
    if (codes.size() > most_labels) return {};
  }
  return codes;
}

std::optional<ShownAttribute> shown(const std::string& name, std::vector<float> values, bool is_label) {
  std::vector<float> finite;
  for (float& value : values) {
    if (std::isfinite(value))
      finite.push_back(value);
    else
      value = std::numeric_limits<float>::quiet_NaN();
  }
  if (finite.empty()) return std::nullopt;
  const auto [lo, hi] = std::minmax_element(finite.begin(), finite.end());
  ordered_json facts = {{"name", clean_text(name)}, {"lo", *lo}, {"hi", *hi}};
  const std::set<float> codes = is_label ? codes_of(finite) : std::set<float>{};
  if (!codes.empty()) {
    facts["codes"] = codes;
    facts["labels"] = codes;
  }
  const auto at_share = [&](double share) {
    const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(finite.size() - 1));
    std::nth_element(finite.begin(), finite.begin() + place, finite.end());
    return finite[static_cast<size_t>(place)];
  };
  facts["low"] = at_share(0.02);
  facts["high"] = at_share(0.98);
  facts["length"] = name == "distance";
  return ShownAttribute{std::move(facts), std::move(values)};
}

void add(std::vector<ShownAttribute>& to, std::optional<ShownAttribute> attribute) {
  if (attribute) to.push_back(std::move(*attribute));
}

void add_columns(std::vector<ShownAttribute>& to, const std::vector<Column>& columns) {
  for (const Column& column : columns) add(to, shown(column.name, column.values, column.is_label));
}

bool has(const std::vector<ShownAttribute>& attributes, const char* name) {
  return std::any_of(attributes.begin(), attributes.end(),
                     [&](const ShownAttribute& attribute) { return attribute.facts["name"] == name; });
}

}  // namespace

std::vector<ShownAttribute> shown_attributes(const Mesh& mesh) {
  std::vector<ShownAttribute> attributes;
  add_columns(attributes, mesh.attributes);
  return attributes;
}

std::vector<ShownAttribute> shown_attributes(const PointCloud& cloud) {
  std::vector<ShownAttribute> attributes;
  add_columns(attributes, cloud.columns);
  if (!cloud.weights.empty() && !has(attributes, "weight")) add(attributes, shown("weight", cloud.weights, false));
  if (cloud.scans.size() > 1 && !has(attributes, "scan")) {
    std::vector<float> scan(cloud.size());
    ordered_json names = ordered_json::array();
    for (size_t s = 0; s < cloud.scans.size(); ++s) {
      std::fill(scan.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].begin),
                scan.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].end), static_cast<float>(s));
      const std::string& name = cloud.scans[s].name;
      names.push_back(name.empty() ? std::to_string(s + 1) : clean_text(name));
    }
    std::optional<ShownAttribute> attribute = shown("scan", std::move(scan), true);
    if (attribute && attribute->facts["codes"].size() == names.size()) attribute->facts["labels"] = names;
    add(attributes, std::move(attribute));
  }
  return attributes;
}

}  // namespace soapfilm::view_detail
