"""What the benchmark scripts share: running programs, private virtual environments, options, names of the machine."""
import argparse
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BENCH = ROOT / "tools" / "bench"
REFERENCE = ROOT / "tools" / "reference"
CACHE = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "vkopple"


class Failure(Exception):
    """One line: what went wrong and what to do."""


def positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not at least 1")
    return value


def add_program_options(parser):
    parser.add_argument("--threads", type=positive, default=len(os.sched_getaffinity(0)), help="of every program; all cores if not given")
    parser.add_argument("--device", default="cpu", help="vkopple's device: cpu (the fair one), auto, an index or a name")
    parser.add_argument("--vkopple", type=pathlib.Path, default=ROOT / "build/release/vkopple", help="the program")
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of the table")


def require_vkopple(program):
    if not os.access(program, os.X_OK):
        raise Failure(f"{program} is not there: build it (tools/test) or name it with --vkopple")


def say(text):
    print(f"{pathlib.Path(sys.argv[0]).name}: {text}", file=sys.stderr)


def environment_python(venv, requirements):
    """The interpreter of a virtual environment, after installing what a list of requirements asks for, once."""
    python, stamp = venv / "bin/python", venv / f"vkopple-{requirements.name}"
    wanted = requirements.read_text()
    if python.exists() and stamp.exists() and stamp.read_text() == wanted:
        return python
    say(f"installing {requirements.relative_to(ROOT)} into {venv}")
    make = [] if python.exists() else [[sys.executable, "-m", "venv", venv]]
    for command in (*make, [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", requirements]):
        if subprocess.run(command, stdout=sys.stderr).returncode != 0:
            raise Failure(f"{' '.join(map(str, command))} failed: see above (a bare Debian needs the package python3-venv)")
    stamp.write_text(wanted)
    return python


def run_json(command, environment):
    """What a program prints, which must be JSON, with variables added to its environment."""
    try:
        done = subprocess.run(list(map(str, command)), env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True)
    except OSError as error:
        raise Failure(f"{command[0]}: {error.strerror}") from error
    if done.returncode != 0:
        raise Failure(f"{' '.join(map(str, command))} failed with exit code {done.returncode}")
    try:
        return json.loads(done.stdout)
    except json.JSONDecodeError as error:
        raise Failure(f"{' '.join(map(str, command))} printed no JSON: {error}") from error


def run_vkopple(a, *arguments):
    return run_json([a.vkopple, *arguments, "--json"], {"LP_NUM_THREADS": str(a.threads), "VKOPPLE_DEVICE": a.device})


def cpu_name():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
