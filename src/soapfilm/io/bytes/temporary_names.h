// The temporary files in use, for remove_temporary_files(), which a signal may call.
#pragma once

#include <string>

namespace soapfilm::io {

struct TemporaryName;

/// Null when the name is too long; then a signal leaves the file behind.
TemporaryName* remember_temporary(const std::string& path);
/// Of null: nothing.
void forget_temporary(TemporaryName* name) noexcept;

/// `path` with symbolic links resolved, if there is such a file.
std::string resolve_links(const std::string& path);

}  // namespace soapfilm::io
