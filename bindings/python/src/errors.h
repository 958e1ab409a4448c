// The library's exceptions as those of soapfilm/errors.py.
#pragma once

namespace soapfilm::python {

void translate_errors();

}  // namespace soapfilm::python
