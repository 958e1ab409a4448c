// Cancelling in long loops of one thread; those of parallel.h look by themselves.
#pragma once

#include <cstddef>

#include "soapfilm/context.h"

namespace soapfilm {

/// To be called in each turn of a loop: throws Cancelled, at the latest some thousand turns after a run is cancelled.
class Checks {
 public:
  explicit Checks(const Context& context) : context_(context) {}
  void operator()() {
    constexpr size_t turns_between = size_t{1} << 14;
    if (++turns_ % turns_between == 0) context_.check();
  }

 private:
  const Context& context_;
  size_t turns_ = 0;
};

}  // namespace soapfilm
