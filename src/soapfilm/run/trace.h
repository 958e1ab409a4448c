// The output of a run while it goes on: the times of its stages, lines and warnings.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/stages.h"

namespace soapfilm {

class Trace {
 public:
  explicit Trace(const Context& context) : context_(context), stages_(context) {}

  /// Runs work() as the stage of that name. Throws Cancelled, and what work() throws.
  template <class Work>
  auto stage(const char* name, Work&& work) {
    return stages_.run(name, std::forward<Work>(work));
  }

  void info(const std::string& line) const { context_.progress().info(line); }
  /// Printed, and kept for the report.
  void warn(std::string text) {
    context_.progress().warn(text);
    warnings_.push_back(std::move(text));
  }
  void warn(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) warn(text);
  }
  /// Kept for the report: a stage has printed them itself.
  void keep(const std::vector<std::string>& shown) { warnings_.insert(warnings_.end(), shown.begin(), shown.end()); }

  const std::vector<StageTime>& times() const { return stages_.times(); }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const Context& context_;
  Stages stages_;
  std::vector<std::string> warnings_;
};

}  // namespace soapfilm
