"""What `--vary` takes: how it is read, what each cell flies, and what is refused, in one line."""

from typing import Any

import pytest

from uavsim.scenario import Scenario, load_scenario
from uavsim.studies.campaign.plan import Cells
from uavsim.studies.campaign.vary import applied, cells, labels, parse, varied


@pytest.fixture(scope="module")
def catapult() -> Scenario:
    return load_scenario("catapult")


@pytest.mark.parametrize(
    ("text", "choices"),
    [
        ("air_data.total.noise_scale=0.5,1,2,4", (0.5, 1, 2, 4)),
        ("accelerometer.bias=0:2:9", tuple(0.25 * i for i in range(9))),
        ("accelerometer.bias = -0.3 : 0.3 : 3".replace(" : ", ":"), (-0.3, 0.0, 0.3)),
        ("accelerometer.bias=[1,2,3],0", ([1, 2, 3], 0)),
        ("launcher.peak_specific_force_g=0.5x,1x,2x", (4.0, 8.0, 16.0)),
        ("launcher.stroke=0.5x:1.5x:3", (2.6, 5.2, 7.8)),
        ("air_data.position=0.5x,1x", ([0.325, 0.0, 0.0], [0.65, 0.0, 0.0])),
        ("air_data.position[0]=0.5x,1x", (0.325, 0.65)),
        ("plant.step_rate=1000:2000:2", (1000, 2000)),
        ("plant.step_rate=1x,2x", (1000, 2000)),
        ("detector.kind=px4,inav", ("px4", "inav")),
        ('environment.preset="",light', ("", "light")),
        ("accelerometer.errors.bandwidth=true,false", (True, False)),
        ("environment.gusts=[],[{at = 'release', delay = 1.0, speed = 2.0}]", None),
        ("detector.options.a=1,b", (1, "b")),
        ("aircraft.properties.metrics/Sw-sqft=1,2", (1, 2)),
    ],
)
def test_values_are_read(catapult: Scenario, text: str, choices: tuple[Any, ...] | None) -> None:
    found = parse(catapult, text)
    assert found.key == text.partition("=")[0].strip()
    assert choices is None or found.choices == choices
    assert [type(one) for one in found.choices] == [type(one) for one in choices or found.choices]


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (("launcher.strok=1,2",), "did you mean 'launcher.stroke'?"),
        (("launcher=1,2",), "is a group"),
        (("launcher.stroke",), "give it as KEY=VALUES"),
        (("launcher.stroke=",), "give it as KEY=VALUES"),
        (("=1,2",), "give it as KEY=VALUES"),
        (("launcher.stroke=1,,2",), "a value between commas is empty"),
        (("accelerometer.bias=[0,0,1",), "is not closed"),
        (("accelerometer.bias=0],1",), "not opened"),
        (("launcher.stroke=5:4:3",), "reversed"),
        (("launcher.stroke=5:5:3",), "empty"),
        (("launcher.stroke=4:5:1",), "2 values or more"),
        (("launcher.stroke=4:5",), "from:to:n"),
        (("launcher.stroke=4:5:2.5",), "from:to:n"),
        (("launcher.stroke=1x:5:3",), "both ends are factors"),
        (("launcher.stroke=4:5:5000",), "1000 are the most"),
        (("launcher.stroke=1x,5",), "all values are factors"),
        (("launcher.stroke=5,5.0",), "is there twice"),
        (("accelerometer.bias=1x,2x",), "is 0 in the scenario"),
        (("accelerometer.preset=1x,2x",), "there are no factors"),
        (("vibration.spectra=1x,2x",), "there are no factors"),
        (("air_data.total.normal=1x,2x",), "sets no value"),
        (("air_data.position[3]=1,2",), "air_data.position has 3 entries"),
        (("launcher.stroke[0]=1,2",), "launcher.stroke is no list"),
        (("seed=1,2",), "cannot be varied"),
        (("requirements=[],[]",), "cannot be varied"),
        (("launcher.stroke=5,6", "launcher.stroke=7,8"), "varied twice"),
        (("launcher.stroke=5:6:100", "launcher.height=1:2:11"), "100 × 11 = 1100 cells; 1000 are the most"),
        (("launcher.stroke=5,99",), "cell 2 of 2 (launcher.stroke=99): launcher.stroke = 99: must be a number from"),
        (("launcher.stroke=5,five",), "cell 2 of 2 (launcher.stroke=five): launcher.stroke = 'five': must be a number"),
        (("launcher.stroke=nan,5",), "cell 1 of 2"),
        (("plant.step_rate=0.3x,1x",), "must be one of 1000"),
        (("detector.kind=px4,nobody",), "cell 2 of 2 (detector.kind=nobody): detector.kind = 'nobody'"),
        (("air_data.position[0]=1,far",), "cell 2 of 2 (air_data.position[0]=far): air_data.position"),
        (("environment.preset=light,storm",), "cell 2 of 2 (environment.preset=storm): environment.preset = 'storm'"),
        (("detector.kind=px4,inav", "detector.px4.time=0.1,0.2"), "cell 3 of 4"),
        (("launcher.wait_min=2,3", "launcher.wait_max=2.5,4"), "cell 3 of 4"),
        ((), "nothing is varied"),
    ],
)
def test_what_cannot_be_is_one_line(catapult: Scenario, texts: tuple[str, ...], words: str) -> None:
    with pytest.raises(ValueError, match=r"\w") as error:
        cells(catapult, [parse(catapult, text) for text in texts])
    assert words in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("values", ["1,2", 3, {"a": 1}, []])
