"""What is told of mutants that were tried."""

import sys
import tomllib

from mutation.strata import ROOT
from mutation.trial import Result

EXPLAINED = ROOT / "scripts" / "mutation" / "explained.toml"


def explanations() -> dict[tuple[str, str], str]:
    """Return why mutants that no test sees are none, by file and change."""
    rows = tomllib.loads(EXPLAINED.read_text(encoding="utf-8")).get("mutant", [])
    return {(row["file"], row["change"]): row["why"] for row in rows}


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
    known, lines = explanations(), []
    for r in sorted((r for r in results if not r.killed), key=lambda r: (r.mutant.file, r.mutant.line)):
        lines.append(f"{r.mutant.file}:{r.mutant.line}  {r.mutant.kind}  {r.mutant.what}")
        why = known.get((r.mutant.file, r.mutant.what))
        lines.append(f"    {why}" if why else "    not explained")
    return "\n".join(lines)
