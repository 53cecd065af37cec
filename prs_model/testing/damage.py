"""Damaged part files: what becomes of each, in a table."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any, Literal

from ..errors import PrsError, short
from .sample import Sample
from .variants import variants

SECONDS, MEMORY = 30.0, 2 << 30
SAME = 1e-6  # of the receptances

Result = Literal["refused", "same", "noticed", "unseen", "wrong", "crash", "hang", "memory"]
FAULTS: tuple[Result, ...] = ("wrong", "crash", "hang", "memory")
UNITS, UNSAID = ("m-N-kg-s", "mm-N-tonne-s", "in-lbf-slinch-s"), "units not said"
INCHES = {"*: units in-lbf-slinch-s": "in inches the part is as plausible; its mass and size are said in SI"}


@dataclass(frozen=True)
class Outcome:
    """What became of one damage to one file.

    result: refused with a message; same: read, and the part is the undamaged one to six digits; noticed: read, with a
    warning about its figures; unseen: another part, which nothing can notice, as the sample says with the reason;
    wrong: another part, silently; crash, hang, memory: what no reader may do. difference: of the part from the
    undamaged one, where it was read, as receptances.
    """

    file: str
    damage: str
    result: Result
    message: str
    seconds: float
    difference: float = 0.0

    @property
    def name(self) -> str:
        """Such as ``part.txt: truncated at 50%``."""
        return f"{self.file}: {self.damage}"

    @property
    def is_fault(self) -> bool:
        return self.result in FAULTS


def damage_table(sample: Sample, *, places: int = 3, workers: int = 2) -> tuple[Outcome, ...]:
    """Damage every file of a part in turn, at least 14 ways each, and read the part each time in a process of its own.

    places: at how many seeded places bits, digits and lines are damaged. Each reading may take 30 s and 2 GiB. Raises
    PrsError when the undamaged sample cannot be read, or where the system has no `fork`.
    """
    if not hasattr(os, "fork"):
        raise PrsError("damage tables need a system with fork: Linux or macOS")
    with TemporaryDirectory(prefix="prs-model-damage-") as name:
        folder = Path(name)
        whole = sample.copied(folder / "whole")
        trials = list(_trials(whole, folder, places))
        shares = [trials[first::workers] for first in range(workers)]
        with ThreadPoolExecutor(workers) as pool:
            answers = list(pool.map(lambda share: read_apart(whole, [trial.sample for trial in share]), shares))
    found = {
        trial.name: _outcome(trial, answer, sample)
        for share, said in zip(shares, answers, strict=True)
        for trial, answer in zip(share, said, strict=True)
    }
    return tuple(found[trial.name] for trial in trials)


def as_text(outcomes: Sequence[Outcome]) -> str:
    """The table as lines of text: result, file and damage, what was said."""
    width = max((len(each.name) for each in outcomes), default=0)
    return "\n".join(f"{each.result:<8} {each.name:<{width}}  {short(each.message, 160)}" for each in outcomes)


def read_apart(whole: Sample, damaged: Sequence[Sample]) -> list[dict[str, Any]]:
    """What a process of its own says of each: result, message, and of what is read difference and surprises."""
    samples = [whole, *damaged]
    task = {"jobs": [_plain(sample) for sample in samples], "seconds": SECONDS, "memory": MEMORY}
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    environment["PYTHONPATH"] = os.pathsep.join(entry for entry in sys.path if entry)
    command = [sys.executable, "-m", f"{__package__}.trial"]
    done = subprocess.run(command, input=json.dumps(task).encode(), capture_output=True, env=environment, check=False)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    if done.returncode != 0 or len(answers) != len(damaged):
        said = done.stderr.decode(errors="replace").strip().splitlines()
        raise PrsError(
            f"{whole.reducer}: the undamaged sample cannot be read: {said[-1] if said else 'no reason said'}"
        )
    return answers


@dataclass(frozen=True)
class _Trial:
    file: str
    damage: str
    sample: Sample

    @property
    def name(self) -> str:
        return f"{self.file}: {self.damage}"


def _trials(whole: Sample, folder: Path, places: int) -> Iterator[_Trial]:
    root = folder / "whole"
    for file in whole.files():
        content = file.read_bytes()
        for variant in variants(content, places):
            damaged = variant(content, file.name)
            if damaged != content:
                yield _Trial(file.name, variant.name, _with(whole, root, folder, file, damaged))
        if file != whole.path:
            yield _Trial(file.name, "absent", _with(whole, root, folder, file, None))
        if file.name in whole.others:
            other = Path(whole.others[file.name]).read_bytes()
            yield _Trial(file.name, "that of another part", _with(whole, root, folder, file, other))
    for units in (None, *UNITS):
        if units != whole.units:
            damage = UNSAID if units is None else f"units {units}"
            yield _Trial(whole.path.name, damage, replace(whole, units=units))


def _with(whole: Sample, root: Path, folder: Path, file: Path, content: bytes | None) -> Sample:
    """The sample in a folder of its own, where one file has another content, or is not there."""
    own = Path(mkdtemp(dir=folder))
    for each in root.rglob("*"):
        target = own / each.relative_to(root)
        if each.is_dir():
            target.mkdir(parents=True, exist_ok=True)
        elif each != file:
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(each, target)
        elif content is not None:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
    return replace(whole, source=own / whole.path.relative_to(root))


def _plain(sample: Sample) -> dict[str, Any]:
    return {**asdict(sample), "source": str(sample.source), "others": {}, "unseen": {}}


def _outcome(trial: _Trial, answer: Mapping[str, Any], sample: Sample) -> Outcome:
    result, message, difference = answer["result"], answer["message"], float(answer.get("difference", 0.0))
    if result == "read":
        result, message = _as_read(trial.name, difference, answer["surprises"], INCHES | dict(sample.unseen))
    message = " ".join(message.replace(f"{Path(trial.sample.path).parent}{os.sep}", "").split())
    return Outcome(trial.file, trial.damage, result, message, float(answer["seconds"]), difference)


def _as_read(name: str, difference: float, surprises: Sequence[str], unseen: Mapping[str, str]) -> tuple[Result, str]:
    if difference <= SAME:
        return "same", ""
    if surprises:
        return "noticed", surprises[0]
    far = f"differs by {difference:.1e}"
    reasons = [reason for pattern, reason in unseen.items() if fnmatchcase(name, pattern)]
    return ("unseen", f"{far}: {reasons[0]}") if reasons else ("wrong", far)
