// --scratch: large arrays in files, where memory has no room for them.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/context.h"

namespace soapfilm::cli {

/// Runs of the context may use the folder; once one does, the program's large vectors are there, too. Throws
/// OutputError unless files can be made in it.
void use_scratch(const std::string& folder, Context& context);

/// Before these files are read: where their samples would take a good part of the memory, they go to the folder at
/// once.
void make_room_for(const std::vector<std::string>& files, const Context& context);

}  // namespace soapfilm::cli
