// Sanitized code runs about 20 times slower: there a property is tested on fewer or smaller instances.
#pragma once

namespace soapfilm::test {

#if defined(SOAPFILM_SANITIZED)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace soapfilm::test
