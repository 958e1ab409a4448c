// Ctrl-C and a polite request to end.
#pragma once

namespace soapfilm {

/// Calls `handler` when the user interrupts the program or it is asked to end (SIGINT, SIGTERM); null: the system's own
/// way, which ends it. Reads and writes under way go on. Async-signal-safe.
void on_interrupt(void (*handler)(int));

}  // namespace soapfilm
