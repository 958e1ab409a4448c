#include "soapfilm/io/sets/error_message.h"

#include <new>
#include <stdexcept>

#include "soapfilm/error.h"

namespace soapfilm::io {

ErrorMessage message_of(const std::exception_ptr& error, uint64_t file) {
  try {
    std::rethrow_exception(error);
  } catch (const SamplesError& e) {
    return {ErrorKind::samples, file, e.what()};
  } catch (const ParameterError& e) {
    return {ErrorKind::parameter, file, e.what()};
  } catch (const InputError& e) {
    return {ErrorKind::input, file, e.what()};
  } catch (const OutputError& e) {
    return {ErrorKind::output, file, e.what()};
  } catch (const MemoryError& e) {
    return {ErrorKind::memory, file, e.what()};
  } catch (const std::bad_alloc& e) {
    return {ErrorKind::allocation, file, e.what()};
  } catch (const std::exception& e) {
    return {ErrorKind::other, file, e.what()};
  }
}

void throw_again(const ErrorMessage& message) {
  switch (message.kind) {
    case ErrorKind::samples:
      throw SamplesError(message.line);
    case ErrorKind::parameter:
      throw ParameterError(message.line);
    case ErrorKind::input:
      throw InputError(message.line);
    case ErrorKind::output:
      throw OutputError(message.line);
    case ErrorKind::memory:
      throw MemoryError(message.line);
    case ErrorKind::allocation:
      throw std::bad_alloc();
    case ErrorKind::none:
    case ErrorKind::other:
      break;
  }
  throw std::runtime_error(message.line);
}

}  // namespace soapfilm::io
