// The built program, run as a user runs it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "support/process.h"

namespace soapfilm::test {

inline ProcessResult run(std::vector<std::string> arguments, const std::function<void(pid_t)>& meanwhile = {}) {
  arguments.insert(arguments.begin(), SOAPFILM_PROGRAM);
  return run_process(arguments, meanwhile);
}

/// The same with `folder` as the current one.
inline ProcessResult run_in(const std::string& folder, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(),
                   {"/bin/sh", "-c", "cd \"$1\" && shift && exec \"$0\" \"$@\"", SOAPFILM_PROGRAM, folder});
  return run_process(arguments);
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Exit code 2, nothing on standard output, and one line "soapfilm: ..." that names `what`.
inline void expect_refused(const std::vector<std::string>& arguments, const std::string& what) {
  const ProcessResult result = run(arguments);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.err.rfind("soapfilm: ", 0), 0u) << result.err;
  EXPECT_TRUE(contains(result.err, what)) << "expected '" << what << "' in: " << result.err;
}

}  // namespace soapfilm::test
