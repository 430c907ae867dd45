from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.config import Config, from_toml, parse_value, to_toml
from app.config.presets import preset

pytestmark = pytest.mark.slow

NAMES = [name for name, _, _ in Config().items()]


def values(name: str) -> st.SearchStrategy:
    """Any value that a parameter may have."""
    item, default = next((item, value) for dotted, item, value in Config().items() if dotted == name)
    low, high = item.metadata["low"], item.metadata["high"]
    if name == "robot.physics_rate_hz":
        return st.sampled_from([60, 120, 240, 1000, 2000])
    if name == "robot.sensor_rate_hz":
        return st.sampled_from([1, 5, 10, 20, 60])
    if name == "robot.image_width":
        low = 12
    if name.startswith("office.patience"):  # in any order, the least stays below the most
        low, high = (0.0, 5.0) if "least" in name else (5.0, 600.0)
    if isinstance(default, bool):
        return st.booleans()
    if isinstance(default, str):
        return st.sampled_from(item.metadata["choices"])
    return st.integers(low, high) if isinstance(default, int) else st.floats(low, high)


@settings(max_examples=60)
@given(st.data())
def test_toml_there_and_back_is_the_identity(data: st.DataObject) -> None:
    config = Config()
    for name in data.draw(st.lists(st.sampled_from(NAMES), max_size=12, unique=True)):
        config = config.with_value(name, data.draw(values(name)))
    text = to_toml(config)
    assert from_toml(text) == config
    assert to_toml(from_toml(text)) == text


def test_toml_explains_every_parameter() -> None:
    text = to_toml(Config())
    for name, item, _ in Config().items():
        assert f"\n{name.split('.')[1]} = " in text
        assert item.metadata["meaning"] in text
    assert "# n_x': cells along x' [cells]; 8 to 1000; D 5.3; takes effect at the next reset\nn_x = 64\n" in text
    assert "# φ: global inhibition taken from every cell; 0 to 0.02; A eq. 11; value ours\ninhibit = 0.0003\n" in text


def test_every_parameter_says_what_it_is_and_keeps_its_range(subtests: pytest.Subtests) -> None:
    assert len(NAMES) == len(set(NAMES)) > 50
    dozen = [item.metadata for _, item, _ in Config().items() if item.metadata["lecture"]]
    assert len(dozen) == 12
    assert all(about["symbol"] for about in dozen)
    for name, item, default in Config().items():
        with subtests.test(name=name):
            about = item.metadata
            assert set(about) == {"symbol", "unit", "low", "high", "meaning", "source", "choices", "live", "lecture"}
            assert about["meaning"]
            assert about["source"]
            wrong: list[object] = ["much", None]
            if isinstance(default, bool):
                wrong += [1, 0.5]
            elif isinstance(default, str):
                assert default in about["choices"]
                wrong += [1, True, ""]
            else:
                low, high = about["low"], about["high"]
                assert low <= default <= high
                wrong += [low - 1, high + 1, math.nan, math.inf, -math.inf, 10**400, True]
                wrong += [default + 0.5] if isinstance(default, int) else []
            for value in wrong:
                with pytest.raises(ValueError, match=name.replace(".", r"\.")):
                    Config().with_value(name, value)  # type: ignore[arg-type]


def test_left_out_parameters_keep_their_value() -> None:
    base = Config().with_value("pilot.cruise_speed", 0.2)
    config = from_toml("[pose_cells]\nn_x = 32\n", base)
    assert (config.pose_cells.n_x, config.pilot.cruise_speed) == (32, 0.2)
    assert from_toml("") == Config()


def test_parameters_that_limit_each_other_are_set_together_in_any_order() -> None:
    """77 is no multiple of 10, nor 240 of 7: one after the other, neither would be taken."""
    rates = {"robot.physics_rate_hz": 77, "robot.sensor_rate_hz": 7}
    patience = {"office.patience_least_s": 20.0, "office.patience_most_s": 30.0}
    for pair in (rates, patience):
        config = Config().with_values(pair)
        assert config == Config().with_values(dict(reversed(pair.items())))
        assert from_toml(to_toml(config)) == config
    with pytest.raises(ValueError, match=r"office\.patience_least_s must be at most patience_most_s \(8\), got 20"):
        Config().with_value("office.patience_least_s", 20.0)
    with pytest.raises(ValueError, match=r"robot\.physics_rate_hz must be a multiple of sensor_rate_hz \(10\), got 77"):
        Config().with_value("robot.physics_rate_hz", 77)
    with pytest.raises(ValueError, match=r"robot\.camera_fov_rad must be between"):
        Config().with_values({"local_view.rest": 0.0, "robot.camera_fov_rad": 9.0})


