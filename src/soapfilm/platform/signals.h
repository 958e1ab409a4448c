// Ctrl-C and requests to end.
#pragma once

namespace soapfilm {

/// Calls `handler` when the user interrupts the program or it is asked to end (SIGINT, SIGTERM); null: the system's
/// default, which ends it. Reads and writes in progress continue. Async-signal-safe.
void on_interrupt(void (*handler)(int));

/// Calls `handler` where a page of a mapped file cannot be read or written: its disk fails, or the file was made
/// shorter. It must end the process; only what is async-signal-safe may be done.
void on_lost_page(void (*handler)(int));

}  // namespace soapfilm
