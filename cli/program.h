// The program: global options, sub-commands, and the one place where errors become messages and exit codes.
#pragma once

namespace soapfilm::cli {

/// What main() does; returns the exit code.
int program(int argc, char** argv);

}  // namespace soapfilm::cli
