// Sanitized code runs about 20 times slower: there a property is tested on fewer or smaller instances.
#pragma once

namespace soapfilm::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace soapfilm::test
