// Ctrl-C and requests to end.
#pragma once

namespace soapfilm {

/// Calls `handler` when the user interrupts the program or it is asked to end (SIGINT, SIGTERM); null: the system's
/// default, which ends it. Reads and writes in progress continue. Async-signal-safe.
void on_interrupt(void (*handler)(int));

}  // namespace soapfilm
