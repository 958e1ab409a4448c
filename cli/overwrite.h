// Refuses outputs that would replace a file that the same run reads or writes.
#pragma once

#include <string>
#include <vector>

namespace soapfilm::cli {

/// Throws OutputError when an output is the file of an input, as scans cannot be measured again, or of another output,
/// whatever path or link names it. Empty names are ignored.
void refuse_overwriting(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

}  // namespace soapfilm::cli
