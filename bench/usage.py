"""Runs a command and writes what it used: usage.py RESULT COMMAND...

A process starts with its parent's peak memory on its account, so the benchmarks, which carry numpy, start programs
through this file, which carries nothing.
"""
import os
import sys
import time

begin = time.monotonic()
child = os.spawnvp(os.P_NOWAIT, sys.argv[2], sys.argv[2:])
_, status, usage = os.wait4(child, 0)
code = os.waitstatus_to_exitcode(status)
with open(sys.argv[1], "w") as result:
    print(code, usage.ru_utime + usage.ru_stime, time.monotonic() - begin, usage.ru_maxrss * 1024 / 1e6,
          usage.ru_stime, usage.ru_minflt, file=result)
