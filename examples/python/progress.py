"""A function of yours is told how far a run is, and stops it by raising an exception."""
import soapfilm


class Enough(Exception):
    pass


def progress(stage, fraction, detail):
    if fraction == 1:
        print(f"{stage} done")
    if stage == "refine":
        raise Enough


try:
    soapfilm.reconstruct(soapfilm.scan("arch", samples=20_000), resolution=48, progress=progress)
except Enough:
    print("stopped while the surface was moved onto the samples; nothing is left behind")