WRONG = [
    ("[robott]\n", "unknown section 'robott'; expected one of: pose_cells, local_view, .*, robot, office, pilot"),
    ("robot = 3\n", "unknown section 'robot'; expected one of: pose_cells, local_view, .*, robot, office, pilot"),
    ("[pilot]\ncruise = 1\n", "unknown parameter 'pilot.cruise'; expected one of: cruise_speed, turn_rate"),
    ("[pilot]\ncruise_speed = 9\n", r"pilot\.cruise_speed must be between 0\.05 and 0\.5 m/s, got 9\.0"),
    ("[pilot]\ncruise_speed = [1]\n", r"pilot\.cruise_speed must be a number, got \[1\]"),
    ("[pilot\n", "not valid TOML: "),
    ("a = " + "[" * 3000, "nested too deeply; at most 20 tables or lists"),
    ("a" + ".a" * 400 + " = 1", "nested too deeply; at most 20 tables or lists"),
    ("[robot]\nlight." + "a." * 400 + "a = 1", "nested too deeply; at most 20 tables or lists"),
    ("[robot]\nsensor_rate_hz = 7\n", r"robot\.physics_rate_hz must be a multiple of sensor_rate_hz \(7\), got 240"),
    ("[robot]\nimage_width = 8\n", r"robot\.image_width must be at least 12"),
]
UNKNOWN = [
    ("local_view.treshold", "local_view.match_threshold"),
    ("pilot.cruise", "pilot.cruise_speed"),
    ("inhibit", "pose_cells.inhibit"),
    ("pose_cells", "pose_cells.n_x"),
    ("pilot.zzzzzzz", r"pilot.*, \.\.\.$"),
]


def test_what_is_wrong_is_named_with_what_would_be_right(subtests: pytest.Subtests) -> None:
    for text, message in WRONG:
        with subtests.test(msg=text[:40]), pytest.raises(ValueError, match=message):
            from_toml(text)
    for name, right in UNKNOWN:
        words = f"unknown parameter '{name}'; expected one of: .*{right}"
        with subtests.test(msg=name), pytest.raises(ValueError, match=words):
            Config().with_value(name, 1.0)


@given(st.one_of(st.text(max_size=40), st.text(min_size=3000, max_size=4000)).filter(lambda name: name not in NAMES))
def test_a_name_that_is_like_none_is_answered_in_a_sentence(name: str) -> None:
    with pytest.raises(ValueError, match="unknown parameter") as refused:
        Config().with_value(name, 1.0)
    assert "expected one of" in str(refused.value) or "`ratslam config` prints all" in str(refused.value)
    assert len(str(refused.value)) < 1000


def test_a_value_from_the_command_line(subtests: pytest.Subtests) -> None:
    values = {
        "3": 3, "0.5": 0.5, "1e-4": 1e-4, "true": True, "false": False, '"a b"': "a b", "office": "office", "-2": -2,
        "inf": math.inf, "": "",
    }  # fmt: skip
    for text, value in values.items():
        with subtests.test(msg=text):
            got = parse_value(text)
            assert (got, type(got)) == (value, type(value))
    floated = Config().with_value("local_view.match_threshold", 8).local_view.match_threshold
    assert (floated, type(floated)) == (8.0, float)
    for words, texts in (
        ("is not a number, true, false or a word", ["[1, 2]", "{a = 1}", "2024-01-01"]),
        ("nested too deeply", ["[" * 3000, "{a=" * 500, "[" * 50 + "]" * 50]),
    ):
        for text in texts:
            with subtests.test(msg=text[:40]), pytest.raises(ValueError, match=words):
                parse_value(text)


def test_a_paper_s_pilot_only_wanders_and_ours_comes_back() -> None:
    paper = preset("paper-2006", Config())
    assert (paper.pilot.seek, paper.pilot.bar_fade_s, paper.pilot.approach_m) == (False, 0, 0)
    assert preset("ours", paper).pilot == Config().pilot
