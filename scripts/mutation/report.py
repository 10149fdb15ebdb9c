"""What is told of mutants that were tried."""

import sys
import tomllib

from mutation.changes import Mutant
from mutation.strata import ROOT
from mutation.trial import Result

EXPLAINED = ROOT / "scripts" / "mutation" / "explained.toml"


def explanations() -> list[dict[str, str]]:
    """Return why mutants live that no test sees: file, change and why; the line, too, where others read the same."""
    rows: list[dict[str, str]] = tomllib.loads(EXPLAINED.read_text(encoding="utf-8"))["mutant"]
    return rows


def reason(mutant: Mutant) -> str | None:
    """Return why no test sees a mutant, None if it is not explained."""
    line = (ROOT / mutant.file).read_text(encoding="utf-8").splitlines()[mutant.line - 1].strip()
    fitting = (r for r in explanations() if (r["file"], r["change"]) == (mutant.file, mutant.what))
    return next((r["why"] for r in fitting if r.get("line", line) == line), None)


def share(killed: int, of: int) -> str:
    """Return the share killed with its interval, in per cent."""
    sys.path.insert(0, str(ROOT))
    from uavsim.studies.intervals import share_interval

    low, high = share_interval(killed, of)
    return f"{100.0 * killed / of:5.1f} %  ({100.0 * low:.1f} … {100.0 * high:.1f})"


def table(results: list[Result]) -> str:
    """Return the counts of each stratum and of all."""
    lines = [f"{'':18} drawn  killed  by time  alive   share killed, 95 % interval"]
    for name in [*dict.fromkeys(r.stratum for r in results), "all"]:
        some = [r for r in results if name in (r.stratum, "all")]
        killed, late = sum(r.killed for r in some), sum(r.ended == "time" for r in some)
        counts = f"{len(some):5}  {killed:6}  {late:7}  {len(some) - killed:5}"
        lines.append(f"{name:18} {counts}   {share(killed, len(some))}")
    return "\n".join(lines)


def survivors(results: list[Result]) -> str:
    """Return those alive, with what is known of them."""
    lines = []
    for r in sorted((r for r in results if not r.killed), key=lambda r: (r.mutant.file, r.mutant.line)):
        lines.append(f"{r.mutant.file}:{r.mutant.line}  {r.mutant.kind}  {r.mutant.what}")
        lines.append(f"    {reason(r.mutant) or 'not explained'}")
    return "\n".join(lines)
