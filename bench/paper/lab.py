"""Runs the program, measures it, keeps what it made: the one place that knows files and processes."""
import csv
import json
import os
import shlex
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path


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
        return f"{'closed' if mesh['closed'] else 'open'}, {mesh['components']} part{'s' * (mesh['components'] != 1)}{genus}"


class Lab:
    """`programs`: folder of the built programs. `work`: scratch that may be large. `page`: what is published."""

    def __init__(self, programs, work, page):
        self.programs, self.work, self.page = Path(programs), Path(work), Path(page)
        self.program = self.programs / "soapfilm"
        data = os.environ.get("SOAPFILM_DATA")
        self.data = Path(data) if data else None
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

    def measure(self, words):
        """Runs a command; returns (exit code, standard error, cpu seconds, elapsed seconds, peak megabytes)."""
        log = self.work / "stderr.txt"
        begin = time.monotonic()
        with open(log, "w") as errors:
            process = subprocess.Popen([str(w) for w in words], stderr=errors, stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        return (process.returncode, log.read_text(), usage.ru_utime + usage.ru_stime, time.monotonic() - begin,
                usage.ru_maxrss * 1024 / 1e6)

    def output_of(self, words):
        return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout

    def is_current(self, stamp, words, inputs=()):
        """Was this command's result made by this program of these inputs? Lets an interrupted `make paper` go on."""
        newest = max(Path(p).stat().st_mtime for p in (self.program, *inputs))
        return stamp.exists() and stamp.stat().st_mtime > newest and json.loads(stamp.read_text())["words"] == words

    def scan(self, name, *arguments):
        """Virtual scans; returns their folder."""
        folder = self.work / name
        words = [str(self.program), "scan", *map(str, arguments), "-o", str(folder), "--quiet"]
        stamp = self.work / f"{name}.scan.json"
        if not self.is_current(stamp, words):
            self.say(f"scan {name}")
            subprocess.run(words, check=True)
            stamp.write_text(json.dumps({"words": words}))
        return folder

    def reconstruct(self, name, inputs, *arguments, refine=False):
        """One run with --report, one thread, so that CPU seconds mean work and not waiting. The surface is the paper's
        (threshold, smoothing, isovalue) unless it is to be refined."""
        mesh, report = self.work / f"{name}.ply", self.work / f"{name}.json"
        inputs = inputs if isinstance(inputs, list) else [inputs]
        words = [str(self.program), "reconstruct", *map(str, inputs), "-o", str(mesh), *map(str, arguments)]
        if not refine:
            words += ["--refine", "off"]
        full = words + ["--report", str(report), "--threads", "1", "--quiet"]
        run = Run(mesh, self.shown(words))
        stamp = self.work / f"{name}.run.json"
        if not self.is_current(stamp, full, inputs):
            self.say(self.shown(words))
            code, errors, run.cpu, run.elapsed, run.peak_mb = self.measure(full)
            if code not in (0, 2, 3):
                sys.exit(f"{self.shown(full)}\nexit code {code}: {errors}")
            run.failure = errors.strip().splitlines()[-1] if code else ""
            stamp.write_text(json.dumps({"words": full, "cpu": run.cpu, "elapsed": run.elapsed,
                                         "peak_mb": run.peak_mb, "failure": run.failure}))
        kept = json.loads(stamp.read_text())
        run.cpu, run.elapsed, run.peak_mb, run.failure = (kept[k] for k in ("cpu", "elapsed", "peak_mb", "failure"))
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
        lines = ["| " + " | ".join(map(str, row)) + " |" for row in [header, ["---"] * len(header), *rows]]
        return "\n".join(lines)
