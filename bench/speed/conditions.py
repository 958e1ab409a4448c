"""The two states of the machine's memory in which the speed benchmark runs programs.

A virtual machine gives memory that was free for some seconds back to its host, and pays for each page of it again. So
what a run costs depends on what ran before it.

- warmed: another process uses memory right before, more than any program will. What a run asks for in its first two
  seconds or so comes warm; later the rest has gone back, so a run of 2 s is spared more of its pages than one of 25 s.
- rested: the machine idles before, until what is free has gone back. A run pays for every page that it touches first;
  what it frees itself and asks for again within two seconds comes warm.

On a machine that keeps its memory the two are the same."""
import mmap
import subprocess
import sys
import time

WARMED, RESTED = "warmed", "rested"
CONDITIONS = (WARMED, RESTED)
WARM_MB = 2000  # more than any program of the cases has at its peak
REST = 10  # seconds; the kernel reports what is free every two


def warm_memory(megabytes):
    """In huge pages where there are any, lest it leaves none to the program that follows."""
    pages = megabytes * 1_000_000 // mmap.PAGESIZE
    use = f"""
import contextlib, mmap
memory = mmap.mmap(-1, {pages * mmap.PAGESIZE})
with contextlib.suppress(OSError):  # of a kernel without
    memory.madvise(mmap.MADV_HUGEPAGE)
memory[::{mmap.PAGESIZE}] = bytes({pages})
"""
    subprocess.run([sys.executable, "-I", "-S", "-c", use], check=True)


class Memory:
    """Brings the machine into a condition."""

    def __init__(self, warm_mb=WARM_MB, rest=REST):
        self.warm_mb, self.rest = warm_mb, rest

    def prepare(self, condition):
        if condition == RESTED:
            time.sleep(self.rest)
        else:
            warm_memory(self.warm_mb)
