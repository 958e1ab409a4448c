"""Runs programs, measures them, keeps what they made: the benchmarks' one place that knows files and processes."""
import csv
import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

USAGE = str(Path(__file__).resolve().parent / "usage.py")


class NotKept(Exception):
    """The result of this command is not there, or of another program or input."""


@dataclass
class Run:
    """One finished run of the program."""
    mesh: Path
    command: str             # as a reader would type it
    cpu: float = 0           # seconds, user and system
    elapsed: float = 0
    peak_mb: float = 0       # resident maximum, 10^6 bytes
    report: dict = field(default_factory=dict)
    failure: str = ""        # the program's own line when there is no mesh

    def take(self, measured):
        self.cpu, self.elapsed, self.peak_mb = (measured[k] for k in ("cpu", "elapsed", "peak_mb"))
        self.failure = measured["errors"].strip().splitlines()[-1] if measured["code"] else ""
        return self

    @property
    def seconds(self):
        """CPU seconds of the whole run but for the check of the result, which no other program would do."""
        stages = self.report["seconds"]
        return self.cpu * (1 - stages.get("check", 0) / stages["total"])

    @property
    def grid(self):
        return "x".join(str(n) for n in self.report["grid"]["size"])

    @property
    def triangles(self):
        return self.report["mesh"]["triangles"]

    @property
    def rms(self):
        """Of the samples' distances to the mesh, input units."""
        return self.report["mesh"]["sample_distance"]["rms"]

    @property
    def voxel(self):
        return self.report["grid"]["voxel"]

    @property
    def topology(self):
        mesh = self.report["mesh"]
        genus = f", genus {mesh['genus']}" if mesh["genus"] is not None else ""
        parts = f"{mesh['components']} part{'s' * (mesh['components'] != 1)}"
        return f"{'closed' if mesh['closed'] else 'open'}, {parts}{genus}"


