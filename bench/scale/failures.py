"""Runs that go wrong: failures.py PROGRAM MPI_PROGRAM WORK PAGE COUNT [ROW...]

A scan of a torus is reconstructed with --scratch and --resume, by one process and by mpirun, again and again. COUNT
times one of the ranks is killed; an eighth as often the run is disturbed in each other way: ended, on disks of many
sizes (as root), with calls on files that fail. It must end with a code other than 0 and one line, with its target
absent or as it was, nothing else left but kept stages, and the same command must go on to the same bytes. PAGE gets
the table; ROWs: only those whose names begin so, COUNT times."""
import ctypes
import errno
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import marked

HERE = Path(__file__).resolve().parent
LONGEST = 120  # seconds, then a run counts as one that hangs
OLD = b"old"
STAGE = ".stage"
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]


class Folders:
    """Of one run: its output, scratch and temporary files."""

    def __init__(self, work, output=None, scratch=None):
        self.output, self.scratch, self.temporary = output or work / "output", scratch or work / "scratch", work / "tmp"

    def clear(self):
        for folder in (self.output, self.scratch, self.temporary):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)


class Run:
    """A command, what it is to write, and how it is judged."""

    def __init__(self, bench, folders, parts=False, ranks=0):
        self.bench, self.folders, self.parts, self.ranks = bench, folders, parts, ranks
        self.words = [bench.mpi_program if ranks else bench.program, "reconstruct", bench.scan, "--resolution", "200",
                      "--threads", "1", "-o", folders.output / "m.ply", "--scratch", folders.scratch, "--memory", "40M",
                      "--resume"]
        if parts:
            self.words += ["--split", "4000"]
        if ranks:
            self.words = [*MPIRUN, ranks, *self.words]
        self.process, self.said, self.begin = None, folders.temporary.parent / "said", 0

    @property
    def target(self):
        return self.folders.output / ("m.parts.json" if self.parts else "m.ply")

    def start(self, environment=None):
        self.said.write_text("")
        variables = {**os.environ, "TMPDIR": str(self.folders.temporary), **(environment or {})}
        with self.said.open("w") as said:
            self.process = subprocess.Popen([str(w) for w in self.words], stderr=said, stdout=subprocess.DEVNULL,
                                            env=variables, start_new_session=True)
        self.begin = time.monotonic()

    def wait_for(self, text):
        """Until it has said a line that begins so; False where it ended before."""
        while self.process.poll() is None:
            if any(line.startswith(text) for line in self.said.read_text().splitlines()):
                return True
            time.sleep(0.002)
        return False

    def processes(self):
        """All that it has started, and that are still there."""
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                name, rest = stat.read_text().rsplit(")", 1)
                state, _, _, session = rest.split()[:4]
            except (OSError, ValueError):
                continue
            if int(session) == self.process.pid and state != "Z":
                found.append((int(stat.parent.name), name.split("(", 1)[1]))
        return found

    def end(self):
        """Its exit code, and faults of the ending itself."""
        faults = []
        try:
            self.process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            faults.append("hangs")
        for _ in range(100):
            if not self.processes():
                break
            time.sleep(0.05)
        for pid, name in self.processes():
            faults.append(f"process {name} stays")
            os.kill(pid, signal.SIGKILL)
        self.process.wait()
        return self.process.returncode, faults

    def files(self):
        return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in self.folders.output.iterdir()}

    def lines(self):
        said = self.said.read_text(errors="replace").splitlines()
        return [line for line in said if line.startswith("soapfilm: ") and not line.startswith("soapfilm: warning")]

    def judge(self, silent=False):
        """What is wrong after the end. `silent`: it could not say anything."""
        code, faults = self.end()
        files = self.files()
        left = [p.name for p in self.folders.temporary.iterdir()]
        left += [p.name for p in self.folders.scratch.iterdir() if code == 0 or not p.name.endswith(STAGE)
                 if p.name != "lost+found"]
        if left:
            faults.append(f"left behind: {left}")
        if code == 0:
            if files != self.bench.expected[self.parts]:
                faults.append("ended with 0 and other bytes")
            return code, faults
        said = self.said.read_text(errors="replace")
        by_system = code in (-signal.SIGTERM, 128 + signal.SIGTERM) and "samples in" not in said  # too early
        if not silent and not by_system and (code < 0 or len(self.lines()) != 1):
            faults.append(f"exit code {code}, {len(self.lines())} lines: {said[-300:]}")
        old = {self.target.name: hashlib.sha256(OLD).hexdigest()} if self.had_old else {}
        if files not in ([self.bench.expected[self.parts], old, {}] if self.parts else
                         [self.bench.expected[self.parts], old]):
            faults.append(f"output has {sorted(files)}")
        return code, faults

    had_old = False

    def prepare(self, old):
        self.folders.clear()
        self.had_old = old
        if old:
            self.target.write_bytes(OLD)

    def go_on(self):
        """The same command again."""
        self.start()
        code, faults = self.judge()
        return [f"then: {fault}" for fault in faults] + ([f"then exit code {code}"] if code else [])


