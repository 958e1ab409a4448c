"""Runs one case: scan, reconstruct by a method or a peer, evaluate. All of it resumable."""
import json

from cases import SEED, Method
from lab import NotKept
from peers import ENVIRONMENT, read_samples, read_scans, write_oriented
from results import Row

POINTS = 100000  # on each surface; means settle to a fifth of a percent


def last_line(measured):
    """What a program that failed said in the end."""
    return (measured["errors"].strip().splitlines() or [f"exit code {measured['code']}"])[-1]


class NoVerdict(Exception):
    """soapfilm evaluate refused: an empty mesh, or a file that is none."""


class Trial:
    """The shapes and clouds of one benchmark and the runs over them."""

    def __init__(self, lab):
        self.lab = lab
        self.facts = {}

    def object_of(self, shape):
        return self.lab.real(shape.file) if shape.file else shape.name

    def truth_of(self, shape):
        """What soapfilm evaluate compares with: exact for a built-in shape, else the mesh with its faces turned."""
        return self.lab.work / f"{shape.name}-truth" / "truth.ply" if shape.file else shape.name

    def prepare(self, shape):
        """Learns the shape's size, area and topology."""
        folder = self.lab.scan(f"{shape.name}-truth", self.object_of(shape), "--samples", 1000, "--seed", SEED)
        box = json.loads((folder / "truth.json").read_text())["object"]["box"]
        judged = self.evaluate(f"{shape.name}-truth", folder / "truth.ply", shape, 1)
        self.facts[shape.name] = {"side": max(hi - lo for lo, hi in zip(box["lo"], box["hi"])),
                                  "area": judged["area"]["mesh"], **judged["topology"]["truth"]}

    def voxel(self, case):
        return self.facts[case.shape.name]["side"] / case.cells

    def scan(self, case):
        """The case's cloud; returns the file to reconstruct. Cases that share it must not come here at once."""
        shape, condition, voxel = case.shape, case.condition, self.voxel(case)
        if case.scans:
            words = ["--step", f"{voxel:.9g}"]
        else:
            count = round(self.facts[shape.name]["area"] / voxel**2 * condition.samples_per_voxel)
            words = ["--samples", count, "--directions", condition.directions]
        folder = self.lab.scan(case.cloud, self.object_of(shape), *words, *condition.errors(voxel))
        (folder / "truth.ply").unlink(missing_ok=True)  # as large as all the rest, and the same each time
        return folder / ("scans.conf" if case.scans else "samples.ply")

    def oriented(self, cloud):
        """The same samples as peers read them; made once for each state of the cloud."""
        source = cloud.parent if cloud.suffix == ".conf" else cloud
        path = cloud.parent.with_name(f"{cloud.parent.name}-{self.lab.digest(source)}-oriented.ply")
        if not path.exists():
            for old in path.parent.glob(f"{cloud.parent.name}-*-oriented.ply"):
                old.unlink()
            write_oriented(path, *(read_scans(cloud) if cloud.suffix == ".conf" else read_samples(cloud)))
        return path

    def mesh(self, case, cloud):
        """Runs the method; returns (mesh, what was measured)."""
        lab, voxel = self.lab, self.voxel(case)
        mesh = lab.work / f"{case.name}.ply"
        if isinstance(case.method, Method):
            words = [lab.program, "reconstruct", cloud, "-o", mesh, "--voxel", f"{voxel:.9g}", *case.method.arguments,
                     "--threads", 1, "--quiet"]
            depends = [lab.program, cloud.parent if cloud.suffix == ".conf" else cloud]
            return mesh, lab.once(f"{case.name}.run", words, depends, mesh)
        ready = self.oriented(cloud)
        words = case.method.words(ready, mesh, case.peer_voxel * voxel, round(case.cells / case.peer_voxel))
        label = f"{case.method.name}, {case.peer_voxel:g} voxels: {cloud.parent.name}"
        return mesh, lab.once(f"{case.name}.run", words, [ready, *case.method.scripts()], mesh, label, ENVIRONMENT)

    def evaluate(self, name, mesh, shape, voxel):
        report = self.lab.work / f"{name}.evaluation.json"
        truth = self.truth_of(shape)
        words = [self.lab.program, "evaluate", mesh, "--truth", truth, "--voxel", f"{voxel:.9g}", "--points", POINTS,
                 "--seed", SEED, "--json", report, "--threads", 1, "--quiet"]
        depends = [self.lab.program, mesh] + ([truth] if shape.file else [])
        measured = self.lab.once(f"{name}.evaluate", words, depends, report, label=f"evaluate {name}")
        if measured["code"]:
            raise NoVerdict(last_line(measured))
        return json.loads(report.read_text())

    def run(self, case, cloud):
        """One line of the result; None when nothing may run and it is not there yet."""
        try:
            return self.judge(case, cloud)
        except NotKept:
            return None

    def judge(self, case, cloud):
        voxel, facts = self.voxel(case), self.facts[case.shape.name]
        truth = json.loads((cloud.parent / "truth.json").read_text())
        samples = (truth.get("scans") or truth["samples"])["samples"]
        row = Row(case.shape.name, case.condition.name, case.method.name, case.cells, case.peer_voxel, voxel, samples,
                  true_components=facts["components"], true_genus=facts["genus"])
        mesh, measured = self.mesh(case, cloud)
        row.cpu, row.peak_mb = measured["cpu"], measured["peak_mb"]
        if measured["code"]:
            row.failure = last_line(measured)
            return row
        try:
            row.take(self.evaluate(case.name, mesh, case.shape, voxel))
        except NoVerdict as refusal:
            row.failure = str(refusal)
        return row
