// A comparison as text and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/compare/compare.h"

namespace soapfilm {

struct CompareSubject {
  std::string part, model;
  bool is_scan = false;
  std::string unit;  ///< of lengths, such as "mm"; only shown; empty: not known
  CompareOptions options;
};

/// A table, a histogram of bars, the verdict.
std::string compare_table(const CompareSubject& subject, const Comparison& comparison);
nlohmann::ordered_json compare_json(const CompareSubject& subject, const Comparison& comparison);

}  // namespace soapfilm
