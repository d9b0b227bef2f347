"""Two programs that take turns at the same work."""
from common import REFERENCE, cpu_name, environment_python, require_vkopple, run_json, run_vkopple, say


class Contest:
    """Runs vkopple and PyTorch `rounds` times by turns, or one of them alone, and keeps what each printed."""

    def __init__(self, a):
        self.a = a
        self.python = environment_python(a.venv, REFERENCE / "requirements.txt") if a.only != "vkopple" else None
        if a.only != "torch":
            require_vkopple(a.vkopple)
        self.ours, self.theirs = [], []

    def run(self, ours, theirs, describe):
        """ours: arguments of vkopple; theirs: script of tools/reference and its arguments; describe: a result in words."""
        for number in range(self.a.rounds):
            said = []
            if self.a.only != "torch":
                self.ours.append(run_vkopple(self.a, *ours))
                said.append(f"vkopple {describe(self.ours[-1])}")
            if self.a.only != "vkopple":
                self.theirs.append(self.run_torch(*theirs))
                said.append(f"torch {describe(self.theirs[-1])}")
            say(f"round {number + 1} of {self.a.rounds}: {', '.join(said)}")

    def run_torch(self, script, *arguments):
        return run_json([self.python, "-B", REFERENCE / script, *arguments, "--threads", self.a.threads],
                        {"OMP_NUM_THREADS": str(self.a.threads), "CUDA_VISIBLE_DEVICES": ""})

    def header(self, **more):
        return header(self.a, self.ours, self.theirs, **more)


def header(a, ours, theirs, **more):
    """What every result says first: machine, device and versions."""
    result = dict(what=a.what, threads=a.threads, rounds=a.rounds, cpu=cpu_name(), **more)
    if ours:
        result["device"], result["driver"] = ours[0]["device"], ours[0]["driver"]
    if theirs:
        result["torch_version"] = f"{theirs[0]['torch']} ({theirs[0]['instructions']})"
    return result


def header_lines(r):
    yield f"cpu      {r['cpu']}, {r['threads']} threads, best of {r['rounds']}"
    if "device" in r:
        yield f"device   {r['device']}, driver {r['driver']}"
    if "torch_version" in r:
        yield f"torch    {r['torch_version']}"
