// The error of a file on its way from the rank that read it to the others.
#pragma once

#include <cstdint>
#include <exception>
#include <string>

#include "soapfilm/io/sets/cloud_message.h"

namespace soapfilm::io {

/// Of soapfilm/error.h, as far as exit codes and lines tell them apart.
enum class ErrorKind : uint8_t { none, parameter, samples, input, output, memory, allocation, other };

struct ErrorMessage {
  ErrorKind kind = ErrorKind::none;
  uint64_t file = 0;  ///< its number
  std::string line{};
};

template <class Way>
void pack(Way& way, ErrorMessage& message) {
  pack(way, message.kind);
  pack(way, message.file);
  pack(way, message.line);
}

ErrorMessage message_of(const std::exception_ptr& error, uint64_t file);
/// The same error, on any rank.
[[noreturn]] void throw_again(const ErrorMessage& message);

}  // namespace soapfilm::io
