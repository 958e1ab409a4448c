// The error of a file, or of a part of one, on its way from the rank that read it to the others.
#pragma once

#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "soapfilm/core/ranks.h"
#include "soapfilm/io/sets/cloud_message.h"

namespace soapfilm::io {

/// Of soapfilm/error.h, as far as exit codes and lines tell them apart.
enum class ErrorKind : uint8_t { none, parameter, samples, input, output, memory, allocation, other };

struct ErrorMessage {
  ErrorKind kind = ErrorKind::none;
  uint64_t number = 0;  ///< of the file or the part: the lowest is the one that one process meets
  std::string line{};
};

template <class Way>
void pack(Way& way, ErrorMessage& message) {
  pack(way, message.kind);
  pack(way, message.number);
  pack(way, message.line);
}

ErrorMessage message_of(const std::exception_ptr& error, uint64_t number);

/// Throws the error with the lowest number on all ranks; returns if none has one.
void throw_first(Ranks& ranks, const ErrorMessage& own);

/// What each rank gives, on each.
std::vector<std::vector<std::byte>> bytes_of_all(Ranks& ranks, std::vector<std::byte> own);

}  // namespace soapfilm::io
