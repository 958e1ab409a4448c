#include "soapfilm/io/sets/error_message.h"

#include <new>
#include <stdexcept>
#include <utility>

#include "soapfilm/error.h"

namespace soapfilm::io {

ErrorMessage message_of(const std::exception_ptr& error, uint64_t number) {
  try {
    std::rethrow_exception(error);
  } catch (const SamplesError& e) {
    return {ErrorKind::samples, number, e.what()};
  } catch (const ParameterError& e) {
    return {ErrorKind::parameter, number, e.what()};
  } catch (const InputError& e) {
    return {ErrorKind::input, number, e.what()};
  } catch (const OutputError& e) {
    return {ErrorKind::output, number, e.what()};
  } catch (const MemoryError& e) {
    return {ErrorKind::memory, number, e.what()};
  } catch (const std::bad_alloc& e) {
    return {ErrorKind::allocation, number, e.what()};
  } catch (const std::exception& e) {
    return {ErrorKind::other, number, e.what()};
  }
}

namespace {

/// The same error, on any rank.
[[noreturn]] void throw_again(const ErrorMessage& message) {
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

/// Once all know it: rank 0 first, whose line is the one that is printed. The others wait for it, so that it does not
/// learn of their end before.
[[noreturn]] void throw_on_all(Ranks& ranks, const ErrorMessage& error) {
  uint8_t known = 1;
  std::vector<Ranks::Message> out, in;
  for (int r = 1; r < ranks.count() && ranks.rank() == 0; ++r) out.push_back({r, &known, 1});
  if (ranks.rank() > 0) in.push_back({0, &known, 1});
  try {
    ranks.exchange(out, in);
  } catch (const Cancelled&) {  // another rank has thrown it
  }
  throw_again(error);
}

}  // namespace

void throw_first(Ranks& ranks, const ErrorMessage& own) {
  Packer to;
  ErrorMessage first = own, error = own;
  pack(to, error);
  for (const std::vector<std::byte>& bytes : bytes_of_all(ranks, std::move(to.bytes))) {
    Unpacker from(bytes);
    pack(from, error);
    if (error.kind != ErrorKind::none && (first.kind == ErrorKind::none || error.number < first.number)) first = error;
  }
  if (first.kind != ErrorKind::none) throw_on_all(ranks, first);
}

std::vector<std::vector<std::byte>> bytes_of_all(Ranks& ranks, std::vector<std::byte> own) {
  std::vector<std::vector<std::byte>> all;
  for (const size_t size : of_all(ranks, own.size())) all.emplace_back(size);
  all[static_cast<size_t>(ranks.rank())] = std::move(own);
  std::vector<Ranks::Message> out, in;
  for (int r = 0; r < ranks.count(); ++r) {
    if (r == ranks.rank()) continue;
    std::vector<std::byte>&from_here = all[static_cast<size_t>(ranks.rank())], &to_here = all[static_cast<size_t>(r)];
    out.push_back({r, from_here.data(), from_here.size()});
    in.push_back({r, to_here.data(), to_here.size()});
  }
  ranks.exchange(out, in);
  return all;
}

}  // namespace soapfilm::io