def test_in_python_values_are_a_list(catapult: Scenario, values: Any) -> None:
    with pytest.raises(ValueError, match=r"launcher\.stroke: "):
        varied(catapult, "launcher.stroke", values)


def test_the_first_key_changes_slowest(catapult: Scenario) -> None:
    both = [parse(catapult, "launcher.stroke=5,6"), parse(catapult, "launcher.height=1,2")]
    found = [tuple(cell.values()) for cell in cells(catapult, both)]
    assert found == [(5, 1), (5, 2), (6, 1), (6, 2)]


def test_a_cell_is_what_set_gives(catapult: Scenario) -> None:
    """The authority is `--set`: the same key by it gives the same scenario."""
    for key, value in (
        ("launcher.stroke", 5.0),
        ("detector.kind", "px4"),
        ("accelerometer.preset", "adxl345"),
        ("environment.preset", "hot-high"),
    ):
        assert applied(catapult, {key: value}) == load_scenario("catapult", overrides=[f"{key}={value}"])


def test_an_entry_of_a_list_leaves_the_others(catapult: Scenario) -> None:
    assert applied(catapult, {"air_data.position[1]": 0.1}).air_data.position == (0.65, 0.1, 0.0)


def test_a_weather_replaces_the_former_one() -> None:
    hot = load_scenario("catapult", overrides=["environment.preset=hot-high"])
    assert applied(hot, {"environment.preset": "light"}) == load_scenario(
        "catapult", overrides=["environment.preset=light"]
    )
    assert applied(hot, {"environment.preset": "hot-high"}) == hot


def test_a_kind_leaves_the_settings_of_the_former_behind() -> None:
    own = load_scenario("catapult", overrides=["detector.threshold=40"])
    assert applied(own, {"detector.kind": "px4"}).detector.px4.acceleration == 30.0
    assert applied(own, {"detector.kind": own.detector.kind}) == own


def test_cells_fly_the_same_flights(catapult: Scenario) -> None:
    """Flight i of each cell has the seed and the index i, and a column holds one type."""
    grid = cells(catapult, [parse(catapult, "accelerometer.bias=0,[0,0,1]")])
    plan = Cells(catapult, grid, 3)
    assert [(plan.flight(i).seed, plan.flight(i).index) for i in range(6)] == [(1, i % 3) for i in range(6)]
    assert [plan.columns(i)["run"] for i in range(6)] == [0, 1, 2, 0, 1, 2]
    assert [plan.columns(i)["vary.accelerometer.bias"] for i in (0, 5)] == ["0", "[0, 0, 1]"]
    one, other = (plan.columns(i) for i in (1, 4))
    assert one["draw.release_time"] == other["draw.release_time"]


def test_columns_have_one_type() -> None:
    assert labels((1, 2.5)) == (1.0, 2.5)
    assert labels((True, False)) == (True, False)
    assert labels((1, "two")) == ("1", "two")
    assert labels(("a", [1, 2])) == ("a", "[1, 2]")
