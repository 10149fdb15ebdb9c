"""Files that are whole or not there."""

import errno
import os
from pathlib import Path

import pytest

from uavsim import files
from uavsim.files import whole, write_json, write_text, write_toml


def test_a_file_appears_when_it_is_whole(tmp_path: Path) -> None:
    file = tmp_path / "a.txt"
    file.write_text("before")
    with whole(file) as part:
        part.write_text("new")
        assert file.read_text() == "before"
        assert part.parent == tmp_path  # on the same disk, so that it can be renamed
        assert part.name.startswith(".")  # a folder of Parquet files is read without it
        number = part.stat().st_ino
    assert file.read_text() == "new"
    assert file.stat().st_ino == number  # renamed, not copied
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("error", [KeyboardInterrupt, ValueError("x"), OSError(errno.ENOSPC, "no space")])
def test_what_is_not_whole_vanishes(tmp_path: Path, error: BaseException | type[BaseException]) -> None:
    file = tmp_path / "a.txt"
    file.write_text("before")

    def fail() -> None:
        with whole(file) as part:
            part.write_text("half")
            raise error

    with pytest.raises((KeyboardInterrupt, ValueError, OSError)):
        fail()
    assert file.read_text() == "before"
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EIO])
def test_an_error_of_the_system_names_the_file_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    """Also one that a library words in its own way, as pyarrow does, and one that comes with the last bytes."""
    file = tmp_path / "a.json"
    says = f"{file} cannot be written: {os.strerror(number)}"
    with pytest.raises(OSError, match="cannot be written") as caught, whole(file):
        raise OSError(number, f"Error writing bytes to file. Detail: [errno {number}] …")
    assert str(caught.value) == says

    def fail(_: Path) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(files, "force", fail)
    with pytest.raises(OSError, match="cannot be written") as caught:
        write_json(file, {})
    assert str(caught.value) == says
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"no/a.txt cannot be written: No such file or directory"):
        write_text(tmp_path / "no" / "a.txt", "")


def test_plain_values_are_written_as_they_read(tmp_path: Path) -> None:
    write_toml(tmp_path / "a.toml", {"a": 1.5, "none": None, "b": {"c": ["ä"], "none": None}})
    assert (tmp_path / "a.toml").read_text(encoding="utf-8") == 'a = 1.5\n\n[b]\nc = [\n    "ä",\n]\n'
    with pytest.raises(ValueError, match="Out of range"):
        write_json(tmp_path / "a.json", float("nan"))
    assert not (tmp_path / "a.json").exists()
