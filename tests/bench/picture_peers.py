"""The renderers as processes: their command lines, one whole run, and runs in turns.

Knows no scene and no floor. Seconds are the wall's; memory is the peak of the process, in MiB.
"""
import os
import shutil
import subprocess
import threading
import time

SIZE, BOUNCES = 512, 5
LIMIT = 600  # seconds; nothing here may hang
# Linear bytes and no environment, as the others do.
COMMON = ["--resolution", f"{SIZE}x{SIZE}", "--depth", str(BOUNCES), "--background", "color", "--transfer", "linear", "--quiet"]


def glint(program, source, features, spp, threads, picture):
    return [program, "render", source, "-o", picture, *COMMON, "--spp", str(spp), "--threads", str(threads),
            "--features", features + (",aa" if spp > 1 else "")]


def povray(source, spp, threads, picture):
    # Threshold 0: every pixel gets the whole grid of samples, as its statistics in the log confirm.
    samples = ["+A0.0", "+AM1", f"+R{round(spp ** 0.5)}", "-J"] if spp > 1 else ["-A"]
    return ["povray", f"+I{source}", f"+O{picture}", f"+W{SIZE}", f"+H{SIZE}", f"+WT{threads}", "+FP", "-D", "-V",
            "File_Gamma=1.0", *samples]


def tachyon(source, spp, threads, picture):
    return ["tachyon", source, "-res", str(SIZE), str(SIZE), "-numthreads", str(threads), "-aasamples", str(spp - 1),
            "-format", "PPM", "-o", picture]


def peer_python():
    """The Python that has Mitsuba, or None: $GLINT_PEER_PYTHON, else python3."""
    python = os.environ.get("GLINT_PEER_PYTHON", "python3")
    if shutil.which(python) is None:
        return None
    tried = subprocess.run([python, "-c", "import mitsuba"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    return python if tried.returncode == 0 else None


def run(command, log):
    """Seconds and peak MiB of one process, which must succeed."""
    start = time.monotonic()
    with subprocess.Popen(command, stdout=log, stderr=log, stdin=subprocess.DEVNULL) as process:
        alarm = threading.Timer(LIMIT, process.kill)
        alarm.start()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - start
        alarm.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} failed; see {log.name}")
    return seconds, usage.ru_maxrss / 1024


class Warm:
    """A process that has loaded a scene and renders it whenever asked."""

    def __init__(self, command, log):
        self.command, self.log = command, log
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log, text=True)

    def seconds(self, light, spp, picture=""):
        alarm = threading.Timer(LIMIT, self.process.kill)
        alarm.start()
        try:
            self.process.stdin.write(f"{light} {spp} {picture}\n")
            self.process.stdin.flush()
            # What a library says of its own accord is not the answer.
            for line in self.process.stdout:
                try:
                    return float(line)
                except ValueError:
                    continue
        except BrokenPipeError:
            pass
        finally:
            alarm.cancel()
        raise RuntimeError(f"{' '.join(self.command)} failed; see {self.log.name}")

    def end(self):
        try:
            self.process.stdin.close()
            self.process.wait(30)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()


def race(entrants, rounds):
    """{name: [result a round]} of functions without arguments. Each round starts with another of them, so that none always
    runs behind the same neighbour."""
    names, results = list(entrants), {name: [] for name in entrants}
    for i in range(rounds):
        at = i % len(names)
        for name in names[at:] + names[:at]:
            results[name].append(entrants[name]())
    return results