class Lab:
    """`programs`: folder of the built programs. `work`: scratch that may be large. `page`: what is published."""

    def __init__(self, programs, work, page):
        self.programs, self.work, self.page = Path(programs), Path(work), Path(page)
        self.program = self.programs / "soapfilm"
        data = os.environ.get("SOAPFILM_DATA")
        self.data = Path(data) if data else None
        self.runs_nothing = False  # raise NotKept instead
        self.digests = {}  # by path and time of change
        self.cpu = {}  # seconds, by name: all that `once` ran or had kept
        self.work.mkdir(parents=True, exist_ok=True)
        self.page.mkdir(parents=True, exist_ok=True)

    def real(self, name):
        """A file of SOAPFILM_DATA, or None."""
        path = self.data / name if self.data else None
        return path if path and path.exists() else None

    def say(self, text):
        print(f"[{time.strftime('%H:%M:%S')}] {text}", flush=True)

    def shown(self, words):
        """A command line without a path of this machine."""
        line = shlex.join(str(w) for w in words).replace(str(self.work) + "/", "")
        line = line.replace(str(self.program), "soapfilm")
        return line.replace(str(self.data), "$SOAPFILM_DATA") if self.data else line

    def digest(self, path):
        """Of a file's content; of all files of a folder when it is one of those."""
        path = Path(path)
        files = sorted(p for p in path.iterdir() if p.is_file()) if path.is_dir() else [path]
        key = tuple((str(p), p.stat().st_mtime_ns) for p in files)
        if key not in self.digests:
            whole = hashlib.sha256()
            for file in files:
                whole.update(file.read_bytes())
            self.digests[key] = whole.hexdigest()[:16]
        return self.digests[key]

    def once(self, name, words, depends, makes, label=None, environment=None):
        """Runs a command, or returns what was measured when it ran last, with the same words and the same content of
        the files it `depends` on: an interrupted benchmark goes on where it stopped. `makes`: the file or folder that
        must be there afterwards when the exit code is 0."""
        words = [str(w) for w in words]
        key = {"words": words, "depends": [self.digest(d) for d in depends]}
        stamp = self.work / f"{name}.json"
        if stamp.exists():
            kept = json.loads(stamp.read_text())
            if kept.get("key") == key and (kept["code"] != 0 or Path(makes).exists()):
                self.cpu[name] = kept["cpu"]
                return kept
        if self.runs_nothing:
            raise NotKept(name)
        self.say(label or self.shown(words))
        measured = self.measure(words, self.work / name, environment)
        stamp.write_text(json.dumps({"key": key, **measured}))
        self.cpu[name] = measured["cpu"]
        return measured

    def measure(self, words, scratch, environment=None):
        """Runs a command: exit code, standard error, cpu and elapsed seconds, peak in megabytes, system's part of cpu,
        pages that were touched for the first time (minor faults; a huge page is one)."""
        log, result = Path(f"{scratch}.log"), Path(f"{scratch}.usage")
        with open(log, "w") as errors:
            subprocess.run([sys.executable, "-I", "-S", USAGE, str(result), *map(str, words)], stderr=errors,
                           stdout=subprocess.DEVNULL, env={**os.environ, **(environment or {})})
        text, (code, *used) = log.read_text(errors="replace"), result.read_text().split()
        log.unlink()
        result.unlink()
        names = ("cpu", "elapsed", "peak_mb", "system", "faults")
        return {"code": int(code), "errors": text, **dict(zip(names, map(float, used)))}

    def output_of(self, words):
        return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout

    def scan(self, name, *arguments):
        """Virtual scans; returns their folder."""
        folder = self.work / name
        words = [self.program, "scan", *arguments, "-o", folder, "--quiet"]
        measured = self.once(f"{name}.scan", words, [self.program], folder, label=f"scan {name}")
        if measured["code"]:
            sys.exit(f"{self.shown(words)}\nexit code {measured['code']}: {measured['errors']}")
        return folder

    def reconstruct(self, name, inputs, *arguments, refine=False):
        """One run with --report, one thread, so that CPU seconds mean work and not waiting. The surface is the paper's
        (threshold, smoothing, isovalue) unless it is to be refined."""
        mesh, report = self.work / f"{name}.ply", self.work / f"{name}.json"
        inputs = inputs if isinstance(inputs, list) else [inputs]
        words = [self.program, "reconstruct", *inputs, "-o", mesh, *arguments, *([] if refine else ["--refine", "off"])]
        full = words + ["--report", report, "--threads", "1", "--quiet"]
        depends = [self.program, *(p.parent if p.suffix == ".conf" else p for p in map(Path, inputs))]
        measured = self.once(f"{name}.run", full, depends, mesh, label=self.shown(words))
        if measured["code"] not in (0, 2, 3):
            sys.exit(f"{self.shown(full)}\nexit code {measured['code']}: {measured['errors']}")
        run = Run(mesh, self.shown(words)).take(measured)
        if not run.failure:
            run.report = json.loads(report.read_text())
        return run

    def render(self, name, files, captions, *arguments):
        """A row of pictures; returns the Markdown that shows it."""
        picture = self.page / f"{name}.png"
        words = [self.program, "render", *files, "-o", picture, "--quiet", *arguments]
        for caption in captions:
            words += ["--caption", caption]
        self.say(f"render {name}")
        subprocess.run([str(w) for w in words], check=True)
        return f"![{', '.join(captions)}]({picture.name})"

    def table(self, name, header, rows):
        """Writes NAME.csv and returns the same as a Markdown table."""
        with open(self.page / f"{name}.csv", "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows(rows)
        return markdown(header, rows)


def markdown(header, rows):
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in [header, ["---"] * len(header), *rows])


def commit():
    """Of the working tree that holds the benchmarks; what differs from it is told, results and documents left out."""
    here = Path(USAGE).parent.parent
    if not shutil.which("git"):
        return "unknown"
    def git(*words):
        return subprocess.run(["git", "-C", here, *words], capture_output=True, text=True).stdout.strip()
    changed = git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs", ":!bench/results", ":!*.md")
    return (git("describe", "--always") or "unknown") + (" with changes" if changed else "")


def machine():
    """The processor's name, how many of it and of which vectors, memory."""
    info = Path("/proc/cpuinfo").read_text()
    def first(name):
        return next((line.split(":", 1)[1].strip() for line in info.splitlines() if line.startswith(name)), "unknown")
    flags = first("flags").split()
    vectors = next((shown for flag, shown in (("avx512f", "AVX-512"), ("avx2", "AVX2")) if flag in flags), "no AVX2")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    return f"{first('model name')}, {os.cpu_count()} cores, {vectors}, {memory:.0f} GB"
