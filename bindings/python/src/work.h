// Long work beside a Python that stays awake.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <functional>
#include <optional>

#include "soapfilm/context.h"

namespace soapfilm::python {

/// Runs `work` on a thread of its own, without the interpreter's lock. Meanwhile the calling thread lets Python run its
/// signal handlers and calls on_event(kind, number, text) unless it is None. What these raise (KeyboardInterrupt on
/// Ctrl-C) cancels the work and is raised once it has ended, within milliseconds.
///
/// `memory`: bytes that the process may take; none: what is free.
///
/// Kinds: "stage" and "done" (number: seconds) of a stage, "advance" (number: fraction of it), "info", "detail" and
/// "warning" (text: a line).
void work_beside_python(int threads, const pybind11::object& on_event, const std::function<void(const Context&)>& work,
                        std::optional<size_t> memory = {});

}  // namespace soapfilm::python
