"""Where aircraft are found: in a checkout, inside an installed package, and by the path of a user's own."""

from pathlib import Path

import pytest

from uavsim.plants import hangar
from uavsim.plants.hangar import aircraft, find_aircraft


def made(folder: Path, name: str) -> Path:
    (folder / name).mkdir(parents=True)
    (folder / name / f"{name}.xml").write_text("<fdm_config/>")
    return folder / name


def test_the_packaged_aircraft_is_there_with_its_parts() -> None:
    assert "fw8" in aircraft()
    folder = find_aircraft("fw8")
    assert (folder / "fw8.xml").is_file()
    assert (folder / "geometry.toml").is_file()
    assert folder.is_absolute()


def test_an_own_aircraft_is_named_by_its_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = made(tmp_path / "mine", "bird")
    assert find_aircraft(str(own)) == own.resolve()
    monkeypatch.chdir(tmp_path / "mine")
    assert find_aircraft("bird") == own.resolve()
    assert find_aircraft("./bird") == own.resolve()


def test_a_packaged_name_is_the_packaged_aircraft_wherever_one_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(tmp_path, "fw8")
    monkeypatch.chdir(tmp_path)
    assert find_aircraft("fw8").parent == hangar.hangar().resolve()


def test_the_home_folder_may_be_meant(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = made(tmp_path, "bird")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert find_aircraft("~/bird") == own.resolve()


@pytest.mark.parametrize("name", ["fw9", "FW8", "f8w"])
def test_a_slip_is_told_the_nearest(name: str) -> None:
    with pytest.raises(ValueError, match=rf"unknown aircraft '{name}'; did you mean 'fw8'\?"):
        find_aircraft(name)


@pytest.mark.parametrize("name", ["", "zzzzzz", "../aircraft", "/", "fw8/fw8.xml"])
def test_what_is_no_aircraft_is_refused_with_what_there_is(name: str) -> None:
    with pytest.raises(ValueError, match=r"unknown aircraft .*packaged: .*fw8"):
        find_aircraft(name)


def test_a_folder_without_its_file_is_no_aircraft(tmp_path: Path) -> None:
    (tmp_path / "bird").mkdir()
    (tmp_path / "bird" / "other.xml").write_text("")
    with pytest.raises(ValueError, match="unknown aircraft"):
        find_aircraft(str(tmp_path / "bird"))


def test_an_installed_package_carries_its_aircraft(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inside the package goes before beside it; without either the installation is said to be incomplete."""
    package = tmp_path / "site" / "uavsim"
    package.mkdir(parents=True)
    monkeypatch.setattr(hangar, "_PACKAGE", package)
    with pytest.raises(FileNotFoundError, match="incomplete"):
        hangar.hangar()
    beside = made(tmp_path / "site" / "aircraft", "one")
    assert aircraft() == ["one"]
    inside = made(package / "aircraft", "two")
    assert aircraft() == ["two"]
    assert find_aircraft("two") == inside.resolve()
    assert find_aircraft(str(beside)) == beside.resolve()


def test_with_a_slash_it_is_a_path_even_if_a_packaged_one_has_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    own = tmp_path / "fw8"
    own.mkdir()
    (own / "fw8.xml").touch()
    assert find_aircraft("./fw8") == own
    assert find_aircraft("fw8") == hangar.hangar().resolve() / "fw8"
