#include "soapfilm/platform/signals.h"

#include <signal.h>

#include <initializer_list>

namespace soapfilm {

void on_interrupt(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler ? handler : SIG_DFL;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

void on_lost_page(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  sigaction(SIGBUS, &action, nullptr);
}

}  // namespace soapfilm
