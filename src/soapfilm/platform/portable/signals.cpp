#include "soapfilm/platform/signals.h"

#include <csignal>
#include <initializer_list>

namespace soapfilm {

void on_interrupt(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, handler ? handler : SIG_DFL);
}

void on_lost_page(void (*)(int)) {}

}  // namespace soapfilm