class Bench:
    def __init__(self, program, mpi_program, work, rows):
        self.program, self.mpi_program, self.work, self.wanted = program, mpi_program, work, rows
        self.scan, self.random, self.table, self.expected = work / "torus" / "scans.conf", random.Random(1), {}, {}
        if not self.scan.exists():
            subprocess.run([program, "--quiet", "scan", "torus", "-o", work / "torus", "--image", "100x100", "--views",
                            "12", "--seed", "1"], check=True)
        self.seconds, self.writing = {}, {}
        for parts in (False, True):
            run = Run(self, Folders(work), parts)
            run.prepare(False)
            run.start()
            run.wait_for("area ")
            before = time.monotonic()
            if run.end()[0]:
                sys.exit(run.said.read_text())
            self.writing[parts], self.seconds[parts] = time.monotonic() - before, time.monotonic() - run.begin
            self.expected[parts] = run.files()
        self.faults = work / "faults.so"
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", self.faults, HERE / "faults.c", "-ldl"], check=True)

    def wants(self, row):
        return not self.wanted or any(row.startswith(w) for w in self.wanted)

    def note(self, row, ended, faults):
        entry = self.table.setdefault(row, [0, 0, 0])
        entry[0] += 1
        entry[1] += ended
        entry[2] += bool(faults)
        for fault in faults:
            print(f"{row}: {fault}", flush=True)

    def try_one(self, row, run, interrupt, environment=None, silent=False, old=None, goes_on=True):
        """A run that interrupt(run) disturbs, its judgment, and the one that goes on."""
        run.prepare(self.random.random() < 0.5 if old is None else old)
        run.start(environment)
        interrupt(run)
        code, faults = run.judge(silent)
        if goes_on and code:
            faults += run.go_on()
        self.note(row, code != 0, faults)

    # How runs are disturbed.

    def kill_one(self, run, sign, seconds, by_mpirun=False):
        """After a random part of so many seconds, one of the program's processes, or all of them by mpirun."""
        time.sleep(self.random.random() * seconds)
        those = [pid for pid, name in run.processes() if name.startswith("soapfilm")]
        if by_mpirun:
            those = [run.process.pid]
        if those and run.process.poll() is None:
            try:
                os.kill(self.random.choice(those), sign)
            except ProcessLookupError:
                pass

    def kills(self, count, few):
        for row, sign, on_ranks, times in (("kill -9 of one of 2 or 3 ranks", signal.SIGKILL, True, count),
                                           ("kill -9", signal.SIGKILL, False, few),
                                           ("SIGTERM to one of 2 or 3 ranks", signal.SIGTERM, True, few),
                                           ("SIGTERM to mpirun, 2 or 3 ranks", signal.SIGTERM, True, few),
                                           ("SIGTERM", signal.SIGTERM, False, few)):
            by_mpirun = "mpirun" in row
            for k in range(times if self.wants(row) else 0):
                run = Run(self, Folders(self.work), parts=k % 4 == 3, ranks=2 + k % 2 if on_ranks else 0)
                seconds = self.seconds[run.parts] * (2 if on_ranks else 1)
                self.try_one(row, run, lambda r: self.kill_one(r, sign, seconds, by_mpirun),
                             silent=by_mpirun or sign == signal.SIGKILL)

    def kills_while_writing(self, count):
        """By one process; by ranks; by ranks where the mesh has a temporary name while it is written."""
        for who, ranks, named in (("writing", 0, False), ("2 or 3 ranks write", 2, False),
                                  ("2 or 3 ranks write a file with a name", 2, True)):
            for row, sign in ((f"SIGTERM while {who}", signal.SIGTERM), (f"kill -9 while {who}", signal.SIGKILL)):
                for k in range(count if self.wants(row) else 0):
                    run = Run(self, Folders(self.work), parts=k % 2 == 1, ranks=ranks and ranks + k // 2 % 2)

                    def interrupt(running):
                        if running.wait_for("area "):
                            self.kill_one(running, sign, self.writing[running.parts] * (2 if running.ranks else 1))

                    environment = {"LD_PRELOAD": str(self.faults), "FAULT_NAMED": str(run.folders.output)}
                    self.try_one(row, run, interrupt, environment if named else None, silent=sign == signal.SIGKILL)

    def full_disks(self):
        for row, sizes, ranks in (("scratch and output on a disk of 5 to 80 MB", [*range(5, 48), 60, 80], 0),
                                  ("output on a disk of 1 to 6 MB", range(1, 7), 0),
                                  ("output of 2 ranks on a disk of 1 to 6 MB", range(1, 7), 2)):
            for size, parts in ((s, p) for s in sizes if self.wants(row) for p in (False, True)):
                with Mounted(self.work / "disk", ["-t", "tmpfs", "-o", f"size={size}m", "tmpfs"]) as disk:
                    scratch = disk / "scratch" if "scratch" in row else None
                    run = Run(self, Folders(self.work, disk / "output", scratch), parts, ranks)
                    self.try_one(row, run, lambda r: r.end(), goes_on=False)
                    subprocess.run(["mount", "-o", "remount,size=200m", disk], check=True)
                    self.note(row + ", more room then", False, run.go_on())

    def failing_calls(self, count):
        """Each call of a run on its files, one by one, or at least `count` of each kind; of ranks, of each at once."""
        log, counts = self.work / "calls", {}
        base = {"LD_PRELOAD": self.faults, "FAULT_UNDER": self.work, "FAULT_AT": "0"}
        for parts, ranks in ((False, 0), (True, 0), (False, 2), (True, 2)):
            log.unlink(missing_ok=True)
            run = Run(self, Folders(self.work), parts, ranks)
            run.prepare(True)
            run.start({**{k: str(v) for k, v in base.items()}, "FAULT_LOG": str(log)})
            run.end()
            for call in (line.split()[0] for line in log.read_text().splitlines()):
                counts.setdefault((call, parts, ranks), 0)
                counts[call, parts, ranks] += 1
        for (call, parts, ranks), all_calls in sorted(counts.items()):
            row = f"{call} fails" + (" on 2 ranks" if ranks else "")
            all_calls //= max(ranks, 1)
            step = max(1, all_calls // count)
            for at in range(1, all_calls + 1, step) if self.wants(row) else []:
                error = errno.EIO if at // step % 2 or call in ("read", "mmap", "sync_file_range") else errno.ENOSPC
                stays = str(at // step // 2 % 2)
                setting = {**base, "FAULT_CALL": call, "FAULT_AT": at, "FAULT_ERROR": error, "FAULT_STAYS": stays}
                self.try_one(row, Run(self, Folders(self.work), parts, ranks), lambda r: None,
                             {k: str(v) for k, v in setting.items()})

    def lost_pages(self, count):
        row = "arrays on a disk that takes less than it says"
        for k in range(count if self.wants(row) else 0):
            size = self.random.randint(6, 24)
            with Mounted(self.work / "small", ["-t", "tmpfs", "-o", f"size={size}m", "tmpfs"]) as small:
                image = small / "image"
                with image.open("wb") as file:
                    file.truncate(300 << 20)
                subprocess.run(["mkfs.ext4", "-q", "-O", "^has_journal", "-E", "lazy_itable_init=1", image], check=True)
                with Mounted(self.work / "disk", ["-o", "loop", image]) as disk:
                    run = Run(self, Folders(self.work, scratch=disk / "scratch"))
                    self.try_one(row, run, lambda r: write_back(r, disk), goes_on=False)
                    subprocess.run(["mount", "-o", "remount,size=400m", small], check=True)
                    self.note(row + ", more room then", False, run.go_on())
        row = "an array's file is cut short"
        for k in range(count if self.wants(row) else 0):
            self.try_one(row, Run(self, Folders(self.work), ranks=2 if k % 4 == 0 else 0), self.cut_short)

    def cut_short(self, run):
        time.sleep(self.random.random() * self.seconds[False])
        while run.process.poll() is None:
            for pid, name in run.processes():
                for link in Path(f"/proc/{pid}/fd").glob("*"):
                    try:
                        if os.readlink(link).startswith(f"{run.folders.scratch}/#"):
                            return os.truncate(link, 0)
                    except OSError:
                        continue
            time.sleep(0.002)


def write_back(run, folder):
    """Lets the system write what is dirty, all the time."""
    libc = ctypes.CDLL(None)
    place = os.open(folder, os.O_RDONLY)
    while run.process.poll() is None:
        libc.syncfs(place)
        time.sleep(0.01)
    os.close(place)


class Mounted:
    """A folder with a file system of its own, while it lives."""

    def __init__(self, folder, words):
        self.folder = folder
        folder.mkdir(exist_ok=True)
        subprocess.run(["mount", *map(str, words), folder], check=True)

    def __enter__(self):
        return self.folder

    def __exit__(self, *_):
        subprocess.run(["umount", "-l", self.folder], check=True)


def write_table(page, table, commit):
    """Rows of other runs stay."""
    rows = dict(line.split(" | ", 1) for line in marked.read(page, "failures.py").splitlines()[2:])
    for row, (runs, ended, faults) in table.items():
        rows[f"| {row}"] = f"{runs} | {ended} | {faults} | {commit} |"
    head = ["| what happens | runs | that ended early | that did not end as they must | commit |",
            "|---|---|---|---|---|"]
    lines = "\n".join(head + [f"{row} | {numbers}" for row, numbers in rows.items()])
    print(lines)
    marked.write(page, "failures.py", lines + "\n")


def main():
    program, mpi_program, work, page = (Path(a).resolve() for a in sys.argv[1:5])
    count, rows = int(sys.argv[5]), sys.argv[6:]
    few = count if rows else max(1, count // 8)
    commit = subprocess.run(["git", "-C", HERE, "describe", "--always", "--dirty"], capture_output=True, text=True)
    work.mkdir(parents=True, exist_ok=True)
    bench = Bench(program, mpi_program, work, rows)
    bench.kills(count, few)
    bench.kills_while_writing(few)
    bench.failing_calls(few)
    bench.full_disks()
    bench.lost_pages(few)
    write_table(page, bench.table, commit.stdout.strip())
    sys.exit(any(faults for _, _, faults in bench.table.values()))


if __name__ == "__main__":
    main()
