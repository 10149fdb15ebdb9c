"""Replay the recordings of a folder and hold them against their right answers.

    UAVSIM_RECORDINGS=/some/folder python scripts/recordings.py [--out TABLE.md] [--answers FOLDER]

The folder has logs of any kind that `uavsim replay` reads. Right answers are TOML files beside them, or those of
`recordings/` here, which are for files that are published elsewhere (`uavsim.studies.recordings`). The status is 1 if
an answer is not met.
"""

import argparse
import os
import sys
from pathlib import Path

from uavsim.studies.recordings import answers_for, replayed
from uavsim.views.recordings import table

OURS = Path(__file__).resolve().parent.parent / "recordings"


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description="Replay the recordings of a folder against their right answers.")
    parser.add_argument("--folder", type=Path, default=os.environ.get("UAVSIM_RECORDINGS"))
    parser.add_argument("--answers", type=Path, default=OURS, help="where answers lie that are not beside the logs")
    parser.add_argument("--out", type=Path, help="the table, as Markdown")
    given = parser.parse_args()
    if given.folder is None:
        print("UAVSIM_RECORDINGS names no folder: nothing to replay")
        return 0
    folder = Path(given.folder)
    if not folder.is_dir():
        print(f"Error: UAVSIM_RECORDINGS: there is no folder {folder}", file=sys.stderr)
        return 2
    try:
        answers = answers_for(folder, (folder, given.answers))
    except (ValueError, OSError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    found = []
    for one in replayed(folder, answers):
        found.append(one)
        print(f"replayed {one.title}", file=sys.stderr)
    lines = table(found)
    print("\n".join(lines))
    if given.out is not None:
        given.out.parent.mkdir(parents=True, exist_ok=True)
        given.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return int(any(one.judged and one.wrong for one in found))


if __name__ == "__main__":
    sys.exit(main())
